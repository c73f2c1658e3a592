"""A house from above: walls cut at their openings, tiles, and the borders around them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from house_samples import DOOR, WINDOW, make_wall, rectangle, two_rooms
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.houses.house import House, OpeningKind, Room, RoomType
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.floor import (
    episode_floor,
    extent,
    outline,
    rings,
    tile_shapes,
    wall_pieces,
)
from lcrl_bench.scenes.grid import Grid

SIDE = 6
CHOICES = st.lists(st.booleans(), min_size=SIDE * SIDE, max_size=SIDE * SIDE)


def square_grid() -> Grid:
    cells = np.array([(column, row) for row in range(SIDE) for column in range(SIDE)])
    nowhere = np.full((len(cells), 4), -1)
    return Grid(0.75, (1.0, -2.0), cells, cells * 0.75, nowhere, ("room",) * len(cells))


def square_house(west: float = 0.0) -> House:
    """One room under the whole grid, or under its east only."""
    low, high = (1.0 - 0.375, -2.0 - 0.375), (0.625 + SIDE * 0.75, -2.375 + SIDE * 0.75)
    polygon = rectangle(low[0] + west, low[1], high[0], high[1])
    return House("square", "sample", (Room("room", RoomType.OTHER, polygon),), (), (), 2.6)


@given(CHOICES)
def test_a_border_is_as_long_as_its_perimeter(chosen: list[bool]):
    grid, tiles = square_grid(), np.array(chosen)
    inside = {tuple(cell) for cell in grid.cells[tiles].tolist()}
    sides = sum(
        (x + dx, y + dy) not in inside
        for x, y in inside
        for dx, dy in ((0, 1), (1, 0), (0, -1), (-1, 0))
    )
    lines = outline(tile_shapes(square_house(), grid), tiles)
    assert all((line[0] == line[-1]).all() for line in lines)
    length = sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines)
    np.testing.assert_allclose(length, sides * grid.tile, atol=1e-4)


@given(CHOICES, st.sampled_from([0.0, 0.03, 0.07]))
def test_a_border_stays_as_far_inside_its_tiles_as_asked(chosen: list[bool], inset: float):
    grid, tiles = square_grid(), np.array(chosen)
    shapes = tile_shapes(square_house(), grid)
    chosen_shapes = [shape for shape, wanted in zip(shapes, tiles, strict=True) if wanted]
    border = shapely.union_all(chosen_shapes)
    for line in outline(shapes, tiles, inset):
        away = shapely.distance(border.boundary, shapely.points(line))
        assert (away >= inset - 1e-5).all()
        assert shapely.covers(border.buffer(1e-5), shapely.points(line)).all()


def test_tiles_end_where_the_house_does():
    grid = square_grid()
    shapes = tile_shapes(square_house(west=1.0), grid)
    assert max(shape.area for shape in shapes) == pytest.approx(grid.tile**2)
    floor = shapely.Polygon(square_house(west=1.0).rooms[0].polygon)
    assert sum(shape.area for shape in shapes) == pytest.approx(floor.area)
    assert rings(shapes[0]) == []


@given(st.floats(0, 2 * math.pi))
def test_a_wall_is_whole_but_for_its_openings(turn: float):
    end = (5 * math.cos(turn), 5 * math.sin(turn))
    wall = make_wall("wall", (0.0, 0.0), end, DOOR)
    pieces = wall_pieces(wall)
    assert [kind for _, kind in pieces] == [None, OpeningKind.DOOR, None]
    areas = [shapely.Polygon(corners).area for corners, _ in pieces]
    np.testing.assert_allclose(areas, np.array([1.0, 1.0, 3.0]) * wall.thickness)


def test_an_opening_at_the_end_of_a_wall_leaves_no_sliver():
    wall = make_wall("wall", (0.0, 0.0), (2.2, 0.0), WINDOW)
    assert [kind for _, kind in wall_pieces(wall)] == [None, OpeningKind.WINDOW]


def test_the_extent_is_that_of_rooms_and_walls():
    assert extent(two_rooms()) == ((0.0, 0.0), (6.0, 3.0))


def test_marked_tiles_are_where_the_task_can_be_done(nav_episode: Episode, pick_episode: Episode):
    np.testing.assert_array_equal(nav_episode.goal_tiles, nav_episode.goal)
    assert not nav_episode.take_tiles.any()
    take = int(np.flatnonzero(np.diff(pick_episode.object_states) == 1)[0])
    put = int(np.flatnonzero(pick_episode.object_states == 2)[0]) - 1
    assert pick_episode.take_tiles[pick_episode.tiles[take]]
    assert pick_episode.goal_tiles[pick_episode.tiles[put]]


def test_the_object_has_a_place_where_it_is_found_and_one_where_it_goes(
    nav_episode: Episode, pick_episode: Episode
):
    assert episode_floor(nav_episode).places == ()
    found, goal = episode_floor(pick_episode).places
    assert (found.label, goal.label) == ("A: cup", "B")
    assert pick_episode.thing is not None
    assert pick_episode.task.placement is not None
    assert found.at == pick_episode.thing.position[:2]
    assert goal.at == pick_episode.task.placement.position[:2]
