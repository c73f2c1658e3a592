"""Validation houses for choosing settings, carved from the training houses.

No test task is used: the carved benchmark has only training tasks, some relabelled as test tasks.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.house_sets import House, change_houses
from lcrl_bench.benchmarks.task import Split, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import UsageError
from lcrl_bench.methods.train_set import select_split

VALIDATION_TASKS = 0.15
"""Share of a training house's tasks that becomes its test-task split."""


def carve_validation(benchmark: Benchmark, *, houses: int, seed: int = 0) -> Benchmark:
    """A benchmark made from the training tasks of another.

    Args:
        benchmark: The benchmark to choose settings for.
        houses: Number of training houses that become test houses.
        seed: Seed of the selection.

    Returns:
        A benchmark named `<name>-validation`, with the usual three splits.

    Raises:
        UsageError: If there are not enough training houses.
    """
    names = list(benchmark.houses_of(Split.TRAIN))
    if not 0 < houses < len(names):
        raise UsageError(
            f"--houses {houses}: '{benchmark.name}' has {len(names)} training houses; hold out at "
            f"least 1 and at most {len(names) - 1}."
        )
    rng = random.Random(seed)
    held_out = set(rng.sample(names, houses))
    tasks = tuple(
        _resplit(task, held_out, rng) for task in benchmark.tasks if task.split == Split.TRAIN
    )
    return replace(
        benchmark,
        name=f"{benchmark.name}-validation",
        houses={name: benchmark.houses[name] for name in names},
        grids={name: benchmark.grids[name] for name in names},
        views={name: path for name, path in benchmark.views.items() if name in names},
        tasks=tasks,
    )


def carve_task_sets(benchmark: Benchmark, sets: Sequence[TaskSet]) -> Sequence[TaskSet]:
    """The task sets of a carved benchmark, from those of the original one.

    Building them from the carved benchmark would give the same, except for frozen views, which
    cover the arrangements of all tasks of a house.
    """
    splits = {task.id: task for task in benchmark.tasks}

    def carved(house: House) -> House:
        kept = [select_split(tasks, Split.TRAIN) for tasks in house]
        return tuple(
            replace(tasks, tasks=tuple(splits[task.id] for task in tasks.tasks))
            for tasks in kept
            if tasks is not None
        )

    return change_houses(
        sets,
        carved,
        keep=lambda task: task.split == Split.TRAIN,
        name=lambda task: splits[task.id],
    )


def _resplit(task: Task, held_out: set[str], rng: random.Random) -> Task:
    if task.house in held_out:
        return replace(task, split=Split.TEST_HOUSE)
    chosen = rng.random() < VALIDATION_TASKS
    return replace(task, split=Split.TEST_TASK) if chosen else task
