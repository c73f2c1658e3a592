"""The task sets of a benchmark: all at once, or house by house on demand."""

from __future__ import annotations

import difflib
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.house_sets import HOUSES_KEPT, LATEST_KEPT, HouseSets
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.task import Task, Tasks
from lcrl_bench.benchmarks.task_set import TaskSet, by_kind, stack_tasks
from lcrl_bench.errors import UsageError
from lcrl_bench.streamed import Streamed

CPU = torch.device("cpu")


def load_task_sets(
    benchmark: Benchmark,
    *,
    device: torch.device = CPU,
    renderer: str = "auto",
    image_size: tuple[int, int] | None = None,
    houses_kept: int = HOUSES_KEPT,
    progress: Callable[[str], None] = lambda _: None,
) -> Sequence[TaskSet]:
    """The tasks of every house of a benchmark, rendering what is not in the cache.

    Args:
        benchmark: The benchmark.
        device: Device of views and tables.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.
        image_size: Width and height of the views in pixels; None means the benchmark's own.
        houses_kept: Most houses that are all kept in memory; if there are more, only the latest
            few are, and the others are memory-mapped.
        progress: Called with each finished house.

    Returns:
        Sorted by house id; NAV before PICK within a house.
    """
    names = sorted(benchmark.houses)
    whole = len(names) <= houses_kept
    houses = Streamed(
        len(names),
        lambda number: house_task_sets(
            benchmark, names[number], device=device, renderer=renderer, image_size=image_size
        ),
        kept=houses_kept if whole else min(houses_kept, LATEST_KEPT),
    )
    # All are made now, so that what can't be rendered is known before anything is trained.
    for name, _ in zip(names, houses, strict=True):
        progress(name)
    if whole:
        return tuple(tasks for house in houses for tasks in house)
    return HouseSets(houses, [by_kind(benchmark.select(house=name)) for name in names])


def house_task_sets(
    benchmark: Benchmark,
    house: str,
    tasks: Sequence[Task] | None = None,
    *,
    device: torch.device = CPU,
    renderer: str = "auto",
    image_size: tuple[int, int] | None = None,
) -> tuple[TaskSet, ...]:
    """The tasks of one house, one set per kind.

    Args:
        benchmark: The benchmark of the house.
        house: Its id.
        tasks: Which of its tasks; None means all. The views always cover all tasks, so that
            they are rendered only once.
        device: Device of views and tables.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for views that are not in the cache.
        image_size: Width and height of the views in pixels; None means the benchmark's own, which
            alone are frozen with it.

    Raises:
        UsageError: If views of that size are impossible.
    """
    every = benchmark.select(house=house)
    arrangements = arrangements_of(every)
    views = benchmark.scene(house, renderer=renderer, image_size=image_size).panoramas(arrangements)
    # Another scene: one that has rendered keeps its meshes, tens of megabytes.
    scene = benchmark.scene(house, renderer=renderer, image_size=image_size)
    sets = stack_tasks(scene, every if tasks is None else tasks, views, arrangements)
    there = views.to(device)
    return tuple(replace(each.to(device), views=there) for each in sets)


def load_benchmark(name: str | Path, *, renderer: str = "auto") -> Benchmark:
    """Load a frozen benchmark; its tasks know their houses.

    Args:
        name: A shipped benchmark (see `list_benchmarks`), or a folder of your own.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for
            views that are neither frozen nor cached.

    Raises:
        UnknownNameError: If there is none.
        InvalidFileError: If a file of it is missing or damaged.
        IntegrityError: If its content does not match its fingerprint.

    Example:
        >>> benchmark = lcrl_bench.load_benchmark("mini")
        >>> benchmark.tasks["test-house"][0].command
        'go to the candle'
    """
    benchmark = read_benchmark(benchmark_folder(str(name)))
    home = TaskSets(benchmark, renderer=renderer)
    tasks = Tasks(replace(task, home=home) for task in benchmark.tasks)
    # The very tasks that are handed out: what is stacked of them knows its home too.
    home.benchmark = replace(benchmark, tasks=tasks).known_as(benchmark.fingerprint)
    return home.benchmark


class TaskSets:
    """The task sets of a benchmark, stacked on first use; recently used houses are kept."""

    def __init__(
        self, benchmark: Benchmark, *, renderer: str = "auto", houses_kept: int = 128
    ) -> None:
        """Store the arguments; nothing is stacked yet.

        Args:
            benchmark: The benchmark.
            renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for views that are not in the cache.
            houses_kept: Houses kept in memory, about a megabyte each.
        """
        self.benchmark = benchmark
        self._renderer = renderer
        self._kept = houses_kept
        self._houses: OrderedDict[str, tuple[TaskSet, ...]] = OrderedDict()

    def of(self, task: Task) -> tuple[TaskSet, int]:
        """The set that contains a task, and its row."""
        for tasks in self.house(task.house):
            ids = [each.id for each in tasks.tasks]
            if task.id in ids:
                return tasks, ids.index(task.id)
        raise task_unknown(self.benchmark, task.id)

    def single(self, task: Task) -> TaskSet:
        """A task of the benchmark as a set of one."""
        tasks, row = self.of(task)
        return tasks.rows([row])

    def house(self, name: str) -> tuple[TaskSet, ...]:
        """The task sets of a house."""
        sets = self._houses.pop(name, None)
        if sets is None:
            sets = house_task_sets(self.benchmark, name, renderer=self._renderer)
        self._houses[name] = sets
        while len(self._houses) > self._kept:
            self._houses.popitem(last=False)
        return sets

    def clear(self) -> None:
        """Drop all houses."""
        self._houses.clear()

    def __len__(self) -> int:
        """Number of houses in memory."""
        return len(self._houses)


def task_named(benchmark: Benchmark, name: str) -> Task:
    """The task of a benchmark with an id.

    Raises:
        UsageError: If there is none; suggests the closest id.
    """
    found = next((task for task in benchmark.tasks if task.id == name), None)
    if found is None:
        raise task_unknown(benchmark, name)
    return found


def task_unknown(benchmark: Benchmark, name: str) -> UsageError:
    """The error for an unknown task; suggests the closest id."""
    near = difflib.get_close_matches(name, [task.id for task in benchmark.tasks], n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    # A benchmark has a thousand tasks: too many to list.
    return UsageError(f"{benchmark.name} has no task '{name}'.{hint} Its tasks.json lists all.")
