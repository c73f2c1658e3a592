"""Frustum culling: a conservative test of which meshes a view can see at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.camera import half_extents, view_axes
from lcrl_bench.semantics import Semantics

_MARGIN: Final = 1e-3
"""Metres by which boxes are enlarged, to cover rounding."""


def bounding_boxes(meshes: Sequence[NDArray[np.float64] | None]) -> NDArray[np.float64]:
    """The axis-aligned bounding box of each mesh's vertices [vertex, 3]; all zero for None.

    Returns:
        [2, mesh, 3]: lowest and highest corner, metres.
    """
    nothing = np.zeros((1, 3))
    filled = [nothing if mesh is None else mesh for mesh in meshes]
    lows = [mesh.min(axis=0) for mesh in filled]
    highs = [mesh.max(axis=0) for mesh in filled]
    return np.array([lows, highs]).reshape(2, -1, 3)


def in_frustum(
    boxes: NDArray[np.float64], eyes: NDArray[np.float64], semantics: Semantics
) -> NDArray[np.bool_]:
    """Whether part of each box may lie inside each view's frustum.

    Args:
        boxes: [2, box, 3] lowest and highest corner, metres.
        eyes: [eye, 3] metres.
        semantics: The views' orientation and field of view.

    Returns:
        [eye, 4, box]; False only if the whole box is outside.
    """
    half_width, half_height = half_extents(semantics)
    right, forward, up = np.moveaxis(view_axes(semantics), 1, 0)
    sides = (
        half_width * forward + right,
        half_width * forward - right,
        half_height * forward + up,
        half_height * forward - up,
    )
    # [view, side, 3]: all normals point inside the frustum.
    normals = np.stack(sides, axis=1)
    centres, halves = boxes.mean(axis=0), (boxes[1] - boxes[0]) / 2 + _MARGIN
    # Extent of the box's farthest corner along each normal, [view, side, box].
    reach = normals @ centres.T + np.abs(normals) @ halves.T
    inside = reach >= np.einsum("vsk,ek->evs", normals, eyes)[..., None]
    return inside.all(axis=2)
