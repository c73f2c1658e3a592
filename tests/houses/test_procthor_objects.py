"""Objects of a ProcTHOR file: what they are, where they stand, which way they face."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from procthor_samples import asset, read, room, thing, two_rooms, xyz

from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.procthor.models import identify, models, typical_size
from lcrl_bench.houses.procthor.objects import tilted_size, yaw_of
from lcrl_bench.houses.receptacles import faces

ANGLES = st.floats(-720, 720)


def only(value: dict, folder: Path, *records: dict) -> House:
    """The house with these objects instead of its own."""
    value["objects"] = list(records)
    return read(value, folder).house


def facing(thing: PlacedObject) -> tuple[float, float]:
    return -math.sin(thing.yaw), math.cos(thing.yaw)


def extent(thing: PlacedObject) -> tuple[float, float]:
    """East-west and north-south extents of the footprint."""
    corners = np.array(thing.footprint())
    east, north = corners.max(axis=0) - corners.min(axis=0)
    return float(east), float(north)


def test_unity_y_and_z_swap(tmp_path: Path):
    record = thing("Chair|1|0", "Chair", 1.0, 3.0)
    chair = only(two_rooms(), tmp_path, record).objects[0]
    assert chair.position == pytest.approx((1.0, 3.0, record["position"]["y"]))
    assert chair.size == models()[record["assetId"]].size


@pytest.mark.parametrize(
    ("turn", "front"), [(0, (0, 1)), (90, (1, 0)), (180, (0, -1)), (270, (-1, 0)), (45, None)]
)
def test_a_positive_turn_in_unity_is_clockwise_seen_from_above(
    tmp_path: Path, turn: float, front: tuple | None
):
    chair = only(two_rooms(), tmp_path, thing("Chair|1|0", "Chair", 1.5, 2.0, turn=turn)).objects[0]
    expected = front or (math.sqrt(0.5), math.sqrt(0.5))
    assert facing(chair) == pytest.approx(expected, abs=1e-12)


@given(ANGLES)
def test_a_yaw_lies_in_one_turn_and_keeps_its_direction(degrees: float):
    yaw = yaw_of(degrees)
    assert -math.pi < yaw <= math.pi
    assert math.sin(yaw) == pytest.approx(-math.sin(math.radians(degrees)), abs=1e-9)
    assert math.cos(yaw) == pytest.approx(math.cos(math.radians(degrees)), abs=1e-9)


def test_width_and_depth_trade_places_at_a_quarter_turn(tmp_path: Path):
    width, depth, _ = models()[asset("Sofa")].size
    assert width != pytest.approx(depth)
    straight = only(two_rooms(), tmp_path, thing("a", "Sofa", 2, 2)).objects[0]
    turned = only(two_rooms(), tmp_path, thing("a", "Sofa", 2, 2, turn=90)).objects[0]
    assert extent(straight) == pytest.approx((width, depth))
    assert extent(turned) == pytest.approx((depth, width))


def test_a_box_tipped_onto_its_back_trades_depth_for_height():
    assert tilted_size((1, 2, 3), 90, 0) == pytest.approx((1, 3, 2))
    assert tilted_size((1, 2, 3), 0, 90) == pytest.approx((3, 2, 1))
    assert tilted_size((1, 2, 3), 0, 0) == (1, 2, 3)


@given(pitch=ANGLES, roll=ANGLES, size=st.tuples(*[st.floats(0.01, 3)] * 3))
def test_a_tilted_box_is_just_inside_its_upright_one(
    pitch: float, roll: float, size: tuple[float, float, float]
):
    """Against the rotation matrices themselves: Unity turns about z, then about x."""
    a, b = math.radians(pitch), math.radians(roll)
    about_x = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    about_z = np.array([[math.cos(b), -math.sin(b), 0], [math.sin(b), math.cos(b), 0], [0, 0, 1]])
    signs = np.array(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5])).reshape(3, 8)
    width, depth, height = size
    corners = about_x @ about_z @ (signs * np.array([[width], [height], [depth]]))
    x, y, z = corners.max(axis=1) - corners.min(axis=1)
    assert tilted_size(size, pitch, roll) == pytest.approx((x, z, y), abs=1e-9)


def test_what_stands_on_furniture_names_it(tmp_path: Path):
    house = read(two_rooms(), tmp_path).house
    cup = house.object("cup-surface-1-0")
    assert cup.support == "diningtable-1-0"
    assert (cup.label, cup.source_label, cup.room) == ("cup", "Cup", "room-1")
    assert [thing.support for thing in house.objects if thing.label != "cup"] == [None] * 4


def test_an_asset_id_decides_what_an_object_is_and_its_own_id_nothing(tmp_path: Path):
    record = {**thing("Bed|4|0", "Chair", 1, 2), "objectType": "Sofa"}
    chair = only(two_rooms(), tmp_path, record).objects[0]
    assert (chair.label, chair.id) == ("chair", "bed-4-0")


def test_an_unknown_asset_is_what_its_file_says_with_a_typical_size(tmp_path: Path):
    value = two_rooms()
    record = thing("4|0", "Chair", 1, 2)
    record |= {"assetId": "0a1b" * 8, "objectType": "ArmChair"}
    value["objects"] = [record]
    imported = read(value, tmp_path)
    armchair = imported.house.objects[0]
    assert (armchair.label, armchair.source_label) == ("armchair", "ArmChair")
    assert armchair.size == typical_size("armchair")
    assert (imported.unmapped, imported.label_coverage) == ((), 1.0)
    assert any("size typical of the class" in note for note in imported.notes)


def test_an_object_of_unknown_asset_and_type_is_a_counted_fallback(tmp_path: Path):
    value = two_rooms()
    bare = {**thing("Vase|1|0", "Chair", 1, 2), "assetId": "Vase_from_elsewhere"}
    odd = {**thing("Vase|1|1", "Chair", 1, 3), "assetId": "x1", "objectType": "Astrolabe"}
    value["objects"] += [bare, odd]
    imported = read(value, tmp_path)
    assert imported.unmapped == ("Astrolabe", "Vase_from_elsewhere")
    assert imported.label_coverage == pytest.approx(5 / 7)
    labels = [imported.house.object(name).label for name in ("vase-1-0", "vase-1-1")]
    assert labels == ["small_object", "small_object"]


def test_one_asset_has_one_shape_wherever_it_occurs():
    names = [asset("Chair", place) for place in range(3)] + ["unknown-a", "unknown-b"]
    shapes = [identify(name, "Chair").shape for name in names]
    assert shapes == [identify(name, "Chair").shape for name in names]
    assert len(set(shapes)) == len(shapes)


def test_source_ids_become_valid_unique_names(tmp_path: Path):
    names = ["Chair|1|0", "chair 1 0", "../../etc/passwd", "..", "椅子", "a" * 200]
    records = [thing(name, "Chair", 0.7 + 0.5 * i, 2) for i, name in enumerate(names)]
    house = only(two_rooms(), tmp_path, *records)
    assert [thing.id for thing in house.objects] == [
        "chair-1-0",
        "chair-1-0-2",
        "etc-passwd",
        "unnamed",
        "unnamed-2",
        "a" * 80,
    ]


def test_an_object_lies_in_the_room_that_holds_its_centre_whatever_it_is_called(tmp_path: Path):
    chair = only(two_rooms(), tmp_path, thing("Chair|1|0", "Chair", 6.0, 1.0)).objects[0]
    assert chair.room == "room-2"


def test_where_rooms_overlap_the_stated_room_wins(tmp_path: Path):
    value = two_rooms()
    value["rooms"].append(room("pantry", "pantry", 0, 0, 2, 2))
    records = [thing("a", "Chair", 1, 1), {**thing("b", "Chair", 1, 1), "roomId": "pantry"}]
    assert [t.room for t in only(value, tmp_path, *records).objects] == ["room-1", "pantry"]


def test_a_centre_just_outside_its_room_is_moved_in_and_noted(tmp_path: Path):
    value = two_rooms()
    value["objects"] = [thing("LightSwitch|1", "LightSwitch", 2, -0.03, y=1.2)]
    imported = read(value, tmp_path)
    (switch,) = imported.house.objects
    assert switch.room == "room-1"
    assert shapely.Polygon(imported.house.room("room-1").polygon).contains(
        shapely.Point(switch.position[:2])
    )
    assert any("moved into the nearest room (by up to 3." in note for note in imported.notes)


def test_an_object_far_outside_is_left_out_with_what_stands_on_it(tmp_path: Path):
    value = two_rooms()
    table = thing("DiningTable|9", "DiningTable", 900, 2)
    table["children"] = [thing("Cup|9", "Cup", 2, 2, y=0.9)]
    value["objects"].append(table)
    imported = read(value, tmp_path)
    assert imported.house.objects == read(two_rooms(), tmp_path).house.objects
    (note,) = [note for note in imported.notes if "left out" in note]
    assert "2 objects left out: 'DiningTable|9' (outside every room)" in note


def test_nothing_sinks_into_the_floor_or_hovers_just_above_it(tmp_path: Path):
    floor = models()[asset("Chair")].size[2] / 2
    records = [
        thing("sunk", "Chair", 1, 1, y=floor - 0.2),
        thing("hovering", "Chair", 1, 2, y=floor + 0.1),
        thing("standing", "Chair", 1, 3),
    ]
    things = only(two_rooms(), tmp_path, *records).objects
    assert [thing.base for thing in things] == pytest.approx([0, 0, 0], abs=1e-12)


def test_what_hangs_keeps_its_height(tmp_path: Path):
    house = read(two_rooms(), tmp_path).house
    assert house.object("painting-2-1").position[2] == 1.6


@pytest.mark.parametrize("y", [9.0, -4.0])
def test_what_lies_above_the_ceiling_or_below_the_floor_is_left_out(tmp_path: Path, y: float):
    value = two_rooms()
    value["objects"].append(thing("Chair|lost", "Chair", 1, 1, y=y))
    assert any("'Chair|lost' (above the ceiling" in note for note in read(value, tmp_path).notes)


def test_a_painting_hangs_before_the_wall_and_not_in_it(tmp_path: Path):
    """The file's walls have no thickness, so what hangs on one lies inside ours."""
    painting = read(two_rooms(), tmp_path).house.object("painting-2-1")
    back = max(y for _, y in painting.footprint())
    assert 3.94 < back < 3.95


