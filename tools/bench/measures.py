"""Every figure of `bench`, by name, and what it is measured in."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import Final

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.cli.bench import Figure, Skipped
from lcrl_bench.errors import EnvironmentMissingError, UnknownNameError
from tools.bench.benchmarks import measure_building, measure_opening
from tools.bench.planning import measure_planning
from tools.bench.training import measure_pass
from tools.speed.workload import Workload, spread_houses, workloads


class Setting:
    """What figures are measured in: some houses of a benchmark, loaded on first use."""

    def __init__(self, benchmark: str, houses: int) -> None:
        """Store the arguments.

        Args:
            benchmark: A shipped benchmark, or a folder.
            houses: How many of its training houses, spread from the smallest to the largest.
        """
        self.name = benchmark
        self._count = houses

    @cached_property
    def benchmark(self) -> Benchmark:
        """The benchmark."""
        return read_benchmark(benchmark_folder(self.name))

    @cached_property
    def houses(self) -> tuple[str, ...]:
        """The houses to measure in."""
        return spread_houses(self.benchmark, self._count)

    @cached_property
    def sets(self) -> tuple[TaskSet, ...]:
        """Their tasks."""
        alone = replace(
            self.benchmark,
            houses={name: self.benchmark.houses[name] for name in self.houses},
        )
        return load_task_sets(alone)

    @cached_property
    def loads(self) -> tuple[Workload, ...]:
        """Their training tasks, prepared for LC-RL."""
        return tuple(workloads(self.benchmark, self.houses, device=torch.device("cpu")))


Measure = Callable[[Setting], Figure]

MEASURES: Final[Mapping[str, Measure]] = MappingProxyType(
    {
        "planning": lambda setting: measure_planning(setting.sets),
        "training": lambda setting: measure_pass(setting.loads),
        "building": lambda _: measure_building(3),
        "opening": lambda setting: measure_opening(setting.name),
    }
)
"""Every figure, in the order of the table."""

USUAL: Final = ("planning", "training", "building", "opening")
"""Those that are measured if none is named: seconds each."""


def measure(
    names: Sequence[str],
    setting: Setting,
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[tuple[Figure, ...], tuple[Skipped, ...]]:
    """Measure figures one after the other.

    Args:
        names: Which; empty for `USUAL`.
        setting: What they are measured in.
        progress: Called with each name when it is done.

    Returns:
        The figures, and those that can't be measured here.

    Raises:
        UnknownNameError: If there is no such figure.
    """
    for name in names:
        if name not in MEASURES:
            raise UnknownNameError("figure", name, MEASURES)
    figures: list[Figure] = []
    skipped: list[Skipped] = []
    for name in names or USUAL:
        try:
            figures.append(MEASURES[name](setting))
        except EnvironmentMissingError as error:
            skipped.append(Skipped(name, str(error)))
        progress(name)
    return tuple(figures), tuple(skipped)
