"""A benchmark as a method meets it: compiled houses, and the `TrainSet` made from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.compiled import CompiledHouse, CompiledTasks, compile_house
from lcrl_bench.benchmarks.demonstrations import demonstrate
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.methods.contract import HouseViews, TaskSet, TrainHouse, TrainSet


@dataclass(frozen=True, eq=False)
class Problem:
    """A compiled house, and what can be seen in it on the device of the run."""

    compiled: CompiledHouse
    views: HouseViews


def compile_problems(
    benchmark: Benchmark,
    *,
    device: torch.device,
    renderer: str = "auto",
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[Problem, ...]:
    """Compile every house of a benchmark, rendering what is not in the cache.

    Args:
        benchmark: The benchmark.
        device: Where views and tables are to live.
        renderer: `"auto"`, `"gl"` or `"rays"`.
        progress: Told each house as it is done.
    """
    problems = []
    for name in sorted(benchmark.houses):
        compiled = compile_house(benchmark, name, renderer=renderer)
        moved = tuple(
            CompiledTasks(tasks.tasks, tasks.batch.to(device), tasks.panoramas.to(device))
            for tasks in compiled.sets
        )
        store = compiled.store
        views = HouseViews(
            house=name,
            # Copies: a store's arrays are read-only, a tensor's memory is not.
            views=torch.tensor(store.views, device=device),
            panorama_views=torch.tensor(store.panorama_views, device=device).long(),
        )
        problems.append(Problem(replace(compiled, sets=moved), views))
        progress(name)
    return tuple(problems)


def select_tasks(tasks: CompiledTasks, split: Split) -> CompiledTasks | None:
    """The rows of a compiled set that belong to a split; None if there are none."""
    rows = [row for row, task in enumerate(tasks.tasks) if task.split == split]
    return tasks.rows(rows) if rows else None


def train_set(benchmark: Benchmark, problems: Sequence[Problem], *, oracle: bool) -> TrainSet:
    """What a method may learn from: training tasks, their dynamics and demonstrations.

    Args:
        benchmark: The benchmark.
        problems: Its compiled houses.
        oracle: Whether the method is handed true rewards; otherwise no goal is marked.
    """
    houses = []
    for problem in problems:
        chosen = [select_tasks(tasks, Split.TRAIN) for tasks in problem.compiled.sets]
        sets = tuple(_task_set(benchmark, tasks, oracle) for tasks in chosen if tasks is not None)
        if sets:
            houses.append(TrainHouse(problem.views, sets))
    return TrainSet(tuple(houses), benchmark.vocabulary)


def _task_set(benchmark: Benchmark, tasks: CompiledTasks, oracle: bool) -> TaskSet:
    batch = tasks.batch
    demonstrations = demonstrate(benchmark, tasks)
    return TaskSet(
        batch=batch if oracle else replace(batch, goal=torch.zeros_like(batch.goal)),
        panoramas=tasks.panoramas,
        commands=tuple(task.command for task in tasks.tasks),
        demonstrations=demonstrations,
    )
