"""Real ProcTHOR houses, where a folder of them is at hand (see `real_houses` in tests/conftest)."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.document import house_digest, read_house, write_house
from lcrl_bench.houses.house import PASSABLE, House, OpeningKind, PlacedObject
from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.houses.procthor import import_procthor
from lcrl_bench.houses.procthor.models import models
from lcrl_bench.houses.procthor.schema import HouseRecord, parse_record
from lcrl_bench.houses.procthor.walls import read_side
from lcrl_bench.houses.receptacles import faces

HOUSES = {
    "houses/ai2thor_house_3703.json": (2, 39),
    "houses/zg_house_100.json": (2, 19),
    "houses_lgpl/house_0.json": (3, 17),
    "houses_lgpl/house_1.json": (4, 88),
    "houses_lgpl/house_2.json": (4, 89),
}
"""File → its rooms and objects."""


@pytest.fixture(params=HOUSES)
def file(request: pytest.FixtureRequest, real_houses: Path) -> Path:
    return real_houses / "procthor" / request.param


@pytest.fixture
def imported(file: Path) -> ImportedHouse:
    return import_procthor(file)


@pytest.fixture
def record(file: Path) -> HouseRecord:
    return parse_record(json.loads(file.read_text()), path=file)


def test_nothing_is_lost_and_every_label_is_known(
    file: Path, imported: ImportedHouse, capsys: pytest.CaptureFixture
):
    house = imported.house
    name = f"{file.parent.name}/{file.name}"
    assert (len(house.rooms), len(house.objects)) == HOUSES[name]
    assert (imported.unmapped, imported.label_coverage) == ((), 1.0)
    with capsys.disabled():
        print(f"\n{name}: label coverage {imported.label_coverage:.0%}; {' '.join(imported.notes)}")


def test_every_object_lies_in_its_room(imported: ImportedHouse):
    for thing in imported.house.objects:
        polygon = shapely.Polygon(imported.house.room(thing.room).polygon)
        assert polygon.contains(shapely.Point(thing.position[:2])), thing.id


def test_right_angled_furniture_stands_wholly_inside_its_room(imported: ImportedHouse):
    """With width and depth confused at quarter turns, almost half of it would stand in walls."""
    for thing in imported.house.objects:
        quarter = abs(math.remainder(thing.yaw, math.pi / 2)) < 1e-6
        if thing.support is None and quarter:
            room = shapely.Polygon(imported.house.room(thing.room).polygon)
            outside = shapely.Polygon(thing.footprint()).difference(room.buffer(0.03))
            assert outside.area == 0, thing.id


def test_what_stands_on_the_floor_touches_it(imported: ImportedHouse):
    hung = {"picture", "television"}
    for thing in imported.house.objects:
        if thing.support is None and thing.label not in hung:
            # The asset index rounds to a tenth of a millimetre.
            assert abs(thing.base) < 1e-4, thing.id
        assert thing.base >= 0


def test_what_stands_on_furniture_touches_it_or_is_inside_it(imported: ImportedHouse):
    house = imported.house
    on_top = 0
    for thing in house.objects:
        if thing.support is not None:
            under = house.object(thing.support)
            heights = [face.height for face in faces(under)] or [under.top]
            touching = min(abs(thing.base - height) for height in heights) < 1e-3
            footprint = shapely.Polygon(under.footprint()).buffer(0.01)
            over = footprint.contains(shapely.Point(thing.position[:2]))
            # The only other one leans on the side of a bed.
            assert (over and (touching or thing.base < under.top)) or thing.base < 1e-3, thing.id
            on_top += touching
    assert on_top >= 0.75 * sum(thing.support is not None for thing in house.objects)


def chairs_at_tables(house: House) -> list[float]:
    """Cosine of the angle between each chair's front and its table, within 1.2 m."""
    tables = [thing for thing in house.objects if thing.label == "dining_table"]

    def towards(chair: PlacedObject, table: PlacedObject) -> float:
        dx, dy = (table.position[k] - chair.position[k] for k in (0, 1))
        return (-math.sin(chair.yaw) * dx + math.cos(chair.yaw) * dy) / math.hypot(dx, dy)

    return [
        towards(chair, table)
        for chair in house.objects
        if chair.label == "chair"
        for table in tables
        if math.dist(chair.position[:2], table.position[:2]) < 1.2
    ]


