"""Memory: the peak of a process that trains over a benchmark's houses once, and evaluates."""

from __future__ import annotations

from typing import Final

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.cli.bench import Figure
from tools.speed.growth import MEMORY_GOAL_MB, run_stage

KEPT: Final = 4
"""Houses in memory, so that others leave it and come back, as in a large benchmark."""


def measure_memory(benchmark: str) -> Figure:
    """Train LC-RL for one pass and evaluate it, in a process of its own.

    Args:
        benchmark: A small one: a name, or a folder.

    Raises:
        LcrlError: If the process fails.
    """
    found = run_stage("pass", benchmark_folder(benchmark).resolve(), KEPT)
    work = f"peak memory of training and evaluation on {benchmark}"
    return Figure(
        "memory",
        work,
        "",
        found["peak_mb"],
        "MB",
        MEMORY_GOAL_MB,
        at_least=False,
        detail={"cpu_s": found["cpu_s"], "houses_kept": KEPT},
    )
