"""`benchmark check`: prove every task of a benchmark again, from physics and pixels."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from lcrl_bench.benchmarks.benchmark import Benchmark, grid_to_json
from lcrl_bench.benchmarks.grammar import tokens
from lcrl_bench.benchmarks.projections import MIN_SUCCESS, Projection, success_by_sight
from lcrl_bench.benchmarks.proof import MAX_RANDOM_SUCCESS, start_table
from lcrl_bench.benchmarks.task import Split, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import house_task_sets
from lcrl_bench.benchmarks.visibility import visibility_failures
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import Semantics


@dataclass(frozen=True)
class Failure:
    """One failed check."""

    subject: str
    """Id of the task or house."""
    reason: str


def check_benchmark(
    benchmark: Benchmark,
    *,
    houses: tuple[str, ...] | None = None,
    renderer: str = "auto",
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[int, list[Failure]]:
    """Prove a benchmark's tasks again.

    Args:
        benchmark: The benchmark.
        houses: Ids of the houses to check; None means all.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.
        progress: Called with each house when it is done.

    Returns:
        The number of tasks checked, and every failure.
    """
    names = tuple(benchmark.houses) if houses is None else houses
    failures = split_failures(benchmark)
    checked = 0
    for name in names:
        number, found = check_house(benchmark, name, renderer=renderer)
        checked, failures = checked + number, failures + found
        progress(name)
    return checked, failures


def check_house(
    benchmark: Benchmark, name: str, *, renderer: str = "auto"
) -> tuple[int, list[Failure]]:
    """Prove the tasks of one house again: how many, and every failure.

    Args:
        benchmark: The benchmark.
        name: Id of the house.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.
    """
    failures: list[Failure] = []
    checked = 0
    grid = build_grid(benchmark.houses[name], benchmark.semantics)
    if grid_to_json(grid) != grid_to_json(benchmark.grids[name]):
        failures.append(Failure(name, "its grid differs from the one physics gives now"))
    for tasks in house_task_sets(benchmark, name, renderer=renderer):
        enough = success_by_sight(tasks, Projection.CELLS)
        invisible = visibility_failures(tasks)
        for row, task in enumerate(tasks.tasks):
            checked += 1
            reasons = invisible[row] + _proof_failures(tasks, row, benchmark.semantics)
            if enough[row] < MIN_SUCCESS:
                reasons.append("its views do not determine where its goal is")
            failures += [Failure(task.id, reason) for reason in reasons]
    return checked, failures


def _proof_failures(tasks: TaskSet, row: int, semantics: Semantics) -> list[str]:
    task, one = tasks.tasks[row], tasks.rows([row])
    proof = start_table(one, semantics.success_reward).proof(int(one.start[0]))
    found = []
    if proof.optimal_length < 0:
        found.append(f"no policy solves it within {semantics.horizon} steps")
    if proof.optimal_length == 0:
        found.append("it is already solved at its start")
    if proof.random_success > MAX_RANDOM_SUCCESS:
        found.append(f"a random policy solves it {proof.random_success:.1%} of the time")
    if not _same(task, proof.optimal_length, proof.value, proof.random_success):
        found.append(f"its stored proof {task.proof} differs from the new one {proof}")
    return found


def _same(task: Task, length: int, value: float, chance: float) -> bool:
    stored = task.proof
    return (
        stored.optimal_length == length
        and math.isclose(stored.value, value, rel_tol=1e-9)
        and math.isclose(stored.random_success, chance, rel_tol=1e-9)
    )


def split_failures(benchmark: Benchmark) -> list[Failure]:
    """Check that the splits are what they claim to be."""
    train = set(benchmark.houses_of(Split.TRAIN))
    trained = {(task.house, task.command) for task in benchmark.select(split=Split.TRAIN)}
    words = set(benchmark.vocabulary)
    found = [
        Failure(name, "a test house that also occurs in training")
        for name in set(benchmark.houses_of(Split.TEST_HOUSE)) & train
    ]
    for task in benchmark.tasks:
        if task.split == Split.TEST_TASK and (task.house, task.command) in trained:
            found.append(Failure(task.id, "its sentence occurs in training in the same house"))
        if task.split == Split.TEST_TASK and task.house not in train:
            found.append(Failure(task.id, "a test task in a house without training tasks"))
        if unknown := set(tokens(task.command)) - words:
            found.append(Failure(task.id, f"words that don't occur in training: {sorted(unknown)}"))
    return found
