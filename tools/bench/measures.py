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
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.cli.bench import Figure, Skipped
from lcrl_bench.errors import EnvironmentMissingError, UnknownNameError
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.scene import Scene
from tools.bench.benchmarks import measure_building, measure_opening
from tools.bench.memory import measure_memory
from tools.bench.planning import measure_planning
from tools.bench.rendering import measure_rendering
from tools.bench.stepping import measure_stepping
from tools.bench.training import measure_training
from tools.bench.whole_runs import measure_running, measure_table
from tools.speed.peers import IMITATION, MINIGRID
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
        return tuple(load_task_sets(alone))

    @cached_property
    def scenes(self) -> tuple[tuple[Scene, tuple[Arrangement, ...]], ...]:
        """The houses in MuJoCo, and the arrangements that their tasks make."""
        return tuple(
            (
                self.benchmark.scene(name),
                arrangements_of(self.benchmark.select(house=name)),
            )
            for name in self.houses
        )

    @property
    def training_houses(self) -> int:
        """Number of training houses of the whole benchmark."""
        return len(self.benchmark.houses_of(Split.TRAIN))

    @cached_property
    def loads(self) -> tuple[Workload, ...]:
        """Their training tasks, prepared for LC-RL."""
        return tuple(workloads(self.benchmark, self.houses, device=torch.device("cpu")))


SMALL: Final = "mini"
"""What memory is measured with, as it takes seconds; growth is `python -m tools.speed --growth`."""

Measure = Callable[[Setting], tuple[Figure, ...]]

MEASURES: Final[Mapping[str, Measure]] = MappingProxyType(
    {
        "rendering": lambda setting: measure_rendering(setting.scenes),
        "planning": lambda setting: (measure_planning(setting.sets),),
        "training": lambda setting: measure_training(setting.loads, setting.training_houses),
        "environments": lambda setting: measure_stepping(setting.name),
        "building": lambda _: (measure_building(3),),
        "opening": lambda setting: (measure_opening(setting.name),),
        "memory": lambda _: (measure_memory(SMALL),),
    }
)
"""What is measured, in the order of the table."""
LONG: Final[Mapping[str, Measure]] = MappingProxyType(
    {
        "running": lambda setting: (measure_running(setting.name),),
        "table-1": lambda setting: (measure_table(setting.benchmark),),
    }
)
"""What takes minutes, and so is measured only if it is named."""


def make_peers() -> None:
    """Install what the suite is measured beside, each into an environment of its own.

    Raises:
        EnvironmentMissingError: If one can't be installed.
    """
    for peer in (IMITATION, MINIGRID):
        peer.make()


def measure(
    names: Sequence[str],
    setting: Setting,
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[tuple[Figure, ...], tuple[Skipped, ...]]:
    """Measure figures one after the other.

    Args:
        names: Which; empty for all but the `LONG` ones.
        setting: What they are measured in.
        progress: Called with each name when it is done.

    Returns:
        The figures, and those that can't be measured here.

    Raises:
        UnknownNameError: If there is no such figure.
    """
    known = {**MEASURES, **LONG}
    for name in names:
        if name not in known:
            raise UnknownNameError("figure", name, known)
    figures: list[Figure] = []
    skipped: list[Skipped] = []
    for name in names or MEASURES:
        try:
            figures += known[name](setting)
        except EnvironmentMissingError as error:
            skipped.append(Skipped(name, str(error)))
        progress(name)
    if not names:
        skipped += [Skipped(name, f"it takes minutes: --only {name}") for name in LONG]
    return tuple(figures), tuple(skipped)
