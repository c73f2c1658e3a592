"""`Grid`: the tiles an agent can stand in, derived from MuJoCo's collision queries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


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
    """[tile, 4]: the tile reached going north, east, south, west; -1 where something is in the way."""
    rooms: tuple[str, ...]
    """[tile]: id of the room each standing point lies in."""

    @property
    def tiles(self) -> int:
        """Number of free tiles."""
        return len(self.points)
