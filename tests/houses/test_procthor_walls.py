"""Walls, doors and windows of a ProcTHOR file."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from procthor_samples import BEDROOM, KITCHEN, SHARED, SOUTH, asset, door, read, two_rooms, xyz

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.house import House, Opening, OpeningKind, Wall
from lcrl_bench.houses.procthor.schema import WallRecord
from lcrl_bench.houses.procthor.walls import THICKNESS, read_side


def wall_between(house: House, *rooms: str) -> Wall:
    return next(wall for wall in house.walls if set(wall.rooms) == set(rooms))


def shared_openings(value: dict, folder: Path) -> tuple[Opening, ...]:
    return wall_between(read(value, folder).house, "room-1", "room-2").openings


@given(st.permutations(range(4)))
def test_a_side_runs_between_its_two_lowest_points_in_their_order(order: list[int]):
    points = [xyz(1, 0, 2), xyz(5, 0, 2), xyz(1, 3, 2), xyz(5, 3, 2)]
    polygon = [points[index] for index in order]
    side = read_side(WallRecord.model_validate({"id": "w", "polygon": polygon}))
    low = [(p["x"], p["z"]) for p in polygon if p["y"] == 0]
    assert [side.start, side.end] == low
    assert side.height == 3


def test_the_two_sides_of_a_wall_become_one_wall_with_a_thickness(tmp_path: Path):
    house = read(two_rooms(), tmp_path).house
    assert len(house.walls) == 7
    assert {wall.thickness for wall in house.walls} == {THICKNESS}
    assert {wall.height for wall in house.walls} == {house.height} == {3.0}
    assert wall_between(house, "room-1", "room-2").length == 4


def test_an_inner_wall_bounds_two_rooms_and_an_outer_one_its_own(tmp_path: Path):
    house = read(two_rooms(), tmp_path).house
    assert sorted(len(wall.rooms) for wall in house.walls) == [1, 1, 1, 1, 1, 1, 2]


@given(
    low=st.floats(0.01, 2.5),
    width=st.floats(0.6, 1.2),
    swap=st.booleans(),
)
def test_a_hole_is_the_same_seen_from_either_side(low: float, width: float, swap: bool):
    """On wall1, which runs the other way, the hole [a, b] is [length - b, length - a]."""
    value, mirrored = two_rooms(), two_rooms()
    value["doors"] = [door(SHARED, (KITCHEN, BEDROOM), low, low + width)]
    twin = door((SHARED[1], SHARED[0]), (BEDROOM, KITCHEN), 4 - low - width, 4 - low)
    if swap:
        twin["holePolygon"].reverse()
    mirrored["doors"] = [twin]
    with tempfile.TemporaryDirectory() as folder:
        (one,) = shared_openings(value, Path(folder))
        (other,) = shared_openings(mirrored, Path(folder))
    assert one.start == pytest.approx(other.start, abs=1e-9)
    assert one.end == pytest.approx(other.end, abs=1e-9)
    assert (one.bottom, one.top) == (other.bottom, other.top)


def test_a_hole_is_measured_from_the_start_of_wall0(tmp_path: Path):
    house = read(two_rooms(), tmp_path).house
    wall = wall_between(house, "room-1", "room-2")
    (hole,) = wall.openings
    # wall0 runs south from (4, 4): half a metre along it is at y = 3.5.
    assert wall.point(hole.start) == pytest.approx((4, 3.5))
    assert wall.point(hole.end) == pytest.approx((4, 2.5))


def test_a_hole_given_on_a_side_that_lists_its_high_points_first_is_in_the_right_place(
    tmp_path: Path,
):
    value = two_rooms()
    value["doors"] = [door((SOUTH[1], SOUTH[0]), (KITCHEN, KITCHEN), 0.5, 1.5)]
    wall = next(w for w in read(value, tmp_path).house.walls if w.openings and w.start[1] == 0)
    places = sorted(wall.point(edge)[0] for edge in (wall.openings[0].start, wall.openings[0].end))
    # The outer side runs east from (0, 0).
    assert places == pytest.approx([0.5, 1.5])


def test_a_door_listed_from_both_of_its_rooms_is_one_opening(tmp_path: Path):
    value = two_rooms()
    value["doors"] = [
        door(SHARED, (KITCHEN, BEDROOM), 0.5, 1.5),
        door((SHARED[1], SHARED[0]), (BEDROOM, KITCHEN), 2.5, 3.5),
    ]
    assert len(shared_openings(value, tmp_path)) == 1


def test_two_doors_that_overlap_are_refused(tmp_path: Path):
    value = two_rooms()
    value["doors"].append(door(SHARED, (KITCHEN, BEDROOM), 1.0, 2.0))
    with pytest.raises(InvalidFileError, match="two openings overlap"):
        read(value, tmp_path)


@pytest.mark.parametrize("from_type", [True, False])
def test_a_doorway_indoors_is_an_open_door_and_a_doorframe_a_bare_one(
    tmp_path: Path, from_type: bool
):
    value = two_rooms()
    value["doors"][0]["assetId"] = asset("Doorway") if from_type else "a-door-nobody-knows"
    assert shared_openings(value, tmp_path)[0].kind == OpeningKind.DOOR
    value["doors"][0]["assetId"] = asset("Doorframe") if from_type else "a-frame-nobody-knows"
    del value["doors"][0]["openable"]
    assert shared_openings(value, tmp_path)[0].kind == OpeningKind.DOORWAY


@pytest.mark.parametrize("rooms", [(KITCHEN, KITCHEN), ("exterior", KITCHEN)])
@pytest.mark.parametrize("kind", ["Doorway", "Doorframe"])
def test_what_leads_outside_is_shut(tmp_path: Path, rooms: tuple[str, str], kind: str):
    value = two_rooms()
    value["doors"] = [door(SOUTH, rooms, 1, 2, assetId=asset(kind), openness=1)]
    (hole,) = wall_between_south(read(value, tmp_path).house).openings
    assert hole.kind == OpeningKind.CLOSED_DOOR


def wall_between_south(house: House) -> Wall:
    return next(wall for wall in house.walls if {wall.start[1], wall.end[1]} == {0.0})


def test_a_window_keeps_its_sill(tmp_path: Path):
    walls = read(two_rooms(), tmp_path).house.walls
    (window,) = [o for wall in walls for o in wall.openings if o.kind == OpeningKind.WINDOW]
    assert (window.bottom, window.top) == (0.9, 2.0)


@pytest.mark.parametrize("absent", [None, "missing"])
@pytest.mark.parametrize("key", ["windows", "doors", "objects"])
def test_a_house_may_have_none_of_a_kind(tmp_path: Path, key: str, absent: str | None):
    value = two_rooms()
    if absent is None:
        value[key] = None
    else:
        del value[key]
    assert read(value, tmp_path).house.rooms


def test_an_open_plan_boundary_is_no_wall(tmp_path: Path):
    value = two_rooms()
    value["doors"] = value["doors"][1:]
    for wall in value["walls"]:
        if wall["id"] in SHARED:
            wall["empty"] = True
    house = read(value, tmp_path).house
    assert len(house.walls) == 6
    assert all(len(wall.rooms) == 1 for wall in house.walls)


def test_a_door_in_an_open_plan_boundary_is_left_out_and_noted(tmp_path: Path):
    value = two_rooms()
    for wall in value["walls"]:
        if wall["id"] in SHARED:
            wall["empty"] = True
    imported = read(value, tmp_path)
    assert any("'door|1|2' left out" in note for note in imported.notes)


def test_a_wall_with_one_solid_side_stays(tmp_path: Path):
    value = two_rooms()
    value["walls"][6]["empty"] = True
    assert len(read(value, tmp_path).house.walls) == 7


def test_a_hole_that_overshoots_its_wall_is_cropped(tmp_path: Path):
    value = two_rooms()
    value["doors"][0] = door(SHARED, (KITCHEN, BEDROOM), 3.2, 4.0003)
    imported = read(value, tmp_path)
    (hole,) = wall_between(imported.house, "room-1", "room-2").openings
    assert hole.end <= 4.0
    assert imported.notes == read(two_rooms(), tmp_path).notes, "0.3 mm is not worth a note"
    value["doors"][0] = door(SHARED, (KITCHEN, BEDROOM), 3.2, 4.3)
    assert any("cropped by 30 cm" in note for note in read(value, tmp_path).notes)


@pytest.mark.parametrize(("low", "high"), [(4.1, 5.0), (-3, -1), (1.0, 1.0)])
def test_a_hole_outside_its_wall_is_refused(tmp_path: Path, low: float, high: float):
    value = two_rooms()
    value["doors"][0] = door(SHARED, (KITCHEN, BEDROOM), low, high)
    with pytest.raises(InvalidFileError, match=r"lies outside its wall of 4 m at doors\[0\]"):
        read(value, tmp_path)


def test_a_door_in_an_unknown_wall_is_refused(tmp_path: Path):
    value = two_rooms()
    value["doors"][0]["wall1"] = "wall|9"
    with pytest.raises(InvalidFileError, match=r"unknown wall 'wall\|9' at doors\[0\]"):
        read(value, tmp_path)


def test_two_walls_of_one_name_are_refused(tmp_path: Path):
    value = two_rooms()
    value["walls"].append(dict(value["walls"][3]))
    with pytest.raises(InvalidFileError, match=r"two walls are called .* at walls\[14\]"):
        read(value, tmp_path)


def test_a_wall_without_height_is_refused(tmp_path: Path):
    value = two_rooms()
    for point in value["walls"][0]["polygon"]:
        point["y"] = 0
    with pytest.raises(InvalidFileError, match=r"a wall 0 m high at walls\[0\]"):
        read(value, tmp_path)
