"""Benchmarks: opening one, and building one house of a new one."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from lcrl_bench.benchmarks.build import BuildConfig, build_benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark, write_benchmark
from lcrl_bench.cli.bench import Figure
from lcrl_bench.houses.procedural import generate_house
from tools.speed.timing import torch_threads

OPENING_GOAL: Final = 0.1
"""CPU seconds."""
BUILDING_GOAL: Final = 1.5
"""CPU seconds per house."""

_HOME: Final = "LCRL_BENCH_HOME"
_REPEATS: Final = 5


def measure_opening(name: str) -> Figure:
    """Open a benchmark, as every command does; modules are imported before."""
    folder = benchmark_folder(name)
    seconds = [_cpu_seconds_of_opening(folder) for _ in range(_REPEATS + 1)][1:]
    return Figure("opening", f"opening {name}", "", min(seconds), "s", OPENING_GOAL, at_least=False)


def measure_building(houses: int) -> Figure:
    """Draw, prove, render and freeze houses, with nothing in the cache.

    Args:
        houses: How many procedural houses.
    """
    # As a job builds it; a second thread would spin while it waits.
    with (
        torch_threads(1),
        tempfile.TemporaryDirectory() as folder,
        _cache_in(Path(folder) / "cache"),
    ):
        made = [generate_house(seed) for seed in range(10_000, 10_000 + houses)]
        # The first house compiles kernels and loads libraries.
        build_benchmark(made[:1], BuildConfig("first"), renderer="rays")
        began = time.process_time()
        benchmark = build_benchmark(made[1:], BuildConfig("measured"), renderer="rays")
        write_benchmark(Path(folder) / "measured", benchmark)
        seconds = (time.process_time() - began) / (houses - 1)
    work = "building a benchmark, per house"
    return Figure("building", work, "", seconds, "s", BUILDING_GOAL, at_least=False)


def _cpu_seconds_of_opening(folder: Path) -> float:
    began = time.process_time()
    read_benchmark(folder)
    return time.process_time() - began


@contextmanager
def _cache_in(folder: Path) -> Iterator[None]:
    kept = os.environ.get(_HOME)
    os.environ[_HOME] = str(folder)
    try:
        yield
    finally:
        os.environ.pop(_HOME)
        if kept is not None:
            os.environ[_HOME] = kept
