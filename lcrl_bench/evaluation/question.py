"""A sentence asked of a run's model in a house: everything an answer is computed from."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace
from pathlib import Path

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.compiled import CompiledTasks
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.sampling import HouseSite
from lcrl_bench.benchmarks.task import Split, Task
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.asked_task import AskedTask, asked_task, check_sentence
from lcrl_bench.evaluation.learned import load_learned
from lcrl_bench.evaluation.problems import Problem, compile_problems
from lcrl_bench.evaluation.sentences import known_words, unknown_words
from lcrl_bench.houses.sources import import_house
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.storage import read_json


@dataclass(frozen=True, eq=False)
class Model:
    """What a run learned, and on what."""

    learned: Reward | Policy
    method: str
    seed: int
    benchmark: Benchmark
    notes: tuple[str, ...]
    """What is to be known of it, a sentence each."""


@dataclass(frozen=True, eq=False)
class Question:
    """A sentence in a compiled house."""

    model: Model
    asked: AskedTask
    problem: Problem
    tasks: CompiledTasks
    """The compiled set the asked task is of."""
    row: int
    """Its place in the set."""
    home: Benchmark
    """Where the house is from: the model's benchmark, or one of the house alone."""
    unknown: dict[str, str | None]
    """Words the model was never told, each with the nearest it was; None where none is near."""

    @property
    def own_house(self) -> bool:
        """Whether the house is none of the model's benchmark."""
        return self.home is not self.model.benchmark

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be said beside the answer, a sentence each."""
        return (*self.model.notes, *filter(None, [self.asked.note]))


def open_model(run: Path, *, benchmark: str | None = None) -> Model:
    """Load what a run learned, and the benchmark it learned on.

    Args:
        run: `runs/<benchmark>/<method>/seed<k>`.
        benchmark: A shipped benchmark's name or a folder; None means the one the run names.

    Raises:
        InvalidFileError: If the folder holds no run, or its model is damaged.
        UnknownNameError: If its method or its benchmark is not found here.
        UsageError: If it learned from views of another size than its benchmark's.
    """
    learned, config = load_learned(run), read_json(run / "config.json")
    found = read_benchmark(benchmark_folder(benchmark or str(config.get("benchmark"))))
    trained = str(config.get("fingerprint"))
    notes: tuple[str, ...] = ()
    if trained != found.fingerprint:
        notes = (
            f"the run learned on a benchmark with the fingerprint {trained[:12]}; that of"
            f" {found.name} is {found.fingerprint[:12]}",
        )
    return Model(learned, str(config["method"]), int(config.get("seed", 0)), found, notes)


def pose_question(
    model: Model,
    sentence: str,
    *,
    house: str | None = None,
    start: int | None = None,
    renderer: str = "auto",
) -> Question:
    """Put a sentence into a house, compiled.

    Args:
        model: Who is asked.
        sentence: Any.
        house: Id of a house of the model's benchmark, or a house file of any known format; None
            means the first test house in which the sentence has one meaning and can be fulfilled,
            or else the first in which its meaning is known, or else the first.
        start: Tile to start in; see `asked_task`.
        renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.

    Raises:
        UsageError: If there is no such house or tile, or the sentence is empty or too long.
        InvalidFileError: If the file is no house.
    """
    check_sentence(sentence)
    home, asked = _settle(model.benchmark, sentence, house, start)
    problem = _compile(home, asked.task, renderer)
    tasks, row = next(
        (tasks, row)
        for tasks in problem.compiled.sets
        for row, task in enumerate(tasks.tasks)
        if task.id == asked.task.id
    )
    words = known_words(model.learned, model.benchmark.vocabulary)
    return Question(model, asked, problem, tasks, row, home, unknown_words(sentence, words))


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
