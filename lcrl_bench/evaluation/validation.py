"""Validation houses, carved from the training houses: where settings are chosen.

No test task is looked at: the carved benchmark has training tasks only, some of them called tests.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Split, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import UsageError
from lcrl_bench.methods.train_set import select_split

VALIDATION_TASKS = 0.15
"""Share of the tasks of a house kept for training that become its test-task split."""


def carve_validation(benchmark: Benchmark, *, houses: int, seed: int = 0) -> Benchmark:
    """A benchmark made of the training tasks of another.

    Args:
        benchmark: The one that settings are to be chosen for.
        houses: How many training houses become test houses.
        seed: Which.

    Returns:
        A benchmark named `<name>-validation`, with the three splits of any other.

    Raises:
        UsageError: If there are not more training houses than that.
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


def carve_task_sets(benchmark: Benchmark, sets: Sequence[TaskSet]) -> tuple[TaskSet, ...]:
    """The task sets of a carved benchmark, from those of the one it was carved from.

    Stacking those of the carved benchmark afresh would give the same, but for frozen views: they
    show every arrangement that some task of the house asks for.
    """
    splits = {task.id: task for task in benchmark.tasks}
    kept = [select_split(tasks, Split.TRAIN) for tasks in sets]
    return tuple(
        replace(tasks, tasks=tuple(splits[task.id] for task in tasks.tasks))
        for tasks in kept
        if tasks is not None
    )


def _resplit(task: Task, held_out: set[str], rng: random.Random) -> Task:
    if task.house in held_out:
        return replace(task, split=Split.TEST_HOUSE)
    chosen = rng.random() < VALIDATION_TASKS
    return replace(task, split=Split.TEST_TASK) if chosen else task
