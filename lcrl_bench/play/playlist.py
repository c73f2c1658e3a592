"""Which tasks are played, in which order: a sentence, one task, or all of a house or benchmark."""

from __future__ import annotations

import difflib

import numpy as np

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import TaskSets, task_named
from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.evaluation.posed_sentence import PosedSentence, pose_sentence

HOUSES_KEPT = 4
"""Houses that are kept in memory."""


class Playlist:
    """Tasks to play, in an endless cycle."""

    def __init__(
        self,
        benchmark: Benchmark,
        tasks: tuple[Task, ...],
        *,
        posed: PosedSentence | None = None,
        renderer: str = "auto",
    ) -> None:
        """Take tasks of a benchmark, preceded by a typed sentence if there is one."""
        self.benchmark = benchmark
        self._tasks = tasks
        self._posed = posed
        self._sets = TaskSets(benchmark, renderer=renderer, houses_kept=HOUSES_KEPT)

    def __len__(self) -> int:
        """Number of tasks in a cycle."""
        return len(self._tasks) + (self._posed is not None)

    def played(self, number: int) -> TaskSet:
        """A task as a set of one; numbers wrap around."""
        number %= len(self)
        if self._posed is not None and number == 0:
            return self._posed.tasks
        return self._sets.single(self._tasks[number - (self._posed is not None)])

    def note(self, number: int) -> str:
        """Note shown before a task; may be empty."""
        typed = self._posed is not None and number % len(self) == 0
        return self._posed.asked.note if typed and self._posed is not None else ""


def choose_tasks(
    benchmark: Benchmark,
    *,
    generator: np.random.Generator,
    house: str | None = None,
    task: str | None = None,
    sentence: str | None = None,
    renderer: str = "auto",
) -> Playlist:
    """Choose the tasks to play.

    Args:
        benchmark: The benchmark.
        generator: Draws the order.
        house: Only tasks of this house; with a sentence also a house file of any known format.
        task: Id of the task to begin with.
        sentence: A sentence to begin with, as `ask` takes it.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for views that are not in the cache.

    Raises:
        UsageError: If both a task and a sentence are given, or there is no such house or task.
        NothingSelectedError: If the house has no task.
    """
    if sentence is not None:
        if task is not None:
            raise UsageError("Give --task or --sentence, not both.")
        posed = pose_sentence(benchmark, sentence, house=house, renderer=renderer)
        own = posed.home.select(house=posed.asked.task.house)
        order = _shuffled(own, generator)
        return Playlist(benchmark, order, posed=posed, renderer=renderer)
    first = None if task is None else task_named(benchmark, task)
    if house is not None and house not in benchmark.houses:
        near = difflib.get_close_matches(house, benchmark.houses, n=1)
        hint = f" Did you mean '{near[0]}'?" if near else ""
        raise UsageError(f"--house {house} is no house of {benchmark.name}.{hint}")
    tasks = benchmark.select(house=house or (first.house if first else None))
    if not tasks:
        raise NothingSelectedError(f"{house or benchmark.name} has no task. Give a --sentence.")
    order = _shuffled(tasks, generator)
    if first is not None:
        order = (first, *(each for each in order if each.id != first.id))
    return Playlist(benchmark, order, renderer=renderer)


def _shuffled(tasks: tuple[Task, ...], generator: np.random.Generator) -> tuple[Task, ...]:
    return tuple(tasks[k] for k in generator.permutation(len(tasks)))
