"""Small grids made by hand, for tests."""

from __future__ import annotations

import numpy as np

from lcrl_bench.scenes.grid import Grid


def strip(tiles: int, *, room: str = "room-0") -> Grid:
    """A corridor of `tiles` tiles from west to east."""
    neighbours = np.full((tiles, 4), -1)
    neighbours[:-1, 1] = np.arange(1, tiles)
    neighbours[1:, 3] = np.arange(tiles - 1)
    cells = np.stack([np.arange(tiles), np.zeros(tiles, int)], axis=1)
    return Grid(
        tile=0.75,
        origin=(0.375, 0.375),
        cells=cells,
        points=cells * 0.75 + 0.375,
        neighbours=neighbours,
        rooms=(room,) * tiles,
    )
