"""Times variants of one computation in turns and compares their results.

In turns (A B A B ...), so that whatever else the machine is doing affects all variants alike. The
first variant is the reference that the others are compared with.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Literal

import torch

from lcrl_bench.mdp.kernels.dispatch import VARIABLE

Kernel = Literal["auto", "torch", "numba"]
"""A value of `LCRL_BENCH_KERNEL`."""


@dataclass(frozen=True)
class Variant:
    """One way to compute a result."""

    name: str
    compute: Callable[[], Sequence[torch.Tensor]]
    """Does all the work once; returns what all variants must agree on."""
    kernel: Kernel = "torch"
    """`LCRL_BENCH_KERNEL` while it runs."""
    share: float = 1.0
    """Part of the work it does; its time is divided by it."""


@dataclass(frozen=True)
class Comparison:
    """Variants of one computation; the first is the reference."""

    name: str
    variants: tuple[Variant, ...]
    limit: float
    """Largest difference that counts as rounding: see `difference`."""
    clock: Callable[[], float] = time.perf_counter
    """Seconds: of the day, or of all cores (`time.process_time`)."""


@dataclass(frozen=True)
class Timing:
    """How long a variant took in one house, and how far off its result is."""

    seconds: tuple[float, ...]
    """One per repeat."""
    difference: float
    """Between its result and the reference's: see `difference`."""


def time_variants(
    comparison: Comparison, *, repeats: int, device: torch.device
) -> tuple[Timing, ...]:
    """Run every variant once to compare results, then time them in turns.

    The first run also compiles kernels and fills per-house caches; neither is timed.

    Args:
        comparison: The variants.
        repeats: How often each is timed, at least once.
        device: Where they compute; a GPU is synchronised before and after each run.

    Returns:
        One timing per variant.
    """
    clock = comparison.clock
    results = [_run(variant, device, clock)[1] for variant in comparison.variants]
    differences = [difference(result, results[0]) for result in results]
    del results
    rounds = [
        [_run(variant, device, clock)[0] / variant.share for variant in comparison.variants]
        for _ in range(repeats)
    ]
    return tuple(
        Timing(seconds, apart)
        for seconds, apart in zip(zip(*rounds, strict=True), differences, strict=True)
    )


def difference(found: Sequence[torch.Tensor], expected: Sequence[torch.Tensor]) -> float:
    """The largest relative error of a result: |found - expected| / |expected|, Euclidean norms.

    Taken per tensor, so that a small one can't hide behind a large one; infinite for a NaN.
    """
    worst = 0.0
    for part, reference in zip(found, expected, strict=True):
        apart = float(torch.linalg.vector_norm((part - reference).double()))
        size = float(torch.linalg.vector_norm(reference.double()))
        share = 0.0 if apart == 0 else apart / max(size, 1e-300)
        worst = max(worst, share if share == share else float("inf"))
    return worst


@contextmanager
def kernel_set_to(kernel: Kernel) -> Iterator[None]:
    """Set `LCRL_BENCH_KERNEL` to `kernel` inside the block."""
    kept = os.environ.get(VARIABLE)
    os.environ[VARIABLE] = kernel
    try:
        yield
    finally:
        if kept is None:
            del os.environ[VARIABLE]
        else:
            os.environ[VARIABLE] = kept


@contextmanager
def torch_threads(count: int) -> Iterator[None]:
    """Set the number of threads of torch, and of the kernels with it, inside the block."""
    kept = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(kept)


def _run(
    variant: Variant, device: torch.device, clock: Callable[[], float]
) -> tuple[float, Sequence[torch.Tensor]]:
    """Seconds, and the result."""
    with kernel_set_to(variant.kernel):
        _wait_for(device)
        began = clock()
        result = variant.compute()
        _wait_for(device)
        return clock() - began, result


def _wait_for(device: torch.device) -> None:
    if device.type == "cuda":
        torch.cuda.synchronize(device)
