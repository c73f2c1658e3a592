"""A sentence put into a house: found or imported, made a task of, and compiled."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
from pathlib import Path

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.compiled import CompiledTasks
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.sampling import HouseSite
from lcrl_bench.benchmarks.task import Split, Task
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.asked_task import AskedTask, asked_task, clean_sentence
from lcrl_bench.evaluation.problems import Problem, compile_problems
from lcrl_bench.houses.sources import import_house
from lcrl_bench.scenes.walkable import build_grid


@dataclass(frozen=True, eq=False)
class PosedSentence:
    """A sentence in a compiled house."""

    asked: AskedTask
    problem: Problem
    tasks: CompiledTasks
    """The compiled set the asked task is of."""
    row: int
    """Its place in the set."""
    home: Benchmark
    """Where the house is from: the benchmark asked about, or one of the house alone."""


def pose_sentence(
    benchmark: Benchmark,
    sentence: str,
    *,
    house: str | None = None,
    start: int | None = None,
    renderer: str = "auto",
) -> PosedSentence:
    """Put a sentence into a house, compiled.

    Args:
        benchmark: Whose houses there are.
        sentence: Any; spaces are made single.
        house: Id of a house of the benchmark, or a house file of any known format; None means the
            first test house in which the sentence has one meaning and can be fulfilled, or else the
            first in which its meaning is known, or else the first.
        start: Tile to start in; see `asked_task`.
        renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.

    Raises:
        UsageError: If there is no such house or tile, or the sentence is none.
        InvalidFileError: If the file is no house.
    """
    home, asked = _settle(benchmark, clean_sentence(sentence), house, start)
    problem = _compile(home, asked.task, renderer)
    tasks, row = next(
        (tasks, row)
        for tasks in problem.compiled.sets
        for row, task in enumerate(tasks.tasks)
        if task.id == asked.task.id
    )
    return PosedSentence(asked, problem, tasks, row, home)


def _settle(
    benchmark: Benchmark, sentence: str, house: str | None, start: int | None
) -> tuple[Benchmark, AskedTask]:
    """Where the house is from, and the task there."""
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
    alone = Benchmark(own.id, benchmark.semantics, {own.id: own}, {own.id: grid}, ())
    return alone, _in_house(alone, own.id, sentence, start)


def _in_some_house(benchmark: Benchmark, sentence: str, start: int | None) -> AskedTask:
    names = benchmark.houses_of(Split.TEST_HOUSE) or tuple(sorted(benchmark.houses))
    meant: str | None = None
    for name in names:
        # A start is a tile of the house that is chosen; no other house need have it.
        asked = _in_house(benchmark, name, sentence, None)
        if asked.known and not asked.note and asked.task.proof.optimal_length > 0:
            return asked if start is None else _in_house(benchmark, name, sentence, start)
        if asked.known and meant is None:
            meant = name
    return _in_house(benchmark, meant or names[0], sentence, start)


def _in_house(benchmark: Benchmark, name: str, sentence: str, start: int | None) -> AskedTask:
    tasks = benchmark.select(house=name)
    trained = any(task.split == Split.TRAIN for task in tasks)
    site = HouseSite.of(benchmark.houses[name], benchmark.grids[name], benchmark.semantics)
    split = Split.TEST_TASK if trained else Split.TEST_HOUSE
    return asked_task(site, sentence, split=split, tasks=tasks, start=start)


def _compile(home: Benchmark, task: Task, renderer: str) -> Problem:
    """The house with the task, and with its own tasks where that spares rendering anything."""
    own = home.select(house=task.house)
    seen = set(arrangements_of((task,))) <= set(arrangements_of(own))
    alone = replace(
        home,
        houses={task.house: home.houses[task.house]},
        grids={task.house: home.grids[task.house]},
        tasks=(*own, task) if seen else (task,),
        views=home.views if seen else {},
    )
    (problem,) = compile_problems(alone, device=torch.device("cpu"), renderer=renderer)
    return problem
