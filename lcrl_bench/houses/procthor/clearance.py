"""How far a box must move to be clear of walls with thickness.

Walls of ProcTHOR files have no thickness, and objects against or on them touch their middle
plane: without this, paintings would hang inside our walls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lcrl_bench.houses.house import Wall

CLEARANCE = 0.002
"""Gap in metres left between a wall and an object moved out of it: faces must not coincide."""

_BEYOND_CENTRE_LINE = 0.03
_CLOSE = 1e-9


@dataclass(frozen=True)
class WallFaces:
    """The walls of a house as arrays, to compute how far a box must move to be clear of them."""

    start: np.ndarray
    """float64[wall, 2]"""
    along: np.ndarray
    """float64[wall, 2]: unit vectors."""
    length: np.ndarray
    """float64[wall]"""
    half: np.ndarray
    """float64[wall]: half the thickness."""

    @classmethod
    def of(cls, walls: tuple[Wall, ...]) -> WallFaces:
        """The faces of these walls."""
        start = np.array([wall.start for wall in walls], dtype=float).reshape(-1, 2)
        end = np.array([wall.end for wall in walls], dtype=float).reshape(-1, 2)
        length = np.array([wall.length for wall in walls], dtype=float)
        half = np.array([wall.thickness / 2 for wall in walls], dtype=float)
        return cls(start, (end - start) / length[:, None], length, half)

    def shift(self, corners: np.ndarray, center: np.ndarray) -> np.ndarray:
        """The displacement that moves a box out of the walls it intersects.

        Args:
            corners: float64[4, 2]: its footprint.
            center: float64[2].

        Returns:
            float64[2]: zero if it is clear, or so deep in a wall that this must be intended.
        """
        total = np.zeros(2)
        for _ in range(4):
            depth, normal = self._depth(corners + total, center + total)
            deepest = int(np.argmax(depth)) if len(depth) else 0
            if not len(depth) or depth[deepest] <= _CLOSE:
                break
            total = total + depth[deepest] * normal[deepest]
        return total

    def _depth(self, corners: np.ndarray, center: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How deep a box is in each wall (0 if clear of it), and the direction out."""
        normal = np.stack([-self.along[:, 1], self.along[:, 0]], axis=1)
        side = np.sign(np.sum((center - self.start) * normal, axis=1))
        normal = normal * np.where(side == 0, 1.0, side)[:, None]
        relative = corners[None] - self.start[:, None]
        lengthwise = np.einsum("wck,wk->wc", relative, self.along)
        across = np.einsum("wck,wk->wc", relative, normal).min(axis=1)
        beside = (lengthwise.max(axis=1) > _CLOSE) & (lengthwise.min(axis=1) < self.length - _CLOSE)
        depth = self.half + CLEARANCE - across
        shallow = (depth > 0) & (across >= -_BEYOND_CENTRE_LINE)
        return np.where(beside & shallow, depth, 0.0), normal
