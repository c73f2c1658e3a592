"""Which of two equal computations runs: compiled kernels for a CPU, or plain torch.

`LCRL_BENCH_KERNEL` chooses: `auto` (the default) takes the kernels where numba is installed,
`numba` insists on them, `torch` does without. Kernels run on a CPU alone; on any other device
torch computes, whatever the variable says. Both give the same figures within rounding.
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
"""Environment variable that chooses, read at every call."""

CHOICES = ("auto", "numba", "torch")


def use_kernel(device: torch.device) -> bool:
    """Whether compiled kernels compute what lives on `device`.

    Raises:
        UsageError: If `LCRL_BENCH_KERNEL` names none of the choices.
        EnvironmentMissingError: If it insists on numba, which is not installed.
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
    """What computes on `device`: `numba` or `torch`; errors as `use_kernel`."""
    return "numba" if use_kernel(device) else "torch"


def parallel_for(count: int, work: Callable[[int, int], None]) -> None:
    """Call `work(first, end)` on parts of `range(count)`, one for each of torch's threads.

    `work` must release the interpreter's lock, and what it writes for an index must not depend on
    the part the index is in; then the number of threads changes no bit.
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
            # Raises what the part raised.
            other.result()