@given(x=st.floats(0.3, 3.7), z=st.floats(0.3, 3.7), turn=st.floats(0, 360))
def test_clearing_the_walls_moves_a_box_by_centimetres_and_leaves_no_shallow_overlap(
    x: float, z: float, turn: float
):
    value = two_rooms()
    value["objects"] = [thing("Box|1", "Box", x, z, turn=turn)]
    with tempfile.TemporaryDirectory() as folder:
        (box,) = read(value, Path(folder)).house.objects
    assert math.dist(box.position[:2], (x, z)) < 0.13
    corners = np.array(box.footprint())
    for inner in (corners.min(axis=0), 4 - corners.max(axis=0)):
        assert np.all((inner >= 0.05) | (inner < -0.029)), corners


def test_what_stands_on_furniture_moves_with_it(tmp_path: Path):
    depth = models()[asset("Desk")].size[1]
    desk = thing("Desk", "Desk", 2, depth / 2)
    desk["children"] = [thing("Book", "Book", 2.1, depth / 2, y=1.0)]
    house = only(two_rooms(), tmp_path, desk)
    moved, book = house.objects
    assert moved.position[1] - depth / 2 == pytest.approx(0.052)
    assert book.position[1] == pytest.approx(moved.position[1])
    assert book.position[0] == pytest.approx(2.1)


