"""numba's decorator as kernels use it."""

from __future__ import annotations

import pytest

compilation = pytest.importorskip("lcrl_bench.mdp.kernels.compilation")


def test_a_kernel_compiles_where_no_cache_can_be_written(monkeypatch):
    refusals = []

    def njit(*function: object, cache: bool = False, **options: object):
        if cache:
            refusals.append(options)
            raise RuntimeError("cannot cache function: no locator available")
        return numba_njit(*function, **options)

    numba_njit = compilation.numba.njit
    monkeypatch.setattr(compilation.numba, "njit", njit)
    inverse = compilation.compiled(error_model="numpy")(lambda number: 1.0 / number)
    assert refusals == [{"nogil": True, "error_model": "numpy"}]
    # Its own options are kept: by numba's default a division by zero would raise.
    assert inverse(0.0) == float("inf")
