"""Chooses between compiled kernels and plain torch, and runs kernels in parallel.

`LCRL_BENCH_KERNEL` is `auto` (the default: kernels if numba is installed), `numba` (require
kernels) or `torch` (no kernels). Kernels are for CPUs; on any other device torch computes, whatever
the variable says. Both give the same results within rounding.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import torch

from lcrl_bench.errors import EnvironmentMissingError, UsageError

VARIABLE = "LCRL_BENCH_KERNEL"
"""Environment variable that chooses; read at every call."""

CHOICES = ("auto", "numba", "torch")


def use_kernel(device: torch.device) -> bool:
    """Whether to use compiled kernels for tensors on `device`.

    Raises:
        UsageError: If `LCRL_BENCH_KERNEL` is none of `CHOICES`.
        EnvironmentMissingError: If it is `numba`, and numba is not installed.
    """
    choice = os.environ.get(VARIABLE) or "auto"
    if choice not in CHOICES:
        raise UsageError(f"{VARIABLE}={choice!r} names no kernel. Valid: {', '.join(CHOICES)}.")
    if choice == "torch" or device.type != "cpu":
        return False
    installed = importlib.util.find_spec("numba") is not None
    if choice == "numba" and not installed:
        raise EnvironmentMissingError(
            f"{VARIABLE}=numba, but numba is not installed: pip install numba, "
            f"or leave {VARIABLE} unset to compute with torch."
        )
    return installed


def kernel_name(device: torch.device) -> str:
    """What computes on `device`, `numba` or `torch`; raises as `use_kernel` does."""
    return "numba" if use_kernel(device) else "torch"


def parallel_for(count: int, work: Callable[[int, int], None]) -> None:
    """Call `work(first, end)` on parts of `range(count)`, in as many threads as torch has.

    `work` must release the GIL. If what it writes for an index does not depend on the part that the
    index is in, results are the same to the bit on any number of threads.
    """
    threads = min(torch.get_num_threads(), count)
    if threads <= 1:
        work(0, count)
        return
    edges = [count * part // threads for part in range(threads + 1)]
    with ThreadPoolExecutor(threads - 1) as pool:
        others = [pool.submit(work, *part) for part in pairwise(edges[1:])]
        work(*edges[:2])
        for other in others:
            # Raises what `work` raised there.
            other.result()
