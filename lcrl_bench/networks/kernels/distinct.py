"""Distinct windows of images, compiled: what `networks.distinct` finds, by a hash table.

Every match is checked entry by entry, so the result is exact.

Imports numba: import this module only where numba is installed. The kernel is in one file, because
numba's cache does not notice an edit in another.
"""

# numba infers the types of what it compiles.
# ruff: noqa: ANN001, ANN201, ANN202

from __future__ import annotations

import numba
import numpy as np

from lcrl_bench.mdp.kernels.compilation import compiled

_FACTOR = np.uint64(0x9E3779B97F4A7C15)
_SHIFT = np.uint64(32)


_compiled = compiled()


@_compiled
def find_distinct(images, height, width, stride):
    """As `distinct_windows`; the table uses open addressing and is at most a quarter full.

    Views are flat areas for the most part, so a window is first compared with its neighbours to
    the left and above.
    """
    count, tall, wide = images.shape
    number = np.empty(
        (count, (tall - height) // stride + 1, (wide - width) // stride + 1), np.int32
    )
    size = height * width
    windows = np.empty((1024, size), np.int32)
    keys = np.empty(len(windows), np.uint64)
    slots = np.full(4 * len(windows), -1, np.int32)
    window = np.empty(size, np.int32)
    found = 0
    for image in range(count):
        for y in range(number.shape[1]):
            for x in range(number.shape[2]):
                top, left = y * stride, x * stride
                if x > 0 and _repeats(images, image, top, left, height, width, 0, stride):
                    number[image, y, x] = number[image, y, x - 1]
                    continue
                if y > 0 and _repeats(images, image, top, left, height, width, stride, 0):
                    number[image, y, x] = number[image, y - 1, x]
                    continue
                key = _read(images, image, top, left, height, width, window)
                slot = _slot(slots, keys, key, windows, window)
                if slots[slot] < 0:
                    if found == len(windows):
                        windows, keys = _doubled(windows), _doubled(keys)
                        slots = _filled(4 * len(windows), keys[:found])
                        slot = _slot(slots, keys, key, windows, window)
                    slots[slot], keys[found] = found, key
                    for entry in range(size):
                        windows[found, entry] = window[entry]
                    found += 1
                number[image, y, x] = slots[slot]
    return windows[:found].copy(), number


# Whole arrays and offsets, no slices: numba counts references to every slice.


@numba.njit
def _repeats(images, image, top, left, height, width, up, back):
    """Whether a window equals the one `up` lines above it and `back` columns to its left."""
    for row in range(top, top + height):
        for column in range(left, left + width):
            if images[image, row, column] != images[image, row - up, column - back]:
                return False
    return True


@numba.njit
def _read(images, image, top, left, height, width, window):
    """Copy a window out of an image, and hash it."""
    key = np.uint64(0)
    for row in range(height):
        for column in range(width):
            entry = images[image, top + row, left + column]
            window[row * width + column] = entry
            key = (key ^ np.uint64(entry)) * _FACTOR
            key ^= key >> _SHIFT
    return key


@numba.njit
def _slot(slots, keys, key, windows, window):
    """The slot that holds a window, or the free slot where it belongs."""
    mask = np.uint64(len(slots) - 1)
    slot = key & mask
    while slots[slot] >= 0:
        known = slots[slot]
        if keys[known] == key and _same(windows, known, window):
            break
        slot = (slot + np.uint64(1)) & mask
    return slot


@numba.njit
def _same(windows, known, window):
    """Whether two windows are equal, entry by entry: a hash alone would be a guess."""
    same = True
    for entry in range(len(window)):
        same &= windows[known, entry] == window[entry]
    return same


@numba.njit
def _doubled(table):
    """A table of twice the size that starts with the same entries."""
    larger = np.empty((2 * len(table), *table.shape[1:]), table.dtype)
    larger[: len(table)] = table
    return larger


@numba.njit
def _filled(size, keys):
    """A new table of `size` slots that holds the numbers of these keys."""
    slots = np.full(size, -1, np.int32)
    mask = np.uint64(size - 1)
    for known in range(len(keys)):
        slot = keys[known] & mask
        while slots[slot] >= 0:
            slot = (slot + np.uint64(1)) & mask
        slots[slot] = known
    return slots
