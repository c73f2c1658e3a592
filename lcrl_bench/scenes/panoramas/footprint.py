"""The pixels that a box may cover: a conservative test of which rays can hit an object."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.camera import NEAR, half_extents, view_axes
from lcrl_bench.scenes.panoramas.visibility import in_frustum
from lcrl_bench.semantics import Semantics

_MARGIN: Final = 1e-3
"""Metres by which a box is enlarged, to cover rounding; plus a millionth of its coordinates, as
rays are float32."""


def covered_pixels(
    box: NDArray[np.float64],
    eyes: NDArray[np.float64],
    depths: NDArray[np.float32],
    semantics: Semantics,
) -> NDArray[np.int64]:
    """The pixels at which a box may be nearer than something else.

    Args:
        box: [2, 3] lowest and highest corner, metres.
        eyes: [eye, 3] metres.
        depths: [eye, pixel] depths, from the near plane on, of what may hide it.
        semantics: The views' orientation, field of view and size.

    Returns:
        int64 [covered], in order: `eye * pixels + pixel`.
    """
    margin = _MARGIN + 1e-6 * np.abs(box).max()
    box = box + np.array([[-margin], [margin]])
    eye, view = np.nonzero(in_frustum(box[:, None], eyes, semantics)[..., 0])
    choice = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
    corners = box[choice, np.arange(3)] - eyes[eye][:, None]
    # [rectangle, corner] along the view's three axes.
    right, forward, up = np.einsum("rck,rak->arc", corners, view_axes(semantics)[view])
    # A box that reaches behind the near plane may be anywhere in the view.
    near = forward.min(axis=1) <= 2 * NEAR
    forward = np.where(near[:, None], 1.0, forward)
    half_width, half_height = half_extents(semantics)
    rows, columns = semantics.view_height, semantics.view_width
    left, width = _span(right / forward / half_width, columns, near)
    top, height = _span(-up / forward / half_height, rows, near)
    sizes = width * height
    # The pixels of all rectangles, one after the other.
    rectangle = np.repeat(np.arange(len(sizes)), sizes)
    number = np.arange(len(rectangle)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    row, column = np.divmod(number, width[rectangle])
    row, column = row + top[rectangle], column + left[rectangle]
    size = rows * columns
    first = (eye * depths.shape[1] + view * size)[rectangle]
    pixels = first + row * columns + column
    # No ray meets the box before the depth of its nearest corner.
    nearest = np.where(near, 0.0, forward.min(axis=1))[rectangle] - NEAR
    return pixels[depths.reshape(-1)[pixels] > nearest]


def _span(
    places: NDArray[np.float64], pixels: int, near: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First pixel and number of pixels that each range of places may cover.

    Args:
        places: [rectangle, corner] along an axis of the image, -1 and 1 at its edges.
        pixels: Pixels along that axis.
        near: [rectangle]: whether to return all of them.
    """
    # One pixel more on each side, to cover rounding.
    start = np.floor((places.min(axis=1) + 1) / 2 * pixels).clip(1, pixels) - 1
    end = np.ceil((places.max(axis=1) + 1) / 2 * pixels).clip(0, pixels - 1) + 1
    start, end = np.where(near, 0, start), np.where(near, pixels, end)
    return start.astype(np.int64), (end - start).clip(0).astype(np.int64)
