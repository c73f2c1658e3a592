"""The 0.75 m lattice that floors, walls and doors lie on, and rectangles in plan.

Rooms are unions of lattice cells, walls are centred on lattice lines, and the centre of each cell
is where an agent stands, so a straight step between two cell centres leads through every door.
A rectangle is a row (x0, y0, x1, y1) in metres.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

CELL: Final = 0.75
"""Side of a lattice cell in metres."""
WALL: Final = 0.1
"""Thickness of every wall in metres."""

Rect = tuple[float, float, float, float]
"""(x0, y0, x1, y1) in metres."""
Rects = NDArray[np.float64]
"""[rectangle, 4]."""

FRONTS: Final = ((0, 1), (-1, 0), (0, -1), (1, 0))
"""Direction that something faces after `quarter` quarter turns: north, west, south, east."""
RIGHTS: Final = ((1, 0), (0, 1), (-1, 0), (0, -1))
"""Direction of its width axis after `quarter` quarter turns."""


def yaw_of(quarter: int) -> float:
    """The yaw of `quarter` quarter turns, within -pi .. pi."""
    return (0.0, math.pi / 2, math.pi, -math.pi / 2)[quarter % 4]


def local_point(
    center: tuple[float, float], quarter: int, x: float, y: float
) -> tuple[float, float]:
    """The house-frame position of (x, y) given in the frame of a turned object at `center`."""
    (rx, ry), (fx, fy) = RIGHTS[quarter], FRONTS[quarter]
    return center[0] + x * rx + y * fx, center[1] + x * ry + y * fy


def local_rect(
    center: tuple[float, float], quarter: int, x: tuple[float, float], y: tuple[float, float]
) -> Rect:
    """The house-frame rectangle that spans `x` and `y` in the frame of a turned object."""
    ax, ay = local_point(center, quarter, x[0], y[0])
    bx, by = local_point(center, quarter, x[1], y[1])
    return min(ax, bx), min(ay, by), max(ax, bx), max(ay, by)


def footprint(center: tuple[float, float], quarter: int, width: float, depth: float) -> Rect:
    """The rectangle covered by a turned box of `width` and `depth` around `center`."""
    return local_rect(center, quarter, (-width / 2, width / 2), (-depth / 2, depth / 2))


def as_rects(rects: list[Rect]) -> Rects:
    """Rectangles as an array [rectangle, 4], even if there are none."""
    return np.array(rects, dtype=np.float64).reshape(-1, 4)


def overlaps(ours: Rects, theirs: Rects, gap: float = 0.0) -> NDArray[np.bool_]:
    """[ours, theirs]: whether two rectangles are closer than `gap` on both axes."""
    a, b = ours[:, None, :], theirs[None, :, :]
    reach = gap - 1e-9
    return (
        (a[..., 0] < b[..., 2] + reach)
        & (b[..., 0] < a[..., 2] + reach)
        & (a[..., 1] < b[..., 3] + reach)
        & (b[..., 1] < a[..., 3] + reach)
    )


def any_of(table: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """[row]: whether any entry of a row holds; False for empty rows."""
    return np.logical_or.reduce(table, axis=1)


def distances(ours: Rects, theirs: Rects) -> NDArray[np.float64]:
    """[ours, theirs]: metres between two rectangles, 0 where they touch or overlap."""
    a, b = ours[:, None, :], theirs[None, :, :]
    dx = np.maximum(np.maximum(a[..., 0] - b[..., 2], b[..., 0] - a[..., 2]), 0.0)
    dy = np.maximum(np.maximum(a[..., 1] - b[..., 3], b[..., 1] - a[..., 3]), 0.0)
    return np.hypot(dx, dy)
