"""A benchmark as a method meets it: compiled houses, and the `TrainSet` made from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.compiled import CompiledHouse, CompiledTasks, compile_house
from lcrl_bench.benchmarks.demonstrations import demonstrate
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.mdp.expert import shortest_way_policy
from lcrl_bench.methods.contract import HouseViews, TaskSet, TrainHouse, TrainSet
from lcrl_bench.methods.observed_house import ObservedHouse

CHUNK = 16
"""Tasks solved at once: bounds memory at about 100 MB, whatever the house."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A compiled house, and what can be seen in it on the device of the run."""

    compiled: CompiledHouse
    views: HouseViews

    @cached_property
    def parts(self) -> tuple[CompiledTasks, ...]:
        """Its tasks in sets small enough to be solved at once, in order: one kind a set."""
        return tuple(part for tasks in self.compiled.sets for part in chunks(tasks))

    @cached_property
    def observed(self) -> ObservedHouse:
        """What a learned reward or policy is shown of it."""
        return ObservedHouse.of(self.views)


def chunks(tasks: CompiledTasks, *, size: int = CHUNK) -> list[CompiledTasks]:
    """A compiled set in parts of at most `size` tasks."""
    count = len(tasks.tasks)
    if count <= size:
        return [tasks]
    return [tasks.rows(range(k, min(k + size, count))) for k in range(0, count, size)]


def compile_problems(
    benchmark: Benchmark,
    *,
    device: torch.device,
    renderer: str = "auto",
    image_size: tuple[int, int] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[Problem, ...]:
    """Compile every house of a benchmark, rendering what is not in the cache.

    Args:
        benchmark: The benchmark.
        device: Where views and tables are to live.
        renderer: `"auto"`, `"gl"` or `"rays"`.
        image_size: Width and height of the views in pixels; None means the benchmark's own.
        progress: Told each house as it is done.
    """
    problems = []
    for name in sorted(benchmark.houses):
        compiled = compile_house(benchmark, name, renderer=renderer, image_size=image_size)
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


def train_set(
    benchmark: Benchmark, problems: Sequence[Problem], *, oracle: bool, expert: bool = False
) -> TrainSet:
    """What a method may learn from: training tasks, their dynamics and demonstrations.

    Args:
        benchmark: The benchmark.
        problems: Its compiled houses.
        oracle: Whether the method is handed true rewards; otherwise no goal is marked.
        expert: Whether it is handed the optimal action probabilities in every state.
    """
    houses = []
    for problem in problems:
        chosen = [select_tasks(tasks, Split.TRAIN) for tasks in problem.compiled.sets]
        kept = [tasks for tasks in chosen if tasks is not None]
        if kept:
            # What only test tasks bring about is not shown: it would tell where their goals are.
            used = torch.cat([tasks.panoramas.flatten() for tasks in kept]).unique()
            seen = ObservedHouse.of(problem.views, used)
            sets = tuple(_task_set(benchmark, tasks, seen, oracle, expert) for tasks in kept)
            houses.append(TrainHouse(replace(seen.views, house=problem.views.house), sets))
    return TrainSet(tuple(houses), benchmark.vocabulary)


def _task_set(
    benchmark: Benchmark, tasks: CompiledTasks, seen: ObservedHouse, oracle: bool, expert: bool
) -> TaskSet:
    batch = tasks.batch
    demonstrations = demonstrate(benchmark, tasks)
    return TaskSet(
        batch=batch if oracle else replace(batch, goal=torch.zeros_like(batch.goal)),
        panoramas=seen.place[tasks.panoramas],
        commands=tuple(task.command for task in tasks.tasks),
        demonstrations=demonstrations,
        held=tasks.held,
        expert=shortest_way_policy(batch) if expert else None,
    )
