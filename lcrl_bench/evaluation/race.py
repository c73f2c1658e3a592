"""Several ways to one result, timed in turns, and how far apart their results are.

In turns (A B A B ...), so that whatever else the machine does meets all of them; the first way is
the reference that the others are compared with.
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


@dataclass(frozen=True)
class Way:
    """One way to a result."""

    name: str
    compute: Callable[[], Sequence[torch.Tensor]]
    """Does all the work once, and returns what all ways must agree about."""
    kernel: Kernel = "torch"
    """What `LCRL_BENCH_KERNEL` says meanwhile."""


@dataclass(frozen=True)
class Contest:
    """The ways to one result; the first is the reference."""

    name: str
    ways: tuple[Way, ...]
    limit: float
    """Largest difference that is still the same result: see `difference`."""


@dataclass(frozen=True)
class Lap:
    """What a way took in one house."""

    seconds: tuple[float, ...]
    """One a repeat."""
    difference: float
    """Of its result from the reference's."""


def race(contest: Contest, *, repeats: int, device: torch.device) -> tuple[Lap, ...]:
    """Run every way once to compare the results, then in turns against the clock.

    The first run also compiles what is compiled and arranges what is arranged once a house: neither
    is timed.

    Args:
        contest: The ways.
        repeats: How often each is timed, at least once.
        device: Where they compute; a GPU is waited for.

    Returns:
        One lap a way.
    """
    results = [_run(way, device)[1] for way in contest.ways]
    differences = [difference(result, results[0]) for result in results]
    del results
    rounds = [[_run(way, device)[0] for way in contest.ways] for _ in range(repeats)]
    return tuple(
        Lap(seconds, apart)
        for seconds, apart in zip(zip(*rounds, strict=True), differences, strict=True)
    )


def difference(found: Sequence[torch.Tensor], expected: Sequence[torch.Tensor]) -> float:
    """The largest difference between two results: |found - expected| / |expected|, Euclidean norms.

    Tensor by tensor, so that a small one can't hide behind a large one; infinite for a NaN.
    """
    worst = 0.0
    for part, reference in zip(found, expected, strict=True):
        apart = float(torch.linalg.vector_norm((part - reference).double()))
        size = float(torch.linalg.vector_norm(reference.double()))
        share = 0.0 if apart == 0 else apart / max(size, 1e-300)
        worst = max(worst, share if share == share else float("inf"))
    return worst


@contextmanager
def computing_by(kernel: Kernel) -> Iterator[None]:
    """Have `LCRL_BENCH_KERNEL` say `kernel` inside the block."""
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
    """Have torch, and the kernels with it, compute on so many threads inside the block."""
    kept = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(kept)


def _run(way: Way, device: torch.device) -> tuple[float, Sequence[torch.Tensor]]:
    """Seconds, and the result."""
    with computing_by(way.kernel):
        _wait_for(device)
        began = time.perf_counter()
        result = way.compute()
        _wait_for(device)
        return time.perf_counter() - began, result


def _wait_for(device: torch.device) -> None:
    if device.type == "cuda":
        torch.cuda.synchronize(device)
