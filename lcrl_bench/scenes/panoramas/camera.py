"""Geometry of the four views of a panorama: eye positions and pixel directions.

Views are N, E, S, W in the house frame; row 0 is the top, and column 0 the left when facing that
way. Pixels are square, so the vertical field of view follows from the horizontal one. Both
renderers take their cameras from here, so they can't disagree.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.semantics import Semantics

VIEWS: Final = 4
"""Views of a panorama: north, east, south, west."""
NEAR: Final = 0.01
"""Depth of the near plane in metres: anything nearer is invisible."""
FAR: Final = 400.0
"""Depth of the far plane in metres; larger than any house."""
# Standing points and walls share a lattice. An eye exactly on it would see faces edge-on and
# # corners exactly at pixel centres, where rounding alone decides what is visible.
_OFF_LATTICE: Final = (0.0031, 0.0047)

_FORWARD: Final = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))


def eye_positions(points: NDArray[np.float64], semantics: Semantics) -> NDArray[np.float64]:
    """The eye above each standing point.

    Args:
        points: [point, 2] metres, house frame.
        semantics: Provides the eye height.

    Returns:
        [point, 3] metres; a few millimetres off the standing point, off the lattice of tiles.
    """
    heights = np.full((len(points), 1), semantics.eye_height)
    return np.hstack([points + np.asarray(_OFF_LATTICE), heights])


def view_axes(semantics: Semantics) -> NDArray[np.float64]:
    """The orientation of each view.

    Returns:
        [view, 3, 3]: the unit vectors right, forward and up of the views N, E, S, W, tilted by
        `semantics.pitch` (negative looks down).
    """
    level = np.array([[x, y, 0.0] for x, y in _FORWARD])
    right = np.array([[y, -x, 0.0] for x, y in _FORWARD])
    upright = np.array([0.0, 0.0, 1.0])
    cos, sin = math.cos(semantics.pitch), math.sin(semantics.pitch)
    return np.stack([right, cos * level + sin * upright, cos * upright - sin * level], axis=1)


def half_extents(semantics: Semantics) -> tuple[float, float]:
    """Half the width and half the height of the image plane at depth 1."""
    half_width = math.tan(semantics.horizontal_fov / 2)
    return half_width, half_width * semantics.view_height / semantics.view_width


def ray_directions(semantics: Semantics) -> NDArray[np.float64]:
    """The viewing direction through each pixel's centre.

    Returns:
        [view, row, column, 3]: vectors whose component along the view's forward axis is 1, so that
        multiples of them are depths.
    """
    half_width, half_height = half_extents(semantics)
    rows, columns = semantics.view_height, semantics.view_width
    across = half_width * ((2 * np.arange(columns) + 1) / columns - 1)
    upward = half_height * (1 - (2 * np.arange(rows) + 1) / rows)
    axes = view_axes(semantics)[:, :, None, None, :]
    return axes[:, 0] * across[:, None] + axes[:, 1] + axes[:, 2] * upward[:, None, None]
