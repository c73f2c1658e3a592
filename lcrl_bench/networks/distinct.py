"""Distinct windows of images of numbers, numbered in the order in which they first appear."""

from __future__ import annotations

import numpy as np
import torch

from lcrl_bench.mdp.kernels.dispatch import use_kernel

_KEY_LIMIT = 2**62


def distinct_windows(
    images: np.ndarray, *, height: int, width: int, stride: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Find the distinct windows of images, exactly.

    Args:
        images: int32 [image, y, x], none negative.
        height: Of a window.
        width: Of a window.
        stride: From one window to the next, both ways.

    Returns:
        int32 [distinct, height * width], and which one each is: int32 [image, window y, window x].
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
    """Where each distinct window stands first, and which one stands at each place.

    Columns are packed into one integer as long as it holds them, else numbered afresh: exact, and
    many times faster than comparing rows.

    Args:
        windows: int32 [place, column].

    Returns:
        int64 [distinct], ascending, and int32 [place].
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
