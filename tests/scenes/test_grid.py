"""The grid is what MuJoCo's collision queries say, and connects what doors connect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from house_samples import (
    DOOR,
    HEIGHT,
    WINDOW,
    make_wall,
    rectangle,
    two_rooms,
    with_objects,
    without_wall,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.house import House, Opening, OpeningKind, PlacedObject, Room, RoomType
from lcrl_bench.houses.sources import import_house
from lcrl_bench.scenes.agent import STEP
from lcrl_bench.scenes.building import building_boxes
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.probe import STRIDE, CollisionProbe
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS

AHEAD = ((0, 1), (1, 0), (0, -1), (-1, 0))
RADIUS = DEFAULT_SEMANTICS.agent_radius
CLOSED = replace(DOOR, kind=OpeningKind.CLOSED_DOOR)
BOTH = ("bedroom", "kitchen")


def wide(kind: OpeningKind, start: float, end: float) -> Opening:
    return Opening(kind, start, end, 0.0, 2.05)


def block(name: str, x: float, y: float, size=(0.6, 0.6, 0.9), yaw: float = 0.0) -> PlacedObject:
    """A dresser in the bedroom's half of the house: a solid box."""
    room = "bedroom" if x < 3 else "kitchen"
    return PlacedObject(name, "dresser", room, (x, y, size[2] / 2), size, yaw)


@st.composite
def furnished(draw) -> House:
    """Two rooms with a door somewhere and blocks anywhere."""
    start = draw(st.floats(0.05, 1.9))
    house = two_rooms(wide(OpeningKind.DOOR, start, start + draw(st.floats(0.8, 1.05))))
    blocks = []
    for number in range(draw(st.integers(0, 6))):
        x, y = draw(st.floats(0.4, 5.6)), draw(st.floats(0.4, 2.6))
        size = (draw(st.floats(0.2, 0.9)), draw(st.floats(0.2, 0.9)), 0.9)
        blocks.append(block(f"block-{number}", x, y, size, draw(st.floats(0, 3))))
    return with_objects(house, *blocks)


def floor_plan(house: House) -> shapely.Geometry:
    """What stands between the step and the body's height, seen from above."""
    solid = []
    for box in building_boxes(house):
        low, high = box.center[2] - box.half[2], box.center[2] + box.half[2]
        if high > STEP and low < DEFAULT_SEMANTICS.agent_height:
            flat = shapely.box(-box.half[0], -box.half[1], box.half[0], box.half[1])
            flat = shapely.affinity.rotate(flat, box.yaw, origin=(0, 0), use_radians=True)
            solid.append(shapely.affinity.translate(flat, box.center[0], box.center[1]))
    return shapely.union_all(solid)


@settings(max_examples=15)
@given(st.floats(0.0, 1.9), st.floats(0.3, 1.05), st.integers(0, 2**32 - 1))
def test_the_body_fits_where_plane_geometry_says_so(start, width, seed):
    house = two_rooms(wide(OpeningKind.DOOR, start, start + width), furnished=False)
    points = np.random.default_rng(seed).uniform((0.1, 0.1), (5.9, 2.9), (400, 2))
    points[:100] = (3.0, start + width / 2) + 0.3 * (points[:100] - (3.0, 1.5))
    away = shapely.distance(floor_plan(house), shapely.points(points))
    sure = np.abs(away - RADIUS) > 1e-3
    free = CollisionProbe(house, DEFAULT_SEMANTICS).free(points)
    assert (free == (away > RADIUS))[sure].all()


@settings(max_examples=25)
@given(furnished())
def test_every_tile_and_edge_is_free_and_every_other_way_is_not(house):
    try:
        grid = build_grid(house)
    except InvalidHouseError:
        return
    probe = CollisionProbe(house, DEFAULT_SEMANTICS)
    assert probe.free(grid.points).all()
    offset = np.abs(grid.points - (grid.cells * grid.tile + grid.origin))
    assert offset.max() < grid.tile / 2
    index = {tuple(cell): number for number, cell in enumerate(grid.cells.tolist())}
    assert len(index) == grid.tiles
    for tile, (column, row) in enumerate(grid.cells.tolist()):
        for heading, (east, north) in enumerate(AHEAD):
            beside = index.get((column + east, row + north))
            ahead = grid.neighbours[tile, heading]
            if ahead >= 0:
                assert ahead == beside
                assert grid.neighbours[ahead, (heading + 2) % 4] == tile
            if beside is not None:
                assert is_clear(probe, grid.points[tile], grid.points[beside]) == (ahead >= 0)


def is_clear(probe: CollisionProbe, start: np.ndarray, end: np.ndarray) -> bool:
    """The straight way tried point by point, at the stride of the grid."""
    count = int(np.ceil(np.linalg.norm(end - start) / STRIDE)) + 1
    return bool(probe.free(np.linspace(start, end, count)).all())


