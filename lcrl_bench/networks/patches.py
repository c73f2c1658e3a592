"""What repeats in the views of a house, found once, so that a network computes it once.

Semantic views are flat areas of class ids: a house's views hold ten times more 5x5 patches than
distinct ones. `PatchIndex` names each distinct patch once, layer by layer of the paper's encoder:

    row     five class ids side by side
    patch   five rows: what one output of the 5x5 convolution sees
    pooled  2x2 patches: what one cell after the 2x2 max pool sees
    second  3x3 pooled cells: what one output of the 3x3 convolution sees
    view    the distinct second cells in a view: what the global max pool sees

Outside a view there is one more class, `classes`, which carries no weight: zero padding.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import torch

from lcrl_bench.networks.gathering import Bags

KERNEL = 5
"""Side of the first convolution."""
POOL = 2
"""Side of the max pool after it."""
SECOND_KERNEL = 3
"""Side of the second convolution."""
GROUP = 16
"""Second cells are searched for the largest in groups of this many."""
_KEY_LIMIT = 2**62


@dataclass(frozen=True)
class PatchIndex:
    """Distinct patches of a house's views; every layer indexes into the one before."""

    rows: Bags
    """[row, 5] into [class x column]: `class * 5 + column`."""
    patches: Bags
    """[patch, 5] into [row x line]: `row * 5 + line`."""
    pooled: torch.Tensor
    """int32 [4, pooled]: patches."""
    second: torch.Tensor
    """int32 [second, 9]: pooled cells; the number after the last stands for padding."""
    views: torch.Tensor
    """int64 [16, view, group]: the second cells of each view, filled up by repeating the first."""
    panoramas: Bags
    """[panorama, 4] into views."""

    def to(self, device: torch.device | str) -> PatchIndex:
        """The same index on another device."""
        return PatchIndex(*(getattr(self, field.name).to(device) for field in fields(self)))


def build_patch_index(
    views: torch.Tensor, panorama_views: torch.Tensor, *, classes: int
) -> PatchIndex:
    """Find what repeats in the views of a house.

    Args:
        views: uint8 [view, height, width]: class ids; height and width even.
        panorama_views: int64 [panorama, 4], indices into `views`.
        classes: Number of classes.

    Returns:
        An index on the device of `views`.

    Raises:
        ValueError: If a class id is not below `classes`, or a side is odd.
    """
    ids = views.cpu().numpy()
    if ids.size and int(ids.max()) >= classes:
        raise ValueError(f"views hold class {int(ids.max())}, but there are {classes} classes")
    if any(side % POOL for side in ids.shape[1:]):
        raise ValueError(f"views must have even sides, found {ids.shape[1]} x {ids.shape[2]}")
    margin = KERNEL // 2
    padded = np.pad(ids, ((0, 0), (margin, margin), (margin, margin)), constant_values=classes)
    rows, row_of = _distinct(_windows(padded, 1, KERNEL))
    patches, patch_of = _distinct(_windows(row_of, KERNEL, 1))
    pooled, pooled_of = _distinct(_windows(patch_of, POOL, POOL)[:, ::POOL, ::POOL])
    ring = ((0, 0), (1, 1), (1, 1))
    bordered = np.pad(pooled_of, ring, constant_values=len(pooled))
    second, second_of = _distinct(_windows(bordered, SECOND_KERNEL, SECOND_KERNEL))
    index = PatchIndex(
        rows=_positioned(rows, classes + 1),
        patches=_positioned(patches, len(rows)),
        pooled=torch.from_numpy(pooled.T.astype(np.int32)).contiguous(),
        second=torch.from_numpy(second.astype(np.int32)),
        views=torch.from_numpy(_members(second_of.reshape(len(ids), -1))),
        panoramas=Bags.of(panorama_views.cpu(), size=len(ids)),
    )
    return index.to(views.device)


def _windows(image: np.ndarray, height: int, width: int) -> np.ndarray:
    """Every window of an image: [n, y, x] -> [n, y - height + 1, x - width + 1, height * width]."""
    shape = (height, width)
    windows = np.lib.stride_tricks.sliding_window_view(image, shape, axis=(1, 2))
    return windows.reshape(*windows.shape[:3], -1)


def _distinct(windows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct windows, and which one stands at each place.

    Columns are packed into one integer as long as it holds them, else numbered afresh: exact, and
    many times faster than comparing rows.

    Args:
        windows: [..., column], non-negative integers.

    Returns:
        int64 [distinct, column] and int64 [...].
    """
    flat = windows.reshape(-1, windows.shape[-1]).astype(np.int64)
    radix = int(flat.max(initial=0)) + 1
    key, span = flat[:, 0], radix
    for column in flat.T[1:]:
        if span * radix >= _KEY_LIMIT:
            kept, key = np.unique(key, return_inverse=True)
            span = len(kept)
        key, span = key * radix + column, span * radix
    _, first, number = np.unique(key, return_index=True, return_inverse=True)
    return flat[first], number.reshape(windows.shape[:-1])


def _positioned(windows: np.ndarray, size: int) -> Bags:
    """Bags into a table of [item x position in the window]."""
    positions = windows.shape[1]
    index = windows * positions + np.arange(positions)
    return Bags.of(torch.from_numpy(index), size=size * positions)


def _members(cells: np.ndarray) -> np.ndarray:
    """The distinct entries of every row, in groups, filled up by repeating the first."""
    ordered = np.sort(cells, axis=1)
    new = np.ones(ordered.shape, bool)
    new[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
    counts = new.sum(1)
    slots = np.arange(-(-int(counts.max(initial=1)) // GROUP) * GROUP)
    members = np.repeat(ordered[:, :1], len(slots), axis=1)
    members[slots < counts[:, None]] = ordered[new]
    return members.reshape(len(cells), -1, GROUP).transpose(2, 0, 1).copy()
