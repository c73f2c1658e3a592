"""The task sets of a benchmark: all of them, or house by house on demand."""

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
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.task import Task, Tasks
from lcrl_bench.benchmarks.task_set import TaskSet, stack_tasks
from lcrl_bench.errors import UsageError

CPU = torch.device("cpu")


def load_task_sets(
    benchmark: Benchmark,
    *,
    device: torch.device = CPU,
    renderer: str = "auto",
    image_size: tuple[int, int] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[TaskSet, ...]:
    """The tasks of every house of a benchmark, rendering what is not in the cache.

    Args:
        benchmark: The benchmark.
        device: Where views and tables are to live.
        renderer: `"auto"`, `"gl"` or `"rays"`.
        image_size: Width and height of the views in pixels; None means the benchmark's own.
        progress: Told each house as it is done.

    Returns:
        In order of house ids; of each house NAV, then PICK.
    """
    sets: list[TaskSet] = []
    for name in sorted(benchmark.houses):
        sets += house_task_sets(
            benchmark, name, device=device, renderer=renderer, image_size=image_size
        )
        progress(name)
    return tuple(sets)


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
        benchmark: Where the house and its grid are.
        house: Its id.
        tasks: Which of its tasks; None means all. The views always cover all, so that they are
            rendered once whatever is asked for.
        device: Where views and tables are to live.
        renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.
        image_size: Width and height of the views in pixels; None means the benchmark's own, which
            alone are frozen with it.

    Raises:
        UsageError: If there can be no views of that size.
    """
    scene = benchmark.scene(house, renderer=renderer, image_size=image_size)
    every = benchmark.select(house=house)
    arrangements = arrangements_of(every)
    views = scene.panoramas(arrangements)
    sets = stack_tasks(scene, every if tasks is None else tasks, views, arrangements)
    there = views.to(device)
    return tuple(replace(each.to(device), views=there) for each in sets)


def load_benchmark(name: str | Path, *, renderer: str = "auto") -> Benchmark:
    """A frozen benchmark, whose tasks know their houses.

    Args:
        name: A shipped benchmark (see `list_benchmarks`), or the folder of one of your own.
        renderer: `"auto"`, `"gl"` or `"rays"`, for views that are neither frozen nor cached.

    Raises:
        UnknownNameError: If there is none.
        InvalidFileError: If a file of it is missing or damaged.
        IntegrityError: If its content is not what its fingerprint says.

    Example:
        >>> benchmark = lcrl_bench.load_benchmark("mini")
        >>> benchmark.tasks["test-house"][0].command
        'go to the candle'
    """
    benchmark = read_benchmark(benchmark_folder(str(name)))
    home = TaskSets(benchmark, renderer=renderer)
    tasks = Tasks(replace(task, home=home) for task in benchmark.tasks)
    # The very tasks that are handed out: what is stacked of them knows its home too.
    home.benchmark = replace(benchmark, tasks=tasks)
    return home.benchmark


class TaskSets:
    """The task sets of a benchmark, stacked when first asked for; the houses used last are kept."""

    def __init__(
        self, benchmark: Benchmark, *, renderer: str = "auto", houses_kept: int = 128
    ) -> None:
        """Stack nothing yet.

        Args:
            benchmark: The benchmark.
            renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.
            houses_kept: How many houses stay in memory; one takes about a megabyte.
        """
        self.benchmark = benchmark
        self._renderer = renderer
        self._kept = houses_kept
        self._houses: OrderedDict[str, tuple[TaskSet, ...]] = OrderedDict()

    def of(self, task: Task) -> tuple[TaskSet, int]:
        """The set that holds a task of the benchmark, and its row there."""
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
        """Let go of all houses."""
        self._houses.clear()

    def __len__(self) -> int:
        """How many houses are in memory."""
        return len(self._houses)


def task_named(benchmark: Benchmark, name: str) -> Task:
    """The task of a benchmark with an id.

    Raises:
        UsageError: If there is none; suggests the nearest.
    """
    found = next((task for task in benchmark.tasks if task.id == name), None)
    if found is None:
        raise task_unknown(benchmark, name)
    return found


def task_unknown(benchmark: Benchmark, name: str) -> UsageError:
    """The error for a task that a benchmark does not have; suggests the nearest."""
    near = difflib.get_close_matches(name, [task.id for task in benchmark.tasks], n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    # A benchmark has a thousand tasks: too many to list.
    return UsageError(f"{benchmark.name} has no task '{name}'.{hint} Its tasks.json lists all.")