def on_furniture(folder: Path, under: dict, *things: dict) -> tuple[PlacedObject, ...]:
    """Furniture and what stands on it, as imported."""
    under["children"] = list(things)
    return only(two_rooms(), folder, under).objects


def test_what_hovers_over_furniture_is_set_down_on_its_face(tmp_path: Path):
    top = models()[asset("DiningTable")].size[2]
    cup = thing("Cup", "Cup", 2.1, 2.0, y=top + 0.055 + models()[asset("Cup")].size[2] / 2)
    table, cup = on_furniture(tmp_path, thing("T", "DiningTable", 2, 2), cup)
    assert cup.base == pytest.approx(table.top, abs=1e-3)
    assert cup.position[:2] == (2.1, 2.0)


@pytest.mark.parametrize("turn", [0, 90, 200])
def test_a_pillow_comes_down_from_the_headboard_to_the_mattress(tmp_path: Path, turn: float):
    bed = thing("Bed", "Bed", 2, 2, turn=turn)
    height = models()[bed["assetId"]].size[2]
    bed, pillow = on_furniture(tmp_path, bed, thing("P", "Pillow", 2, 2, y=height + 0.05))
    assert pillow.base == pytest.approx(faces(bed)[0].height)


def test_what_stands_just_beside_a_face_is_moved_over_it(tmp_path: Path):
    table = thing("T", "DiningTable", 2, 2, turn=30)
    width, _, top = models()[table["assetId"]].size
    yaw = -math.radians(30)
    across = width / 2 + 0.02
    x, z = 2 + across * math.cos(yaw), 2 + across * math.sin(yaw)
    table, book = on_furniture(tmp_path, table, thing("B", "Book", x, z, y=top + 0.05))
    (face,) = faces(table)
    along_width = (book.position[0] - 2) * math.cos(yaw) + (book.position[1] - 2) * math.sin(yaw)
    assert along_width == pytest.approx(face.half[0])
    assert book.base == pytest.approx(face.height)


def test_what_is_in_a_drawer_or_leans_beside_stays(tmp_path: Path):
    pen = thing("Pen", "Pen", 2.0, 2.0, y=0.2)
    bat = thing("BaseballBat", "BaseballBat", 3.5, 2.0)
    dresser = thing("D", "Dresser", 2, 2)
    _, inside, beside = on_furniture(tmp_path, dresser, pen, bat)
    assert inside.position == (2.0, 2.0, 0.2)
    assert beside.position == pytest.approx((3.5, 2.0, bat["position"]["y"]))
    value = two_rooms() | {"objects": [dresser]}
    assert "1 object kept inside furniture, perhaps out of sight." in read(value, tmp_path).notes


def test_a_tilted_object_gets_an_upright_box(tmp_path: Path):
    record = thing("BaseballBat", "BaseballBat", 2, 2, y=0.3)
    record["rotation"] = xyz(90, 0, 0)
    bat = only(two_rooms(), tmp_path, record).objects[0]
    width, depth, height = models()[record["assetId"]].size
    assert bat.size == pytest.approx((width, height, depth))