def test_chairs_face_their_tables(real_houses: Path):
    houses = [import_procthor(real_houses / "procthor" / name).house for name in HOUSES]
    cosines = [cosine for house in houses for cosine in chairs_at_tables(house)]
    assert len(cosines) >= 8
    assert np.mean(np.array(cosines) > 0.5) > 0.8


def test_every_segment_occurs_twice_and_becomes_one_wall(
    record: HouseRecord, imported: ImportedHouse
):
    solid = [wall for wall in record.walls if not wall.empty]
    assert len(imported.house.walls) == len(solid) / 2
    assert all(1 <= len(wall.rooms) <= 2 for wall in imported.house.walls)
    assert {wall.height for wall in imported.house.walls} == {imported.house.height}


def test_each_hole_is_the_same_from_both_of_its_walls(record: HouseRecord, imported: ImportedHouse):
    """By the mirrored formula for wall1, against the opening cut into the merged wall."""
    sides = {wall.id: read_side(wall) for wall in record.walls}
    cut = [
        tuple(sorted([wall.point(hole.start), wall.point(hole.end)]))
        for wall in imported.house.walls
        for hole in wall.openings
    ]
    openings = [*(record.doors or ()), *(record.windows or ())]
    assert len(cut) == len(openings)
    for opening in openings:
        low, high = (corner.x for corner in opening.holePolygon)
        one, other = sides[opening.wall0], sides[opening.wall1]
        near, far = other.length - high, other.length - low
        seen = [
            sorted(point_on(one, d) for d in (low, high)),
            sorted(point_on(other, d) for d in (near, far)),
        ]
        assert np.allclose(seen[0], seen[1], atol=1e-6)
        assert any(np.allclose(seen[0], ends, atol=1e-3) for ends in cut), opening.id


def point_on(side: object, distance: float) -> tuple[float, float]:
    (x0, y0), (x1, y1) = side.start, side.end  # type: ignore[attr-defined]
    share = distance / math.dist((x0, y0), (x1, y1))
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0)


def test_the_doors_join_all_rooms_and_one_leads_outside(imported: ImportedHouse):
    house = imported.house
    joined = {house.rooms[0].id}
    for _ in house.rooms:
        for wall in house.walls:
            open_way = any(hole.kind in PASSABLE for hole in wall.openings)
            if open_way and joined & set(wall.rooms):
                joined |= set(wall.rooms)
    assert joined == {room.id for room in house.rooms}
    kinds = [hole.kind for wall in house.walls for hole in wall.openings]
    assert kinds.count(OpeningKind.CLOSED_DOOR) == 1


def test_it_comes_back_from_our_own_format(imported: ImportedHouse, tmp_path: Path):
    write_house(tmp_path / "house.json", imported.house)
    copy = read_house(tmp_path / "house.json")
    assert copy == imported.house
    assert house_digest(copy) == house_digest(imported.house)


def test_a_hand_made_house_without_metadata_imports_with_its_stray_dresser_left_out(
    real_houses: Path,
):
    imported = import_procthor(real_houses / "procthor" / "houses_lgpl" / "house_test.json")
    assert imported.house.objects == ()
    assert imported.notes == (
        "The file states no schema: read as 1.0.0.",
        "1 object left out: 'Dresser|3|0' (outside every room).",
    )


@pytest.mark.parametrize("name", ["holodeck_empty_house.json", "objathor_empty_house.json"])
def test_an_empty_template_is_refused(real_houses: Path, name: str):
    with pytest.raises(InvalidFileError, match="has no rooms"):
        import_procthor(real_houses / "procthor" / "houses" / name)


def test_the_asset_index_agrees_with_the_database_it_comes_from(real_houses: Path):
    database = json.loads((real_houses / "procthor" / "db" / "asset-database.json").read_text())
    boxes = {m["assetId"]: m["boundingBox"] for kind in database.values() for m in kind}
    assert set(boxes) == set(models())
    for name, box in boxes.items():
        assert models()[name].size == pytest.approx((box["x"], box["z"], box["y"]), abs=6e-5)
