"""Building a benchmark from houses: draw tasks, prove them, and split them as in the paper.

Source: paper, section "Experimental Procedure": the "task" test set holds novel combinations of
objects and locations in training houses, the "house" test set holds entirely new houses.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.built_house import BuiltHouse, build_house
from lcrl_bench.benchmarks.grammar import tokens
from lcrl_bench.benchmarks.task import Kind, Split, Task, Tasks
from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.houses.house import House
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics


@dataclass(frozen=True)
class TaskCount:
    """The exact number of tasks wanted for one split and kind."""

    split: Split
    kind: Kind
    tasks: int


@dataclass(frozen=True)
class BuildConfig:
    """How a benchmark is drawn."""

    name: str
    seed: int = 0
    nav: int = 10
    """NAV tasks wanted per house."""
    pick: int = 10
    """PICK tasks wanted per house."""
    test_houses: float = 0.25
    """Share of houses held out entirely (at least one, if there are two or more)."""
    test_tasks: float = 0.19
    """Share of a training house's tasks held out (paper: 236 of 1,240)."""
    counts: tuple[TaskCount, ...] = ()
    """Exact numbers of tasks per split and kind; combinations not named are unlimited."""
    semantics: Semantics = DEFAULT_SEMANTICS


def build_benchmark(
    houses: Sequence[House],
    config: BuildConfig,
    *,
    renderer: str = "auto",
    progress: Callable[[str], None] = lambda _: None,
) -> Benchmark:
    """Draw, prove and split the tasks of `houses`.

    Args:
        houses: At least one; houses without provable tasks are left out.
        config: Counts, shares and seed.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.
        progress: Called with each house when it is done.

    Raises:
        UsageError: If two houses share an id.
        NothingSelectedError: If no house yields a task.
    """
    names = Counter(house.id for house in houses)
    if doubled := [name for name, count in names.items() if count > 1]:
        raise UsageError(f"Several houses are named {doubled}; rename all but one.")
    rng, streams = random_streams(tuple(names), config.seed)
    built = []
    for house in sorted(houses, key=lambda house: house.id):
        built.append(
            build_house(
                house,
                config.semantics,
                nav=config.nav,
                pick=config.pick,
                rng=streams[house.id],
                renderer=renderer,
            )
        )
        progress(f"{house.id}: {len(built[-1].tasks)} tasks")
    return join_houses(built, config, rng)


def random_streams(
    houses: Sequence[str], seed: int
) -> tuple[np.random.Generator, dict[str, np.random.Generator]]:
    """The generator of the splits, and one for each house.

    Args:
        houses: Ids of all houses, in any order.
        seed: The benchmark's.
    """
    rng = np.random.default_rng(seed)
    names = sorted(houses)
    return rng, dict(zip(names, rng.spawn(len(names)), strict=True))


def house_stream(number: int, seed: int) -> np.random.Generator:
    """The generator that `random_streams` gives to the house of a number, alone."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))


def join_houses(
    houses: Sequence[BuiltHouse], config: BuildConfig, rng: np.random.Generator
) -> Benchmark:
    """Split the tasks of houses that are built one by one, in any order.

    Args:
        houses: What `build_house` made of each; those without tasks are left out.
        config: Counts and shares.
        rng: From `random_streams`.

    Raises:
        NothingSelectedError: If no house yields a task, or not as many as are wanted.
    """
    kept = {each.house.id: each for each in houses if each.tasks}
    if not kept:
        raise NothingSelectedError(
            "No house yields a task: none has two named rooms or objects that are reachable within "
            f"{config.semantics.horizon} steps and visible. See `lcrl-bench house show`."
        )
    split = _split({name: each.tasks for name, each in kept.items()}, config, rng)
    used = sorted({task.house for task in split})
    return Benchmark(
        name=config.name,
        semantics=config.semantics,
        houses={name: kept[name].house for name in used},
        grids={name: kept[name].grid for name in used},
        tasks=Tasks(split),
    )


def _split(
    tasks: dict[str, tuple[Task, ...]], config: BuildConfig, rng: np.random.Generator
) -> tuple[Task, ...]:
    """Assign every task a split; test tasks with words that don't occur in training are dropped."""
    names = sorted(tasks)
    held = round(len(names) * config.test_houses)
    held = min(max(held, 1), len(names) - 1)
    test_houses = {names[i] for i in rng.permutation(len(names))[:held]} if held > 0 else set()
    split: list[Task] = []
    for name in names:
        if name in test_houses:
            split += [replace(task, split=Split.TEST_HOUSE) for task in tasks[name]]
        else:
            split += _hold_out(tasks[name], config.test_tasks, rng)
    train = _exactly([task for task in split if task.split == Split.TRAIN], config.counts, rng)
    known = {word for task in train for word in tokens(task.command)}
    test = [
        task
        for task in split
        if task.split != Split.TRAIN and known.issuperset(tokens(task.command))
    ]
    chosen = {task.id for task in (*train, *_exactly(test, config.counts, rng))}
    return tuple(task for task in split if task.id in chosen)


def _exactly(
    tasks: list[Task], counts: tuple[TaskCount, ...], rng: np.random.Generator
) -> list[Task]:
    """The wanted number of tasks per split and kind, spread over the houses as evenly as possible.

    Raises:
        NothingSelectedError: If there are fewer.
    """
    for count in counts:
        of_both = [t for t in tasks if (t.split, t.kind) == (count.split, count.kind)]
        if not any(task.split == count.split for task in tasks):
            continue
        if len(of_both) < count.tasks:
            raise NothingSelectedError(
                f"The houses yield {len(of_both)} {count.kind} tasks in {count.split}, not "
                f"{count.tasks}. Give more houses, or raise --nav and --pick."
            )
        taken = {task.id for task in _evenly(of_both, count.tasks, rng)}
        of_both_ids = {task.id for task in of_both}
        tasks = [task for task in tasks if task.id in taken or task.id not in of_both_ids]
    return tasks


def _evenly(tasks: list[Task], wanted: int, rng: np.random.Generator) -> list[Task]:
    """Take tasks from the houses in turn, each house's tasks in random order."""
    order = [tasks[index] for index in rng.permutation(len(tasks))]
    turn: Counter[str] = Counter()
    ranked = []
    for task in order:
        ranked.append((turn[task.house], len(ranked), task))
        turn[task.house] += 1
    return [task for *_, task in sorted(ranked, key=lambda row: row[:2])[:wanted]]


def _hold_out(tasks: tuple[Task, ...], share: float, rng: np.random.Generator) -> list[Task]:
    """Hold out a share of each kind of a house's tasks."""
    held: set[str] = set()
    for kind in {task.kind: None for task in tasks}:
        of_kind = [task.id for task in tasks if task.kind == kind]
        count = round(len(of_kind) * share)
        held.update(of_kind[index] for index in rng.permutation(len(of_kind))[:count])
    return [replace(task, split=Split.TEST_TASK) if task.id in held else task for task in tasks]
