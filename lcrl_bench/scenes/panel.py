"""`Panel`: an upright slab with rectangular holes, for walls, linings and window frames.

A panel has its own frame: u runs along it, y across it, z up. It is cut into cells at the edges of
its holes, so its mesh is closed and its corners are shared: no ray passes through a seam.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import Point

Rectangle = tuple[float, float, float, float]
"""(near, low, far, high): extent along u, then z, in metres."""


@dataclass(frozen=True)
class Box:
    """A collision box; boxes of one panel don't overlap."""

    name: str
    """Unique in its house."""
    label: str
    """Class name."""
    center: tuple[float, float, float]
    """Metres, house frame."""
    half: tuple[float, float, float]
    """Half extents along, across and up."""
    yaw: float
    """Direction of its length, radians counter-clockwise from east."""


@dataclass(frozen=True, eq=False)
class Panel:
    """An upright slab, cut into cells, some of which are holes."""

    name: str
    """Unique in its house."""
    label: str
    """Class name."""
    origin: Point
    """Where u is 0."""
    yaw: float
    """Direction of u, radians counter-clockwise from east."""
    thickness: float
    """Thickness in metres, centred on the line."""
    along: NDArray[np.float64]
    """[column + 1]: edges of the cells in u, ascending."""
    up: NDArray[np.float64]
    """[row + 1]: edges of the cells in z, ascending."""
    solid: NDArray[np.bool_]
    """[column, row]: which cells are filled."""

    def mesh(self) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Its closed surface in the house frame.

        Returns:
            [vertex, 3] metres and [triangle, 3] counter-clockwise seen from outside.
        """
        columns, rows = len(self.along), len(self.up)
        index = np.arange(columns * rows * 2, dtype=np.int32).reshape(columns, rows, 2)
        faces = _triangles(_quads(index, self.solid))
        used, flat = np.unique(faces, return_inverse=True)
        u, z, side = np.meshgrid(self.along, self.up, (-0.5, 0.5), indexing="ij")
        local = np.stack([u, side * self.thickness, z], axis=-1).reshape(-1, 3)[used]
        return self._to_house(local), flat.reshape(-1, 3).astype(np.int32)

    def boxes(self) -> tuple[Box, ...]:
        """Disjoint boxes that fill its solid cells: runs in a column, equal columns merged."""
        placed = []
        for near, far, low, high in _runs(self.along, self.up, self.solid):
            center = self._to_house(np.array([(near + far) / 2, 0.0, (low + high) / 2]))
            x, y, z = (float(value) for value in center)
            half = ((far - near) / 2, self.thickness / 2, (high - low) / 2)
            name = f"{self.name}.box-{len(placed)}"
            placed.append(Box(name, self.label, (x, y, z), half, self.yaw))
        return tuple(placed)

    def area(self) -> float:
        """Area of one side in square metres, without holes."""
        cells = np.outer(np.diff(self.along), np.diff(self.up))
        return float(cells[self.solid].sum())

    def _to_house(self, local: NDArray[np.float64]) -> NDArray[np.float64]:
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
        return local @ turn + (*self.origin, 0.0)


def cut_panel(
    name: str,
    label: str,
    line: tuple[Point, float],
    thickness: float,
    outline: Rectangle,
    holes: list[Rectangle],
) -> Panel:
    """Cut rectangular holes into an upright slab.

    Args:
        name: Unique in its house.
        label: Class name.
        line: Where u is 0, and the direction of u.
        thickness: Extent across, in metres.
        outline: The slab; holes may overlap its edge.
        holes: What to cut out; empty ones are ignored.
    """
    near, low, far, high = outline
    holes = [hole for hole in holes if hole[0] < hole[2] and hole[1] < hole[3]]
    along = _edges(near, far, [edge for hole in holes for edge in (hole[0], hole[2])])
    up = _edges(low, high, [edge for hole in holes for edge in (hole[1], hole[3])])
    u, z = (along[:-1] + along[1:]) / 2, (up[:-1] + up[1:]) / 2
    solid = np.ones((len(u), len(z)), bool)
    for left, bottom, right, top in holes:
        solid &= ~np.outer((left < u) & (u < right), (bottom < z) & (z < top))
    origin, yaw = line
    return Panel(name, label, origin, yaw, thickness, along, up, solid)


def _edges(low: float, high: float, cuts: list[float]) -> NDArray[np.float64]:
    inside = [cut for cut in cuts if low < cut < high]
    return np.unique(np.array([low, high, *inside]))


def _quads(index: NDArray[np.int32], solid: NDArray[np.bool_]) -> NDArray[np.int32]:
    """The outer sides of all solid cells: [quad, 4], counter-clockwise seen from outside."""
    near_low, far_low = index[:-1, :-1], index[1:, :-1]
    near_high, far_high = index[:-1, 1:], index[1:, 1:]
    around = np.pad(solid, 1)
    columns, rows = slice(1, -1), slice(1, -1)
    sides = [
        (solid, (near_low[..., 0], far_low[..., 0], far_high[..., 0], near_high[..., 0])),
        (solid, (far_low[..., 1], near_low[..., 1], near_high[..., 1], far_high[..., 1])),
        (
            solid & ~around[:-2, rows],
            (near_low[..., 1], near_low[..., 0], near_high[..., 0], near_high[..., 1]),
        ),
        (
            solid & ~around[2:, rows],
            (far_low[..., 0], far_low[..., 1], far_high[..., 1], far_high[..., 0]),
        ),
        (
            solid & ~around[columns, :-2],
            (near_low[..., 1], far_low[..., 1], far_low[..., 0], near_low[..., 0]),
        ),
        (
            solid & ~around[columns, 2:],
            (near_high[..., 0], far_high[..., 0], far_high[..., 1], near_high[..., 1]),
        ),
    ]
    return np.concatenate([np.stack(corners, axis=-1)[mask] for mask, corners in sides])


def _triangles(quads: NDArray[np.int32]) -> NDArray[np.int32]:
    return quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def _runs(
    along: NDArray[np.float64], up: NDArray[np.float64], solid: NDArray[np.bool_]
) -> list[tuple[float, ...]]:
    """(near, far, low, high) of the fewest column-wise boxes that fill the solid cells."""
    found: list[tuple[float, ...]] = []
    column = 0
    while column < len(solid):
        after = column + 1
        while after < len(solid) and np.array_equal(solid[after], solid[column]):
            after += 1
        change = np.flatnonzero(np.diff(np.pad(solid[column], 1).astype(np.int8)))
        for low, high in change.reshape(-1, 2):
            found.append(
                (float(along[column]), float(along[after]), float(up[low]), float(up[high]))
            )
        column = after
    return found
