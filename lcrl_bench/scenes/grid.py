"""`Grid`: the tiles an agent can stand on, derived from MuJoCo's collision queries."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import Point


@dataclass(frozen=True)
class GridReport:
    """How a grid was built: what it covers, what it leaves out, and which measures it took."""

    tiles_free: int = 0
    """Number of tiles with a standing point inside a room, including unreachable ones."""
    tiles_reachable: int = 0
    """Number of tiles of the grid: the largest connected set."""
    rooms_reached: tuple[str, ...] = ()
    """Ids of the rooms with a tile of the grid."""
    rooms_unreached: tuple[str, ...] = ()
    """Ids of all other rooms, walled off or blocked."""
    rooms_missed: tuple[str, ...] = ()
    """Ids of the unreached rooms that openings connect to the reached ones."""
    measures: tuple[str, ...] = ()
    """Measures taken to connect the rooms: `"phase"` (tiles shifted against the house's origin),
    `"standing points"` (some standing points are off the tile's centre), `"smaller tile"`."""


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
    """[tile, 2]: standing point in each tile, metres, house frame."""
    neighbours: NDArray[np.int64]
    """[tile, 4]: the tile to the north, east, south and west; -1 if blocked."""
    rooms: tuple[str, ...]
    """[tile]: id of the room of each standing point."""
    report: GridReport = field(default_factory=GridReport)
    """How it was built."""

    @property
    def tiles(self) -> int:
        """Number of free tiles."""
        return len(self.points)

    def tile_at(self, point: Point) -> int | None:
        """Index of the tile that contains `point` (metres); None if no tile of the grid does."""
        cell = np.floor((np.array(point) - self.origin) / self.tile + 0.5)
        found = np.flatnonzero((self.cells == cell).all(axis=1))
        return int(found[0]) if len(found) else None
