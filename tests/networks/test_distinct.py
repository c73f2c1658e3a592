"""Distinct windows by a hash table and by numpy, against a dictionary."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.networks.distinct import distinct_windows

laws = settings(derandomize=True, deadline=None, max_examples=40)


def by_dictionary(images: np.ndarray, height: int, width: int, stride: int):
    seen: dict[tuple[int, ...], int] = {}
    _, tall, wide = images.shape
    number = [
        [
            [
                seen.setdefault(tuple(image[y : y + height, x : x + width].ravel()), len(seen))
                for x in range(0, wide - width + 1, stride)
            ]
            for y in range(0, tall - height + 1, stride)
        ]
        for image in images
    ]
    return np.array(list(seen)), np.array(number)


@pytest.mark.parametrize("kernel", ["numba", "torch"])
@laws
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 4),
    height=st.integers(1, 3),
    width=st.integers(1, 5),
    stride=st.integers(1, 2),
    largest=st.sampled_from([1, 3, 60, 2**31 - 1]),
)
def test_windows_are_numbered_as_they_first_appear(
    kernel, seed, count, height, width, stride, largest
):
    images = np.random.default_rng(seed).integers(
        0, largest, size=(count, height + 5, width + 6), dtype=np.int32
    )
    expected, expected_number = by_dictionary(images, height, width, stride)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LCRL_BENCH_KERNEL", kernel)
        windows, number = distinct_windows(images, height=height, width=width, stride=stride)
    assert np.array_equal(windows, expected)
    assert np.array_equal(number, expected_number)
    assert windows.dtype == number.dtype == np.int32


@pytest.mark.parametrize("kernel", ["numba", "torch"])
def test_more_windows_than_the_first_table_holds(kernel, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", kernel)
    images = np.random.default_rng(0).permutation(40_000).astype(np.int32).reshape(1, 200, 200)
    windows, number = distinct_windows(np.concatenate([images, images]), height=1, width=1)
    assert np.array_equal(windows.ravel(), images.ravel())
    assert np.array_equal(number[0], number[1])
    assert np.array_equal(number[0].ravel(), np.arange(40_000))
