"""A sentence posed in a house, from the benchmark or imported, and turned into a task."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
from pathlib import Path

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.task import Split, Task, Tasks
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import house_task_sets
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.asked_task import AskedTask, asked_task, clean_sentence
from lcrl_bench.houses.sources import import_house
from lcrl_bench.scenes.walkable import build_grid


@dataclass(frozen=True, eq=False)
class PosedSentence:
    """A sentence in a house."""

    asked: AskedTask
    tasks: TaskSet
    """The sentence's task, as a set of one."""
    home: Benchmark
    """The benchmark of the house: the one given, or one of an imported house alone."""


def pose_sentence(
    benchmark: Benchmark,
    sentence: str,
    *,
    house: str | None = None,
    start: int | None = None,
    renderer: str = "auto",
) -> PosedSentence:
    """Pose a sentence in a house.

    Args:
        benchmark: The benchmark whose houses can be chosen.
        sentence: Any sentence; repeated spaces are collapsed.
        house: Id of a house of the benchmark, or a house file of any known format; None means the
            first test house in which the sentence is unambiguous and can be fulfilled, else the
            first in which its meaning is known, else the first.
        start: Tile to start on; see `asked_task`.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for views that are not cached.

    Raises:
        UsageError: If the house or tile does not exist, or the sentence is invalid.
        InvalidFileError: If the file is not a house.
    """
    home, asked = _settle(benchmark, clean_sentence(sentence), house, start)
    tasks, row = next(
        (tasks, row)
        for tasks in _task_sets(home, asked.task, renderer)
        for row, task in enumerate(tasks.tasks)
        if task.id == asked.task.id
    )
    return PosedSentence(asked, tasks.rows([row]), home)


def _settle(
    benchmark: Benchmark, sentence: str, house: str | None, start: int | None
) -> tuple[Benchmark, AskedTask]:
    """The benchmark of the house, and the task in it."""
    if house is None:
        return benchmark, _in_some_house(benchmark, sentence, start)
    if house in benchmark.houses:
        return benchmark, _in_house(benchmark, house, sentence, start)
    if not Path(house).is_file():
        near = difflib.get_close_matches(house, benchmark.houses, n=1)
        hint = f" Did you mean '{near[0]}'?" if near else ""
        raise UsageError(
            f"--house {house} is neither a house of {benchmark.name} nor a file.{hint}"
            f" Houses: {', '.join(sorted(benchmark.houses))}."
        )
    own = import_house(Path(house)).house
    grid = build_grid(own, benchmark.semantics)
    alone = Benchmark(own.id, benchmark.semantics, {own.id: own}, {own.id: grid}, Tasks())
    return alone, _in_house(alone, own.id, sentence, start)


def _in_some_house(benchmark: Benchmark, sentence: str, start: int | None) -> AskedTask:
    names = benchmark.houses_of(Split.TEST_HOUSE) or tuple(sorted(benchmark.houses))
    meant: str | None = None
    for name in names:
        # The start is a tile of the chosen house, which other houses need not have.
        asked = _in_house(benchmark, name, sentence, None)
        if asked.known and not asked.note and asked.task.proof.optimal_length > 0:
            return asked if start is None else _in_house(benchmark, name, sentence, start)
        if asked.known and meant is None:
            meant = name
    return _in_house(benchmark, meant or names[0], sentence, start)


def _in_house(benchmark: Benchmark, name: str, sentence: str, start: int | None) -> AskedTask:
    tasks = benchmark.select(house=name)
    trained = any(task.split == Split.TRAIN for task in tasks)
    split = Split.TEST_TASK if trained else Split.TEST_HOUSE
    return asked_task(benchmark.scene(name), sentence, split=split, tasks=tasks, start=start)


def _task_sets(home: Benchmark, task: Task, renderer: str) -> tuple[TaskSet, ...]:
    """The task in its house, together with the house's own tasks if that avoids rendering."""
    own = home.select(house=task.house)
    seen = set(arrangements_of((task,))) <= set(arrangements_of(own))
    alone = replace(
        home,
        houses={task.house: home.houses[task.house]},
        grids={task.house: home.grids[task.house]},
        tasks=(*own, task) if seen else (task,),
        views=home.views if seen else {},
    )
    return house_task_sets(alone, task.house, renderer=renderer)
