"""The suite's speed: what it computes by its own ways, as ratios to plainer ways beside them.

All ways are given the same work in one process, in turns, and their results are compared: seconds
say more of a machine than of a program, and a fast way to something else is no way at all.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import fmean, median

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.contests import contests
from lcrl_bench.evaluation.race import Contest, Lap, computing_by, race, torch_threads
from lcrl_bench.evaluation.repetition import Repetition, repetitions
from lcrl_bench.evaluation.workload import workloads
from lcrl_bench.mdp.kernels.dispatch import use_kernel


@dataclass(frozen=True)
class Figure:
    """How long one way to a result takes."""

    what: str
    way: str
    threads: int
    """Of torch, on a CPU."""
    ms: float
    """Milliseconds a house: the least of all repeats, averaged over houses."""
    times: float
    """How many times as fast as the reference on as many threads; 1 for the reference."""
    ms_median: float
    """As `ms`, by the median of all repeats."""
    times_median: float
    """As `times`, by the medians."""
    difference: float
    """The largest of its result from the reference's in any house, a share."""
    equal: bool
    """Whether that is rounding."""


@dataclass(frozen=True)
class Speed:
    """What was measured."""

    figures: tuple[Figure, ...]
    repetitions: tuple[Repetition, ...]
    skipped: tuple[str, ...]
    """What was not measured, and why."""

    @property
    def equal(self) -> bool:
        """Whether all ways gave the same results."""
        return all(figure.equal for figure in self.figures)


def measure_speed(
    benchmark: Benchmark,
    houses: Sequence[str],
    *,
    threads: Sequence[int],
    repeats: int,
    device: torch.device,
    renderer: str = "auto",
    progress: Callable[[str], None] = lambda _: None,
) -> Speed:
    """Measure everything in some houses.

    Args:
        benchmark: Where the houses are.
        houses: Ids of training houses.
        threads: Numbers of threads; those beyond the cores of this machine are skipped, and on a
            GPU all but the first.
        repeats: How often each way is timed in each house.
        device: Where to compute.
        renderer: For views that are not in the cache.
        progress: Told each house as it is done.

    Raises:
        UsageError: If nothing would be left to measure.
    """
    if repeats < 1:
        raise UsageError(f"--repeats {repeats}: time each way once or more.")
    counts, skipped = _usable(threads, device)
    with computing_by("auto"):
        kernels = use_kernel(device)
    if not kernels:
        absent = "numba is not installed (pip install numba)"
        reason = absent if device.type == "cpu" else "for a CPU only"
        skipped.append(f"compiled, and greedy evaluation, which has no other way: {reason}")
    laps: dict[str, dict[int, list[tuple[Contest, tuple[Lap, ...]]]]] = {}
    repeated = []
    for load in workloads(benchmark, houses, device=device, renderer=renderer):
        for count in counts:
            # Made afresh: the networks of all ways start to train from the same weights.
            for contest in contests(load, kernels=kernels):
                with torch_threads(count):
                    found = race(contest, repeats=repeats, device=device)
                laps.setdefault(contest.name, {}).setdefault(count, []).append((contest, found))
        repeated.append((load.house, load.index))
        progress(load.problem.views.house)
    figures = [
        figure
        for by_threads in laps.values()
        for count, rows in by_threads.items()
        for figure in _figures(rows, count)
    ]
    return Speed(tuple(figures), repetitions(repeated), tuple(skipped))


def _usable(threads: Sequence[int], device: torch.device) -> tuple[list[int], list[str]]:
    """The numbers of threads to measure, and what is said of the others."""
    wanted, cores = sorted(set(threads)), len(os.sched_getaffinity(0))
    if not wanted or wanted[0] < 1:
        raise UsageError("--threads takes numbers from 1 on. Example: --threads 1 2")
    if device.type != "cpu":
        return wanted[:1], [f"{count} threads: for a CPU only" for count in wanted[1:]]
    counts = [count for count in wanted if count <= cores]
    if not counts:
        raise UsageError(f"--threads {wanted[0]}: this process has {cores} cores. Try --threads 1.")
    return counts, [f"{n} threads: this process has {cores} cores" for n in wanted if n > cores]


def _figures(rows: Sequence[tuple[Contest, tuple[Lap, ...]]], threads: int) -> list[Figure]:
    """One figure a way, from its laps in all houses.

    Args:
        rows: The contest in each house, and its laps.
        threads: How many they took.
    """
    contest = rows[0][0]
    ways = list(zip(*(laps for _, laps in rows), strict=True))
    least = [1e3 * fmean(min(lap.seconds) for lap in laps) for laps in ways]
    middle = [1e3 * fmean(median(lap.seconds) for lap in laps) for laps in ways]
    apart = [max(lap.difference for lap in laps) for laps in ways]
    return [
        Figure(
            what=contest.name,
            way=way.name,
            threads=threads,
            ms=least[k],
            times=least[0] / least[k],
            ms_median=middle[k],
            times_median=middle[0] / middle[k],
            difference=apart[k],
            equal=apart[k] <= contest.limit,
        )
        for k, way in enumerate(contest.ways)
    ]
