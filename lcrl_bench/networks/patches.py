"""The distinct patches of a house's views, so that a network computes each of them once.

Semantic views consist of flat areas of class ids: a house's views have ten times as many 5x5
patches as distinct ones. `PatchIndex` lists the distinct windows of every layer of the paper's
encoder:

    row     five class ids side by side
    patch   five rows: the input of one output of the 5x5 convolution
    pooled  2x2 patches, 6x6 class ids: the input of one cell of the 2x2 max pool
    second  3x3 pooled cells: the input of one output of the 3x3 convolution
    view    the distinct second cells of a view: the input of the global max pool

Outside a view there is one more class, `classes`, without weights: zero padding.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import torch

from lcrl_bench.networks.distinct import distinct_windows
from lcrl_bench.networks.gathering import Bags

KERNEL = 5
"""Side of the first convolution."""
POOL = 2
"""Side of the max pool after it."""
SECOND_KERNEL = 3
"""Side of the second convolution."""
GROUP = 16
"""The maximum over second cells is taken in groups of this size."""
_FIELD = KERNEL + POOL - 1
"""Side of the receptive field of a pooled cell."""


@dataclass(frozen=True)
class PatchIndex:
    """Distinct windows of a house's views; every layer indexes into the one before.

    The fields are on the CPU and are all that a compiled kernel needs: a step reads all of them, so
    numbers are uint16 wherever they fit, and int32 elsewhere. The properties arrange them
    for torch, on `device`; each is computed on first use and cached.
    """

    classes: int
    """Number of classes; the next class id stands for padding."""
    row_classes: torch.Tensor
    """[row, 5]: class ids."""
    cell_rows: torch.Tensor
    """[pooled, 12]: rows, two side by side on each of six lines."""
    windows: torch.Tensor
    """[second, 9]: pooled cells; the next number after the last stands for padding."""
    members: torch.Tensor
    """[member]: the distinct second cells of each view, ascending, view after view."""
    starts: torch.Tensor
    """int64 [view + 1]: where the members of each view begin."""
    viewers: torch.Tensor
    """[member]: the views of each distinct second cell, ascending, cell after cell."""
    viewer_starts: torch.Tensor
    """int32 [second + 1]: where the viewers of each second cell begin."""
    panorama_views: torch.Tensor
    """int64 [panorama, 4]: views."""
    device: torch.device
    """Device of the properties."""

    def to(self, device: torch.device | str) -> PatchIndex:
        """The same index for another device."""
        device = torch.device(device)
        return self if device == self.device else replace(self, device=device)

    @cached_property
    def rows(self) -> Bags:
        """[row, 5] into [class x column]: `class * 5 + column`."""
        return _positioned(self.row_classes, self.classes + 1).to(self.device)

    @cached_property
    def patches(self) -> Bags:
        """[patch, 5] into [row x line]: `row * 5 + line`."""
        return _positioned(self._patches[0], len(self.row_classes)).to(self.device)

    @cached_property
    def pooled(self) -> torch.Tensor:
        """int32 [4, pooled]: patches."""
        return self._patches[1].to(self.device)

    @cached_property
    def second(self) -> torch.Tensor:
        """int32 [second, 9]: pooled cells; the next number after the last stands for padding."""
        return self.windows.int().to(self.device)

    @cached_property
    def views(self) -> torch.Tensor:
        """int64 [16, view, group]: the second cells of a view, padded by repeating the first."""
        counts = self.starts.diff()
        slots = torch.arange(-(-int(counts.max()) // GROUP) * GROUP if len(counts) else 0)
        entry = self.starts[:-1, None] + torch.where(slots < counts[:, None], slots, 0)
        members = self.members.long()[entry].view(len(counts), -1, GROUP)
        return members.permute(2, 0, 1).contiguous().to(self.device)

    @cached_property
    def panoramas(self) -> Bags:
        """[panorama, 4] into views."""
        return Bags.of(self.panorama_views, size=len(self.starts) - 1).to(self.device)

    @cached_property
    def _patches(self) -> tuple[torch.Tensor, torch.Tensor]:
        """int32 [patch, 5] rows, and int32 [4, pooled] patches."""
        cells = self.cell_rows.int().numpy().reshape(-1, _FIELD, POOL)
        patches, patch_of = distinct_windows(cells, height=KERNEL, width=1)
        pooled = np.ascontiguousarray(patch_of.reshape(len(cells), POOL**2).T)
        return torch.from_numpy(patches), torch.from_numpy(pooled)


def build_patch_index(
    views: torch.Tensor, panorama_views: torch.Tensor, *, classes: int
) -> PatchIndex:
    """Find the distinct patches of a house's views.

    Args:
        views: uint8 [view, height, width]: class ids; height and width even.
        panorama_views: int64 [panorama, 4], indices into `views`.
        classes: Number of classes.

    Returns:
        An index whose properties are on the device of `views`.

    Raises:
        ValueError: If a class id is not below `classes`, or a side is odd.
    """
    ids = views.cpu().numpy()
    if ids.size and int(ids.max()) >= classes:
        raise ValueError(f"views hold class {int(ids.max())}, but there are {classes} classes")
    if any(side % POOL for side in ids.shape[1:]):
        raise ValueError(f"views must have even sides, found {ids.shape[1]} x {ids.shape[2]}")
    image = _bordered(ids.astype(np.int32), KERNEL // 2, classes)
    rows, image = distinct_windows(image, height=1, width=KERNEL)
    cells, image = distinct_windows(image, height=_FIELD, width=POOL, stride=POOL)
    image = _bordered(image, SECOND_KERNEL // 2, len(cells))
    windows, image = distinct_windows(image, height=SECOND_KERNEL, width=SECOND_KERNEL)
    members, starts = _members(image.reshape(len(ids), -1))
    view_of = np.repeat(np.arange(len(ids)), np.diff(starts))
    viewers = view_of[np.argsort(members, kind="stable")]
    viewer_starts = np.zeros(len(windows) + 1, np.int32)
    np.cumsum(np.bincount(members, minlength=len(windows)), out=viewer_starts[1:])
    return PatchIndex(
        classes=classes,
        row_classes=_narrow(rows),
        cell_rows=_narrow(cells),
        windows=_narrow(windows),
        members=_narrow(members),
        starts=torch.from_numpy(starts),
        viewers=_narrow(viewers),
        viewer_starts=torch.from_numpy(viewer_starts),
        panorama_views=panorama_views.cpu(),
        device=views.device,
    )


def _bordered(image: np.ndarray, margin: int, filling: int) -> np.ndarray:
    """Pad images on all sides: [n, y, x] -> [n, y + 2 * margin, x + 2 * margin]."""
    ring = ((0, 0), (margin, margin), (margin, margin))
    return np.pad(image, ring, constant_values=filling)


def _narrow(numbers: np.ndarray) -> torch.Tensor:
    """The same numbers as uint16 if they fit, else as int32."""
    fits = int(numbers.max(initial=0)) <= np.iinfo(np.uint16).max
    return torch.from_numpy(numbers.astype(np.uint16 if fits else np.int32))


def _positioned(windows: torch.Tensor, size: int) -> Bags:
    """Bags into a table of [item x position in the window]."""
    positions = windows.shape[1]
    index = windows.long() * positions + torch.arange(positions)
    return Bags.of(index, size=size * positions)


def _members(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The distinct entries of each row, ascending and concatenated, and where each row begins."""
    ordered = np.sort(cells, axis=1)
    new = np.ones(ordered.shape, bool)
    new[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
    starts = np.concatenate([[0], np.cumsum(new.sum(1))])
    return ordered[new], starts.astype(np.int64)
