"""Within reach: near enough, and no wall, pane or shut door in between."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from house_samples import DOOR, WINDOW, two_rooms
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.houses.house import OpeningKind, PlacedObject
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.reach import crosses, nearest_points, solid_segments, within_reach
from lcrl_bench.semantics import DEFAULT_SEMANTICS

CLOSED = replace(DOOR, kind=OpeningKind.CLOSED_DOOR)
NUMBER = st.floats(-3, 3).map(lambda value: round(value, 3))
POINT = st.tuples(NUMBER, NUMBER)


def standing_at(*points) -> Grid:
    """A grid whose agent stands at these points."""
    count = len(points)
    return Grid(
        0.75,
        (0.0, 0.0),
        np.zeros((count, 2), np.int64),
        np.array(points, float),
        np.full((count, 4), -1),
        ("bedroom",) * count,
    )


def reached(house, thing, *points, semantics=DEFAULT_SEMANTICS) -> list[bool]:
    return within_reach(house, standing_at(*points), thing, semantics).tolist()


def thing_at(x: float, y: float, size=(0.2, 0.2, 0.2), yaw: float = 0.0) -> PlacedObject:
    return PlacedObject("it", "vase", "kitchen", (x, y, 0.1), size, yaw)


def test_reach_ends_at_its_length_from_the_footprint():
    thing = thing_at(4.5, 1.5)
    near, far = (4.5, 1.5 - 0.1 - 0.999), (4.5, 1.5 - 0.1 - 1.001)
    assert reached(two_rooms(), thing, near, far) == [True, False]
    longer = replace(DEFAULT_SEMANTICS, reach=1.01)
    assert reached(two_rooms(), thing, near, far, semantics=longer) == [True, True]


def test_one_is_at_what_one_stands_in():
    rug = thing_at(4.5, 1.5, (2.0, 2.0, 0.02))
    assert reached(two_rooms(), rug, (4.5, 1.5), (3.6, 2.4), (5.4, 0.6)) == [True] * 3


@pytest.mark.parametrize(
    ("opening", "reaches"),
    [
        (DOOR, True),
        (replace(DOOR, kind=OpeningKind.DOORWAY), True),
        (CLOSED, False),
        (WINDOW, False),
    ],
    ids=["door", "doorway", "closed door", "window"],
)
def test_only_what_one_can_walk_through_can_be_reached_through(opening, reaches):
    assert reached(two_rooms(opening), thing_at(3.5, 1.5), (2.8, 1.5)) == [reaches]


def test_nothing_is_reached_through_a_wall():
    house = two_rooms(DOOR)
    assert reached(house, thing_at(3.3, 2.6), (2.7, 2.6), (3.7, 2.6)) == [False, True]


@pytest.mark.parametrize("poke", [0.0, 0.02, 0.05])
def test_a_box_against_a_wall_is_reached_from_its_own_side_alone(poke):
    # Its back is on the wall's centre line, or pokes through it.
    cabinet = thing_at(3.15 - poke, 2.6, (0.3, 0.5, 0.8))
    assert reached(two_rooms(DOOR), cabinet, (2.6, 2.6), (3.8, 2.6)) == [False, True]


def test_a_picture_thinner_than_the_wall_is_reached_from_its_own_side_alone():
    picture = thing_at(3.02, 2.6, (0.03, 0.5, 0.5))
    assert reached(two_rooms(DOOR), picture, (2.5, 2.6), (3.5, 2.6)) == [False, True]


def test_a_thing_half_behind_a_corner_is_reached():
    # Its nearest part is behind the wall's end, its middle in plain sight through the door.
    table = thing_at(3.45, 1.25, (0.7, 1.2, 0.7))
    assert reached(two_rooms(DOOR), table, (2.6, 0.9)) == [True]


def test_a_footprint_and_the_object_that_has_it_are_reached_alike():
    house, thing = two_rooms(), thing_at(4.2, 1.4, (0.6, 0.3, 0.5), 0.7)
    points = [(x, y) for x in np.arange(0.3, 6, 0.4) for y in np.arange(0.3, 3, 0.4)]
    assert reached(house, thing, *points) == reached(house, thing.footprint(), *points)
    backward = thing.footprint()[::-1]
    assert reached(house, thing, *points) == reached(house, backward, *points)


@given(POINT, st.tuples(*[st.floats(0.05, 2)] * 2), st.floats(-4, 4), st.lists(POINT, min_size=1))
def test_the_nearest_point_is_the_nearest(center, size, yaw, points):
    thing = PlacedObject("it", "vase", "kitchen", (*center, 0.1), (*size, 0.2), yaw)
    corners, points = np.array(thing.footprint()), np.array(points)
    nearest = nearest_points(corners, points)
    polygon = shapely.Polygon(corners)
    away = shapely.distance(polygon, shapely.points(points))
    assert np.linalg.norm(nearest - points, axis=1) == pytest.approx(away, abs=1e-9)
    assert shapely.distance(polygon, shapely.points(nearest)) == pytest.approx(0, abs=1e-9)


@given(POINT, POINT, POINT, POINT)
def test_lines_cross_where_plane_geometry_says_so(start, end, one, other):
    line, wall = shapely.LineString([start, end]), shapely.LineString([one, other])
    if min(line.length, wall.length) < 0.05 or 0 < line.distance(wall) < 1e-3:
        return
    sine = math.sin(
        math.atan2(end[1] - start[1], end[0] - start[0])
        - math.atan2(other[1] - one[1], other[0] - one[0])
    )
    if abs(sine) < 1e-3:
        return
    found = crosses(np.array([start]), np.array([end]), np.array([[one, other]]))
    assert found.tolist() == [line.intersects(wall)]


def test_walls_and_what_can_be_walked_through_make_up_their_length():
    for opening, hole in ((DOOR, 1.0), (CLOSED, 0.0), (WINDOW, 0.0)):
        house = two_rooms(opening)
        segments = solid_segments(house)
        solid = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
        assert solid == pytest.approx(sum(wall.length for wall in house.walls) - hole)


def test_nothing_is_within_reach_of_no_tile():
    empty = replace(standing_at((0, 0)), points=np.zeros((0, 2)), cells=np.zeros((0, 2), np.int64))
    assert within_reach(two_rooms(), empty, thing_at(1, 1), DEFAULT_SEMANTICS).tolist() == []
