"""`compiled`: numba's decorator as all kernels use it.

Imports numba: only kernels may import this module.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:  # noqa: ANN401
    """Make a decorator that compiles a function at its first call, for the types it is called with.

    The compiled code releases the GIL, so `parallel_for` can run it in threads. numba caches it on
    disk; where no cache folder can be written, every process compiles anew.

    Args:
        options: Further options of `numba.njit`.
    """

    def decorate(function: Callable[..., Any]) -> Any:  # noqa: ANN401
        try:
            return numba.njit(nogil=True, cache=True, **options)(function)
        except RuntimeError:  # numba found no folder for its cache.
            return numba.njit(nogil=True, **options)(function)

    return decorate