@settings(max_examples=25)
@given(furnished())
def test_a_grid_is_in_one_piece_inside_the_rooms_and_reported(house):
    try:
        grid = build_grid(house)
    except InvalidHouseError:
        return
    seen, waiting = {0}, [0]
    while waiting:
        ahead = set(grid.neighbours[waiting.pop()].tolist()) - seen - {-1}
        seen |= ahead
        waiting += ahead
    assert len(seen) == grid.tiles
    for point, room in zip(grid.points, grid.rooms, strict=True):
        assert shapely.Polygon(house.room(room).polygon).intersects(shapely.Point(point))
    report = grid.report
    assert report.tiles_reachable == grid.tiles <= report.tiles_free
    assert set(report.rooms_reached) == set(grid.rooms)
    assert sorted(report.rooms_reached + report.rooms_unreached) == sorted(BOTH)
    assert set(report.rooms_missed) <= set(report.rooms_unreached)
    assert [grid.tile_at(tuple(point)) for point in grid.points] == list(range(grid.tiles))


def rooms_reached(house: House) -> tuple[str, ...]:
    return build_grid(house).report.rooms_reached


@pytest.mark.parametrize(
    ("opening", "passes"),
    [
        (DOOR, True),
        (replace(DOOR, kind=OpeningKind.DOORWAY), True),
        (CLOSED, False),
        (WINDOW, False),
        (replace(WINDOW, bottom=0.0, top=2.2), False),
        (wide(OpeningKind.DOORWAY, 1.0, 1.3), False),
    ],
    ids=["door", "doorway", "closed door", "window", "glass door", "slit"],
)
def test_the_agent_passes_doors_and_nothing_else(opening, passes):
    assert (rooms_reached(two_rooms(opening)) == BOTH) == passes


def test_a_room_behind_a_closed_door_is_left_out_but_not_missed():
    report = build_grid(two_rooms(CLOSED)).report
    assert len(report.rooms_unreached) == 1
    assert report.rooms_missed == ()
    assert report.tiles_free > report.tiles_reachable


def test_removing_a_wall_opens_tiles():
    walled, opened = two_rooms(CLOSED), without_wall(two_rooms(CLOSED), "middle")
    assert rooms_reached(opened) == BOTH
    assert build_grid(opened).tiles > build_grid(walled).tiles


def test_a_lintel_too_low_for_the_body_blocks_the_door():
    low = replace(DOOR, top=DEFAULT_SEMANTICS.agent_height - 0.05)
    assert rooms_reached(two_rooms(low)) != BOTH


def test_furniture_in_the_door_is_reported_as_a_room_missed():
    house = with_objects(two_rooms(), block("block", 3.0, 1.5, (0.9, 1.2, 0.9)))
    report = build_grid(house).report
    assert len(report.rooms_missed) == 1
    assert set(report.rooms_reached + report.rooms_missed) == set(BOTH)


def test_furniture_takes_tiles_and_a_rug_does_not():
    bare = build_grid(with_objects(two_rooms())).tiles
    rug = PlacedObject("rug", "rug", "bedroom", (1.5, 1.5, 0.0125), (2.0, 2.0, 0.025), 0.0)
    assert build_grid(with_objects(two_rooms(), rug)).tiles == bare
    assert build_grid(with_objects(two_rooms(), block("it", 1.5, 1.5, (2, 2, 1)))).tiles < bare


def test_what_hangs_above_the_body_does_not_block_it_but_never_holds_the_cameras():
    def hung(bottom: float) -> Grid:
        size = (2.0, 2.0, 0.5)
        thing = PlacedObject("it", "wall_cabinet", "bedroom", (1.5, 1.5, bottom + 0.25), size, 0.0)
        return build_grid(with_objects(two_rooms(), thing))

    bare = build_grid(with_objects(two_rooms())).tiles
    assert hung(1.5).tiles == bare
    assert hung(DEFAULT_SEMANTICS.eye_height - 0.02).tiles < bare


def on_the_lattice(shift: float, *objects: PlacedObject) -> House:
    """Two rooms whose walls and door are on the lattice of tiles, moved by `shift`."""
    size = 3.0
    bedroom = Room("bedroom", RoomType.BEDROOM, rectangle(shift, shift, shift + 3, shift + 3))
    kitchen = Room("kitchen", RoomType.KITCHEN, rectangle(shift + 3, shift, shift + 6, shift + 3))
    door = wide(OpeningKind.DOOR, 1.5, 2.25)
    corners = [(shift + x, shift + y) for x, y in ((0, 0), (6, 0), (6, size), (0, size))]
    walls = [
        make_wall(f"outer-{number}", start, corners[(number + 1) % 4])
        for number, start in enumerate(corners)
    ]
    walls.append(make_wall("middle", (shift + 3, shift), (shift + 3, shift + 3), door, rooms=BOTH))
    return House("lattice", "sample", (bedroom, kitchen), tuple(walls), objects, HEIGHT)


def test_a_house_built_on_the_lattice_keeps_it():
    grid = build_grid(on_the_lattice(0.0))
    assert grid.report.measures == ()
    assert (grid.tile, grid.tiles, grid.origin) == (0.75, 32, (0.375, 0.375))
    assert grid.points == pytest.approx(grid.cells * 0.75 + 0.375)


