"""Whether an agent can walk through a finished house, by plane geometry on the house alone.

The agent is a disc that stands on the centres of lattice tiles and steps straight to the four
adjacent ones. This check shares no code with the generator, so it can find faults there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon
from shapely.geometry import Point as ShapelyPoint
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.house import PASSABLE, House, PlacedObject, RoomType, Wall

TILE: Final = 0.75
RADIUS: Final = 0.2
HEADROOM: Final = 1.2
"""Height in metres below which things block the way."""
THRESHOLD: Final = 0.03
"""Height in metres up to which things can be walked over."""
WITHIN: Final = 0.9
"""Each piece of furniture needs a free tile of its room within this many metres."""


@dataclass(frozen=True, eq=False)
class Walk:
    """Where an agent can stand in a house, and where it can get to."""

    points: NDArray[np.float64]
    """[tile, 2]: centres of the free tiles."""
    rooms: tuple[str, ...]
    """[tile]: id of each tile's room."""
    steps: NDArray[np.int64]
    """[step, 2]: pairs of free tiles one straight step apart."""
    groups: NDArray[np.int64]
    """[tile]: its connected component; 0 is the largest."""
    tiles: dict[str, int]
    """Number of tiles per room, free or not."""


def walk(house: House) -> Walk:
    """The free tiles of a house on the lattice, and the steps between them."""
    solid = shapely.union_all(
        [_wall(wall) for wall in house.walls]
        + [Polygon(thing.footprint()) for thing in house.objects if _in_the_way(thing)]
    )
    every: dict[tuple[int, int], str] = {}
    for room in house.rooms:
        for cell in _cells(Polygon(room.polygon)):
            every[cell] = room.id
    cells = sorted(every)
    middles = np.array([_middle(cell) for cell in cells])
    away = np.asarray(shapely.distance(shapely.points(middles), solid))
    free = [cells[index] for index in np.nonzero(away >= RADIUS)[0].tolist()]
    steps = _steps(free, solid)
    tiles = {room.id: sum(name == room.id for name in every.values()) for room in house.rooms}
    groups = _groups(len(free), steps)
    points = np.array([_middle(cell) for cell in free]).reshape(-1, 2)
    return Walk(points, tuple(every[cell] for cell in free), steps, groups, tiles)


def faults(house: House) -> list[str]:
    """Everything that keeps the agent from walking through a house; empty if nothing does."""
    found = walk(house)
    said: list[str] = []
    for room in house.rooms:
        count = sum(name == room.id for name in found.rooms)
        fewest = 2 if room.type is RoomType.BATHROOM else 4
        if count < fewest:
            said.append(f"room '{room.id}' has {count} free tiles, fewer than {fewest}")
    cut_off = int((found.groups != 0).sum())
    if cut_off:
        said.append(f"{cut_off} free tiles can't be reached")
    for thing in house.objects:
        stands = thing.support is None and thing.base < THRESHOLD and _in_the_way(thing)
        if stands and not _within_reach(thing, found):
            said.append(f"'{thing.id}' can't be reached")
    return said


def _within_reach(thing: PlacedObject, found: Walk) -> bool:
    ours = [name == thing.room for name in found.rooms]
    points = shapely.points(found.points[ours])
    away = np.asarray(shapely.distance(points, Polygon(thing.footprint())))
    return bool(np.any(away <= WITHIN))


def _in_the_way(thing: PlacedObject) -> bool:
    return thing.base < HEADROOM and thing.top > THRESHOLD


def _wall(wall: Wall) -> BaseGeometry:
    """A wall's footprint, without its passable openings."""
    body: BaseGeometry = LineString([wall.start, wall.end]).buffer(
        wall.thickness / 2, cap_style="square"
    )
    for opening in wall.openings:
        if opening.kind in PASSABLE:
            hole = LineString([wall.point(opening.start), wall.point(opening.end)])
            body = body.difference(hole.buffer(wall.thickness, cap_style="flat"))
    return body


def _middle(cell: tuple[int, int]) -> tuple[float, float]:
    return (cell[0] + 0.5) * TILE, (cell[1] + 0.5) * TILE


def _cells(floor: Polygon) -> list[tuple[int, int]]:
    x0, y0, x1, y1 = floor.bounds
    return [
        (column, row)
        for column in range(math.floor(x0 / TILE), math.ceil(x1 / TILE))
        for row in range(math.floor(y0 / TILE), math.ceil(y1 / TILE))
        if floor.contains(ShapelyPoint(_middle((column, row))))
    ]


def _steps(free: list[tuple[int, int]], solid: BaseGeometry) -> NDArray[np.int64]:
    number = {cell: index for index, cell in enumerate(free)}
    pairs = [
        (index, number[other])
        for (column, row), index in number.items()
        for other in ((column + 1, row), (column, row + 1))
        if other in number
    ]
    if not pairs:
        return np.zeros((0, 2), dtype=np.int64)
    ways = shapely.linestrings([[_middle(free[a]), _middle(free[b])] for a, b in pairs])
    clear = np.asarray(shapely.distance(ways, solid)) >= RADIUS
    return np.array(pairs, dtype=np.int64)[clear]


def _groups(count: int, steps: NDArray[np.int64]) -> NDArray[np.int64]:
    parent = list(range(count))

    def root(tile: int) -> int:
        while parent[tile] != tile:
            parent[tile] = parent[parent[tile]]
            tile = parent[tile]
        return tile

    for a, b in steps.tolist():
        parent[root(a)] = root(b)
    roots = [root(tile) for tile in range(count)]
    by_size = sorted(set(roots), key=lambda r: (-roots.count(r), r))
    return np.array([by_size.index(r) for r in roots], dtype=np.int64)
