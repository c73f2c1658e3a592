"""The suite's speed, as ratios to simpler implementations measured beside it.

All variants do the same work in one process, in turns, and their results are compared: seconds say
more about the machine than about the program, and a fast variant with a wrong result is worthless.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import fmean, median

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.kernels.dispatch import use_kernel
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.scene import Scene
from tools.speed.comparisons import comparisons
from tools.speed.rendering import cannot_render, panorama_comparison
from tools.speed.repetition import Repetition, repetitions
from tools.speed.timing import Comparison, Timing, kernel_set_to, time_variants, torch_threads
from tools.speed.workload import Workload, workloads

_Timed = tuple[Comparison, tuple[Timing, ...]]
"""A comparison in one house, and one timing per variant."""


@dataclass(frozen=True)
class Figure:
    """How long one variant takes."""

    comparison: str
    variant: str
    threads: int
    """Torch threads, on a CPU."""
    ms: float
    """Milliseconds per house: the fastest repeat, averaged over houses."""
    times: float
    """Speedup over the reference on the same number of threads; 1 for the reference."""
    ms_median: float
    """Like `ms`, with the median repeat."""
    times_median: float
    """Like `times`, with the median repeats."""
    difference: float
    """Largest relative error of its result in any house."""
    equal: bool
    """Whether that error is rounding."""


@dataclass(frozen=True)
class Speed:
    """Everything that was measured."""

    figures: tuple[Figure, ...]
    repetitions: tuple[Repetition, ...]
    skipped: tuple[str, ...]
    """What was left out, and why."""

    @property
    def equal(self) -> bool:
        """Whether all variants gave the same results."""
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
    """Measure all comparisons in some houses.

    Args:
        benchmark: The benchmark the houses belong to.
        houses: Ids of training houses.
        threads: Thread counts; those above this machine's cores are skipped, and on a GPU all but
            the first.
        repeats: How often each variant is timed in each house.
        device: Where to compute.
        renderer: Draws views that are not in the cache.
        progress: Called with each house when it is done.

    Raises:
        UsageError: If nothing is left to measure.
    """
    if repeats < 1:
        raise UsageError(f"--repeats {repeats}: time each variant once or more.")
    counts, skipped = _usable(threads, device)
    with kernel_set_to("auto"):
        kernels = use_kernel(device)
    if not kernels:
        absent = "numba is not installed (pip install numba)"
        reason = absent if device.type == "cpu" else "for a CPU only"
        skipped.append(f"compiled, and greedy evaluation, which has no other variant: {reason}")
    if unseen := cannot_render():
        skipped.append(unseen)
    timings: dict[str, dict[int, list[_Timed]]] = {}
    repeated = []
    for load in workloads(benchmark, houses, device=device, renderer=renderer):
        for count in counts:
            # Made afresh: the networks of all variants start training from the same weights.
            for comparison in comparisons(load, kernels=kernels):
                with torch_threads(count):
                    found = time_variants(comparison, repeats=repeats, device=device)
                by_threads = timings.setdefault(comparison.name, {})
                by_threads.setdefault(count, []).append((comparison, found))
        if not unseen:
            with panorama_comparison(*_scene_of(load)) as comparison:
                found = time_variants(comparison, repeats=repeats, device=torch.device("cpu"))
            by_threads = timings.setdefault(comparison.name, {})
            # No torch in it: the number of its threads does not matter.
            by_threads.setdefault(counts[0], []).append((comparison, found))
        repeated.append((load.house, load.index))
        progress(load.tasks[0].views.house)
    figures = [
        figure
        for by_threads in timings.values()
        for count, rows in by_threads.items()
        for figure in _figures(rows, count)
    ]
    return Speed(tuple(figures), repetitions(repeated), tuple(skipped))


def _scene_of(load: Workload) -> tuple[Scene, tuple[Arrangement, ...]]:
    """The house, and the arrangements that its tasks lead to."""
    tasks = [task for part in load.tasks for task in part.tasks]
    return load.tasks[0].scene, arrangements_of(tasks)


def _usable(threads: Sequence[int], device: torch.device) -> tuple[list[int], list[str]]:
    """The thread counts to measure, and the reasons for skipping the others."""
    wanted, cores = sorted(set(threads)), len(os.sched_getaffinity(0))
    if not wanted or wanted[0] < 1:
        raise UsageError("--threads takes numbers from 1 on. Example: --threads 1 2")
    if device.type != "cpu":
        return wanted[:1], [f"{count} threads: for a CPU only" for count in wanted[1:]]
    counts = [count for count in wanted if count <= cores]
    if not counts:
        raise UsageError(f"--threads {wanted[0]}: this process has {cores} cores. Try --threads 1.")
    return counts, [f"{n} threads: this process has {cores} cores" for n in wanted if n > cores]


def _figures(rows: Sequence[_Timed], threads: int) -> list[Figure]:
    """One figure per variant, from its timings in all houses.

    Args:
        rows: The comparison and its timings, per house.
        threads: The number of threads.
    """
    comparison = rows[0][0]
    by_variant = list(zip(*(timings for _, timings in rows), strict=True))
    least = [1e3 * fmean(min(t.seconds) for t in timings) for timings in by_variant]
    middle = [1e3 * fmean(median(t.seconds) for t in timings) for timings in by_variant]
    apart = [max(t.difference for t in timings) for timings in by_variant]
    return [
        Figure(
            comparison=comparison.name,
            variant=variant.name,
            threads=threads,
            ms=least[k],
            times=least[0] / least[k],
            ms_median=middle[k],
            times_median=middle[0] / middle[k],
            difference=apart[k],
            equal=apart[k] <= comparison.limit,
        )
        for k, variant in enumerate(comparison.variants)
    ]
