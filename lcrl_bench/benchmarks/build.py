"""Building a benchmark from houses: draw tasks, prove them, and split them as in the paper.

Source: paper, section "Experimental Procedure": the "task" test set holds novel combinations of
objects and locations in training houses, the "house" test set holds entirely new houses.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.grammar import tokens
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.projections import MIN_SUCCESS, Projection, success_by_sight
from lcrl_bench.benchmarks.sampling import draw_tasks
from lcrl_bench.benchmarks.task import Kind, Split, Task, Tasks
from lcrl_bench.benchmarks.task_set import stack_tasks
from lcrl_bench.benchmarks.visibility import visibility_failures
from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.houses.house import House
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.scene import Scene
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


SPARE = 2
"""Candidates drawn per task wanted, as some turn out to be invisible."""


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
        renderer: `"auto"`, `"gl"` or `"rays"`.
        progress: Called with each house when it is done.

    Raises:
        UsageError: If two houses share an id.
        NothingSelectedError: If no house yields a task.
    """
    check_ids(houses)
    proved: dict[str, Proved] = {}
    for number, house in enumerate(sorted(houses, key=lambda house: house.id)):
        proved[house.id] = prove_house(house, config, number, renderer=renderer)
        progress(f"{house.id}: {len(proved[house.id].tasks)} tasks")
    return assemble(houses, config, proved)


@dataclass(frozen=True)
class Proved:
    """What `prove_house` finds out about a house."""

    grid: Grid
    tasks: tuple[Task, ...]


def check_ids(houses: Sequence[House]) -> None:
    """Refuse houses of one name.

    Raises:
        UsageError: If two houses share an id.
    """
    names = Counter(house.id for house in houses)
    if doubled := [name for name, count in names.items() if count > 1]:
        raise UsageError(f"Several houses are named {doubled}; rename all but one.")


def prove_house(
    house: House, config: BuildConfig, number: int, *, renderer: str = "auto"
) -> Proved:
    """Draw and prove the tasks of one house; it needs no other.

    Args:
        house: The house.
        config: Wanted numbers and seed.
        number: The house's place among all houses, sorted by id: its random stream.
        renderer: `"auto"`, `"gl"` or `"rays"`.
    """
    stream = np.random.default_rng(config.seed).spawn(number + 1)[number]
    scene = Scene(house, config.semantics, renderer=renderer)
    return Proved(scene.grid, _proved_tasks(scene, config, stream))


def assemble(
    houses: Sequence[House], config: BuildConfig, proved: Mapping[str, Proved]
) -> Benchmark:
    """Split the tasks of proved houses, and make a benchmark of them.

    Args:
        houses: At least one; houses without proved tasks are left out.
        config: Counts, shares and seed.
        proved: By house id, what `prove_house` found out.

    Raises:
        NothingSelectedError: If no house has a task.
    """
    rng = np.random.default_rng(config.seed)
    kept = {h.id: h for h in sorted(houses, key=lambda h: h.id) if proved[h.id].tasks}
    grids = {name: proved[name].grid for name in kept}
    tasks = {name: proved[name].tasks for name in kept}
    if not tasks:
        raise NothingSelectedError(
            "No house yields a task: none has two named rooms or objects that are reachable within "
            f"{config.semantics.horizon} steps and visible. See `lcrl-bench house show`."
        )
    split = _split(tasks, config, rng)
    used = {task.house for task in split}
    return Benchmark(
        name=config.name,
        semantics=config.semantics,
        houses={name: kept[name] for name in kept if name in used},
        grids={name: grids[name] for name in grids if name in used},
        tasks=Tasks(split),
    )


def _proved_tasks(scene: Scene, config: BuildConfig, rng: np.random.Generator) -> tuple[Task, ...]:
    """The wanted number of tasks of a house that are solvable, visible and not solved by chance."""
    drawn = draw_tasks(scene, nav=config.nav * SPARE, pick=config.pick * SPARE, rng=rng)
    arrangements = arrangements_of(drawn)
    sets = stack_tasks(scene, drawn, scene.panoramas(arrangements), arrangements)
    limits = {Kind.NAV: config.nav, Kind.PICK: config.pick}
    chosen: list[Task] = []
    for tasks in sets:
        enough = success_by_sight(tasks, Projection.CELLS)
        invisible = visibility_failures(tasks)
        visible = [
            task
            for row, task in enumerate(tasks.tasks)
            if enough[row] >= MIN_SUCCESS and not invisible[row]
        ]
        chosen.extend(visible[: limits[tasks.kind]])
    return tuple(chosen)


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
