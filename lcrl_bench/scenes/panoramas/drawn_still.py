"""The static meshes as OpenGL draws them, and which pixels of an object hide them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.camera import FAR, NEAR
from lcrl_bench.scenes.panoramas.layers import Layer, StillHouse


@dataclass(frozen=True, eq=False)
class DrawnStill(StillHouse):
    """`StillHouse`, with what decides whether the driver draws over a pixel."""

    nearness: NDArray[np.float32]
    """[panorama, pixel]: the depth buffer, 1 at the near plane, 0 at the far plane."""
    meshes: NDArray[np.uint16]
    """[panorama, pixel]: number of the mesh drawn, from 1 on; 0 where there is none."""

    @classmethod
    def of(cls, colors: NDArray[np.uint8], nearness: NDArray[np.float32]) -> DrawnStill:
        """Take what was read.

        Args:
            colors: [panorama, pixel, 3]: class in red, mesh in green and blue.
            nearness: [panorama, pixel].
        """
        far = NEAR * FAR / (nearness.astype(np.float64) * (FAR - NEAR) + NEAR) - NEAR
        return cls(
            # A little farther, to cover rounding.
            (1.0001 * far).astype(np.float32),
            colors[..., 0].copy(),
            nearness,
            _meshes(colors),
        )

    def in_front(
        self, first: int, colors: NDArray[np.uint8], nearness: NDArray[np.float32]
    ) -> Layer:
        """The pixels of an object, drawn alone, that the driver would draw over the static meshes.

        Args:
            first: Index of the first pixel of its view among those of all panoramas.
            colors: [row, column, 3], as in `of`.
            nearness: [row, column].
        """
        part = slice(first, first + nearness.size)
        behind, below = self.nearness.reshape(-1)[part], self.meshes.reshape(-1)[part]
        near, meshes = nearness.reshape(-1), _meshes(colors).reshape(-1)
        # Of equally near meshes, the last is drawn over the others.
        front = (meshes > 0) & ((near > behind) | ((near == behind) & (meshes > below)))
        pixels = np.flatnonzero(front)
        return Layer(first + pixels, -near[pixels], colors[..., 0].reshape(-1)[pixels])


def _meshes(colors: NDArray[np.uint8]) -> NDArray[np.uint16]:
    return colors[..., 1] + colors[..., 2].astype(np.uint16) * 256
