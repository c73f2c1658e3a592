"""A house from above, in metres: walls, footprints, tiles, borders, and the places A and B."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.house import House, OpeningKind, Point, Wall
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.episode import Episode
from lcrl_bench.scenes.grid import Grid


@dataclass(frozen=True, eq=False)
class HousePlan:
    """A house seen from above."""

    house: House
    extent: tuple[Point, Point]
    """The lowest and highest (x, y) of rooms and walls."""
    walls: tuple[tuple[NDArray[np.float64], OpeningKind | None], ...]
    """Pieces of walls: corners [4, 2] and opening; see `wall_pieces`."""
    footprints: tuple[NDArray[np.float64], ...]
    """Corners [4, 2] of each object, the front edge last."""


@dataclass(frozen=True)
class Place:
    """A place of the object that PICK moves: A, where it is found, or B, where it is to go."""

    letter: str
    label: str
    """`"A: cup"`, `"B"`."""
    at: Point
    top: float
    """Height of the upper side of the object there."""
    part: ObjectState
    """Where the object is while it is there."""


@dataclass(frozen=True, eq=False)
class Floor:
    """The tiles of an episode's house, the borders of those that matter, and the places A and B."""

    shapes: tuple[BaseGeometry, ...]
    """The floor of each tile."""
    borders: tuple[list[NDArray[np.float64]], ...]
    """Closed lines [point, 2] around each tile."""
    centers: NDArray[np.float64]
    """[tile, 2]."""
    take: list[NDArray[np.float64]]
    """Closed lines [point, 2] around the tiles where the object can be taken."""
    goal: list[NDArray[np.float64]]
    """The same of the goal's tiles; inset less, so that both borders show."""
    places: tuple[Place, ...]
    """A and B; none for NAV."""
    plan: HousePlan
    """The house around it."""


def house_plan(house: House) -> HousePlan:
    """A house seen from above."""
    return HousePlan(
        house=house,
        extent=extent(house),
        footprints=tuple(np.array(thing.footprint()) for thing in house.objects),
        walls=tuple(piece for wall in house.walls for piece in wall_pieces(wall)),
    )


def episode_floor(episode: Episode) -> Floor:
    """The floor of an episode."""
    house, grid = episode.scene.house, episode.scene.grid
    shapes = tile_shapes(house, grid)
    return Floor(
        shapes=shapes,
        borders=tuple(map(rings, shapes)),
        centers=tile_centers(grid),
        take=outline(shapes, episode.take_tiles, inset=0.07),
        goal=outline(shapes, episode.goal_tiles, inset=0.03),
        places=_places(episode),
        plan=house_plan(house),
    )


def _places(episode: Episode) -> tuple[Place, ...]:
    found, placed = episode.thing, episode.task.placement
    if found is None or placed is None:
        return ()
    label = f"A: {episode.thing_name}"
    return (
        Place("A", label, found.position[:2], found.top, ObjectState.AT_A),
        Place("B", "B", placed.position[:2], placed.top, ObjectState.AT_B),
    )


def extent(house: House) -> tuple[Point, Point]:
    """The lowest and highest (x, y) of a house's rooms and walls."""
    corners = [corner for room in house.rooms for corner in room.polygon]
    corners += [end for wall in house.walls for end in (wall.start, wall.end)]
    (x0, y0), (x1, y1) = np.min(corners, axis=0), np.max(corners, axis=0)
    return (float(x0), float(y0)), (float(x1), float(y1))


def wall_pieces(wall: Wall) -> list[tuple[NDArray[np.float64], OpeningKind | None]]:
    """A wall seen from above, cut at its openings.

    Returns:
        Corners [4, 2] of each piece in metres, and its opening; None where it is solid.
    """
    pieces: list[tuple[float, float, OpeningKind | None]] = []
    reached = 0.0
    for opening in wall.openings:
        pieces.append((reached, opening.start, None))
        pieces.append((opening.start, opening.end, opening.kind))
        reached = opening.end
    pieces.append((reached, wall.length, None))
    (x0, y0), (x1, y1) = wall.start, wall.end
    across = np.array([y0 - y1, x1 - x0]) / wall.length * wall.thickness / 2
    drawn = []
    for start, end, kind in pieces:
        if end - start > 1e-6:
            a, b = np.array(wall.point(start)), np.array(wall.point(end))
            drawn.append((np.stack([a - across, b - across, b + across, a + across]), kind))
    return drawn


def tile_centers(grid: Grid) -> NDArray[np.float64]:
    """[tile, 2] metres: the centre of each tile's square (the agent may stand beside it)."""
    return np.asarray(grid.origin, np.float64) + grid.cells * np.float64(grid.tile)


def tile_shapes(house: House, grid: Grid) -> tuple[BaseGeometry, ...]:
    """The floor of each tile in metres: the part of its square inside the house.

    A grid is laid so that rooms connect, not so that its squares end at walls.
    """
    floor = shapely.union_all([shapely.Polygon(room.polygon) for room in house.rooms])
    half = grid.tile / 2
    squares = [shapely.box(x - half, y - half, x + half, y + half) for x, y in tile_centers(grid)]
    return tuple(square.intersection(floor) for square in squares)


def rings(shape: BaseGeometry) -> list[NDArray[np.float64]]:
    """The closed border lines of a shape, [point, 2] metres, the first point repeated at the end.

    Outer borders come first; an empty shape has none.
    """
    polygons = [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon)]
    lines = [part.exterior for part in polygons]
    lines += [hole for part in polygons for hole in part.interiors]
    return [np.array(line.coords) for line in lines if not line.is_empty]


def outline(
    shapes: Sequence[BaseGeometry], tiles: NDArray[np.bool_], inset: float = 0.0
) -> list[NDArray[np.float64]]:
    """The border of a set of tiles, as closed lines.

    Args:
        shapes: What `tile_shapes` returned.
        tiles: bool [tile].
        inset: Metres the border is drawn inside the tiles, so that two borders both show.

    Returns:
        [point, 2] metres each.
    """
    chosen = [shape for shape, wanted in zip(shapes, tiles, strict=True) if wanted]
    whole = shapely.union_all(chosen, grid_size=1e-6)
    return rings(whole.buffer(-inset, join_style="mitre") if inset else whole)
