"""The distinct patches of a house's views with their positions, for a fully connected layer.

`PatchIndex` keeps only *which* second cells a view has; a fully connected layer must also know
*where* they are. After the second convolution come a 2x2 max pool and one weight for every place:

    group   2x2 second cells: the input of one cell of the second max pool
    place   the group at each place of a view

The layers before are those of `PatchIndex`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import torch

from lcrl_bench.networks.distinct import distinct_windows
from lcrl_bench.networks.gathering import Bags
from lcrl_bench.networks.patches import KERNEL, POOL, SECOND_KERNEL

SIDE_MULTIPLE = POOL * POOL
"""Sides of views are multiples of this: two pools halve them twice."""


@dataclass(frozen=True)
class PositionIndex:
    """Distinct windows of a house's views, layer by layer, and the places of the last ones."""

    rows: Bags
    """[row, 5] into [class x column]: `class * 5 + column`."""
    patches: Bags
    """[patch, 5] into [row x line]: `row * 5 + line`."""
    pooled: Bags
    """[4, pooled] into patches, members first."""
    second: Bags
    """[second, 9] into [pooled x place]: `pooled * 9 + place`; the last pooled is padding."""
    groups: Bags
    """[4, group] into second cells, members first."""
    places: Bags
    """[view, place] into groups, a view's places row by row."""
    panoramas: Bags
    """[panorama, 4] into views."""

    def to(self, device: torch.device | str) -> PositionIndex:
        """The same index on another device."""
        return PositionIndex(*(getattr(self, field.name).to(device) for field in fields(self)))


def build_position_index(
    views: torch.Tensor, panorama_views: torch.Tensor, *, classes: int
) -> PositionIndex:
    """Find the distinct patches of a house's views, and their positions.

    Args:
        views: uint8 [view, height, width]: class ids; height and width multiples of four.
        panorama_views: int64 [panorama, 4], indices into `views`.
        classes: Number of classes.

    Returns:
        An index on the device of `views`.

    Raises:
        ValueError: If a class id is not below `classes`, or a side is not a multiple of four.
    """
    ids = views.cpu().numpy()
    if ids.size and int(ids.max()) >= classes:
        raise ValueError(f"views hold class {int(ids.max())}, but there are {classes} classes")
    if any(side % SIDE_MULTIPLE for side in ids.shape[1:]):
        raise ValueError(
            f"views must have sides that are multiples of {SIDE_MULTIPLE},"
            f" found {ids.shape[1]} x {ids.shape[2]}"
        )
    image = _bordered(ids, KERNEL, classes)
    rows, image = distinct_windows(image, height=1, width=KERNEL)
    patches, image = distinct_windows(image, height=KERNEL, width=1)
    pooled, image = distinct_windows(image, height=POOL, width=POOL, stride=POOL)
    image = _bordered(image, SECOND_KERNEL, len(pooled))
    second, image = distinct_windows(image, height=SECOND_KERNEL, width=SECOND_KERNEL)
    groups, image = distinct_windows(image, height=POOL, width=POOL, stride=POOL)
    index = PositionIndex(
        rows=_positioned(rows, classes + 1),
        patches=_positioned(patches, len(rows)),
        pooled=_bags(pooled.T, len(patches)),
        second=_positioned(second, len(pooled) + 1),
        groups=_bags(groups.T, len(second)),
        places=_bags(image.reshape(len(ids), -1), len(groups)),
        panoramas=Bags.of(panorama_views.cpu(), size=len(ids)),
    )
    return index.to(views.device)


def _bordered(image: np.ndarray, kernel: int, value: int) -> np.ndarray:
    """Padding for a convolution: [n, y, x] -> [n, y + kernel - 1, x + kernel - 1]."""
    margin = kernel // 2
    ring = ((0, 0), (margin, margin), (margin, margin))
    return np.pad(image.astype(np.int32), ring, constant_values=value)


def _positioned(windows: np.ndarray, size: int) -> Bags:
    """Bags into a table of [item x position in the window]."""
    positions = windows.shape[1]
    return _bags(windows.astype(np.int64) * positions + np.arange(positions), size * positions)


def _bags(index: np.ndarray, size: int) -> Bags:
    return Bags.of(torch.from_numpy(np.ascontiguousarray(index, np.int64)), size=size)
