"""`Grid`: the tiles an agent can stand in, derived from MuJoCo's collision queries."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import Point


@dataclass(frozen=True)
class GridReport:
    """How a grid came about: what it covers, what it leaves out, what it took."""

    tiles_free: int = 0
    """Tiles with a standing point inside a room, before those that are cut off were dropped."""
    tiles_reachable: int = 0
    """Tiles of the grid: the largest set that can be walked through."""
    rooms_reached: tuple[str, ...] = ()
    """Ids of the rooms with a tile of the grid."""
    rooms_unreached: tuple[str, ...] = ()
    """Ids of all other rooms, walled off or blocked."""
    rooms_missed: tuple[str, ...] = ()
    """Ids of those of them that openings connect to the rooms reached."""
    measures: tuple[str, ...] = ()
    """What it took to connect the rooms: `"phase"` (tiles shifted against the house's origin),
    `"standing points"` (some tiles left from another point than their centre), `"smaller tile"`."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Free tiles and the open edges between them."""

    tile: float
    """Side of a tile in metres."""
    origin: tuple[float, float]
    """Centre of the tile in column 0, row 0."""
    cells: NDArray[np.int64]
    """[tile, 2]: column (east) and row (north) of each free tile."""
    points: NDArray[np.float64]
    """[tile, 2]: where the agent stands in it, metres, house frame."""
    neighbours: NDArray[np.int64]
    """[tile, 4]: the tile reached going north, east, south, west; -1 if something is in the way."""
    rooms: tuple[str, ...]
    """[tile]: id of the room each standing point lies in."""
    report: GridReport = field(default_factory=GridReport)
    """How it came about."""

    @property
    def tiles(self) -> int:
        """Number of free tiles."""
        return len(self.points)

    def tile_at(self, point: Point) -> int | None:
        """Index of the tile whose square holds `point` (metres); None if it is not of the grid."""
        cell = np.floor((np.array(point) - self.origin) / self.tile + 0.5)
        found = np.flatnonzero((self.cells == cell).all(axis=1))
        return int(found[0]) if len(found) else None