def test_a_house_off_the_lattice_gets_its_own_phase():
    # Half a tile aside, walls run through tile centres, and the door is between two tiles.
    grid = build_grid(on_the_lattice(0.375))
    assert grid.report.rooms_reached == BOTH
    assert "phase" in grid.report.measures
    assert (np.array(grid.origin) % 0.75).round(6).tolist() != [0.375, 0.375]


def test_the_agent_stands_beside_a_blocked_centre():
    # The only way to the door leads through a tile whose centre is taken.
    post = PlacedObject("post", "dresser", "bedroom", (2.6, 1.75, 0.5), (0.15, 0.15, 1.0), 0.0)
    grid = build_grid(on_the_lattice(0.0, post))
    centers = grid.cells * grid.tile + grid.origin
    assert (np.abs(grid.points - centers).max(axis=1) > 0.1).any()


def slalom(lanes: int, pitch: float) -> House:
    """Two rooms at the ends of a hall, in which screens leave narrow lanes to wind through."""
    ends = (3.0, 3.0 + lanes * pitch)
    rooms = (
        Room("bedroom", RoomType.BEDROOM, rectangle(0, 0, ends[0], 3)),
        Room("hall", RoomType.HALLWAY, rectangle(ends[0], 0, ends[1], 3)),
        Room("kitchen", RoomType.KITCHEN, rectangle(ends[1], 0, ends[1] + 3, 3)),
    )
    door = wide(OpeningKind.DOOR, 1.0, 2.0)
    corners = [(0.0, 0.0), (ends[1] + 3, 0.0), (ends[1] + 3, 3.0), (0.0, 3.0)]
    walls = [make_wall(f"outer-{k}", corners[k], corners[(k + 1) % 4]) for k in range(4)]
    walls += [make_wall(f"door-{k}", (x, 0), (x, 3), door) for k, x in enumerate(ends)]
    for lane in range(1, lanes):
        x, (low, high) = ends[0] + lane * pitch, ((0.0, 2.3), (0.7, 3.0))[lane % 2]
        walls.append(make_wall(f"screen-{lane}", (x, low), (x, high)))
    return House("slalom", "sample", rooms, tuple(walls), (), HEIGHT)


def test_tiles_get_smaller_where_the_usual_ones_lose_a_room():
    report = build_grid(slalom(9, 0.6)).report
    assert report.rooms_missed == ()
    assert report.rooms_reached == ("bedroom", "hall", "kitchen")
    assert "smaller tile" in report.measures
    assert build_grid(slalom(9, 0.6)).tile == 0.6


def test_standing_points_move_where_doors_and_lanes_ask_for_different_phases():
    # Lanes fit the lattice; the doors at their ends are between two rows of its tiles.
    grid = build_grid(slalom(9, 0.75))
    assert grid.tile == 0.75
    assert grid.report.rooms_reached == ("bedroom", "hall", "kitchen")
    assert "standing points" in grid.report.measures


def test_tile_at_knows_no_tile_outside():
    grid = build_grid(two_rooms())
    assert grid.tile_at((-5.0, 1.0)) is None
    assert grid.tile_at((0.8, 2.2)) is None


def test_a_house_filled_to_the_walls_is_refused_by_name():
    full = with_objects(
        two_rooms(),
        block("one", 1.5, 1.5, (2.9, 2.9, 1.0)),
        block("other", 4.5, 1.5, (2.9, 2.9, 1.0)),
    )
    with pytest.raises(InvalidHouseError, match="'two-rooms': the agent can't stand anywhere"):
        build_grid(full)


def test_the_same_house_gives_the_same_grid():
    one, other = build_grid(two_rooms()), build_grid(two_rooms())
    assert (one.points == other.points).all()
    assert (one.neighbours == other.neighbours).all()
    assert one.report == other.report


def test_a_scene_holds_the_house_and_what_is_derived_from_it():
    scene = Scene(two_rooms())
    assert scene.house == two_rooms()
    assert scene.grid.rooms == build_grid(two_rooms()).rooms
    assert {surface.object for surface in scene.surfaces} > {"bed", "cup"}


REAL = ("houses/ai2thor_house_3703", "houses/zg_house_100", "houses_lgpl/house_0")
REAL += ("houses_lgpl/house_1", "houses_lgpl/house_2")


@pytest.mark.parametrize("name", REAL)
def test_every_room_of_a_real_house_that_doors_connect_is_reached(name, real_houses):
    path = real_houses / "procthor" / f"{name}.json"
    if not path.is_file():
        pytest.skip(f"no {path}")
    report = build_grid(import_house(path).house).report
    assert report.rooms_missed == ()
    assert report.rooms_unreached == ()


@pytest.mark.parametrize("side", [(2_000.0, 3.0), (3.0, 2_000.0)])
def test_a_house_of_absurd_size_is_refused_before_it_takes_memory(side: tuple[float, float]):
    huge = Room("hall", RoomType.OTHER, rectangle(0, 0, *side))
    with pytest.raises(InvalidHouseError, match=r"its rooms span .* at most 200 m wide"):
        build_grid(replace(two_rooms(furnished=False), rooms=(huge,)))
