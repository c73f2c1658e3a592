"""Distinct windows of integer images, numbered in order of first appearance."""

from __future__ import annotations

import numpy as np
import torch

from lcrl_bench.mdp.kernels.dispatch import use_kernel

_KEY_LIMIT = 2**62


def distinct_windows(
    images: np.ndarray, *, height: int, width: int, stride: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Find the distinct windows of images.

    Args:
        images: int32 [image, y, x], non-negative.
        height: Height of a window.
        width: Width of a window.
        stride: Stride between windows, in y and in x.

    Returns:
        int32 [distinct, height * width], and the number of each window: int32 [image, y, x].
    """
    if use_kernel(torch.device("cpu")):
        from lcrl_bench.networks.kernels.distinct import find_distinct

        return find_distinct(np.ascontiguousarray(images), height, width, stride)
    shape = (height, width)
    windows = np.lib.stride_tricks.sliding_window_view(images, shape, axis=(1, 2))
    windows = windows[:, ::stride, ::stride]
    flat = windows.reshape(-1, height * width)
    first, number = _first_appearances(flat)
    return flat[first], number.reshape(windows.shape[:3])


def _first_appearances(windows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where each distinct window first appears, and the number of each window.

    Columns are packed into one integer, which is renumbered whenever it would overflow: exact, and
    many times faster than comparing rows.

    Args:
        windows: int32 [window, column].

    Returns:
        int64 [distinct], ascending, and int32 [window].
    """
    radix = int(windows.max(initial=0)) + 1
    key, span = windows[:, 0].astype(np.int64), radix
    for column in windows.T[1:]:
        if span * radix >= _KEY_LIMIT:
            kept, key = np.unique(key, return_inverse=True)
            span = len(kept)
        key, span = key * radix + column, span * radix
    _, first, number = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return first[order], rank[number]
