"""Drawing the tasks of a house: every candidate the grammar allows, then a varied selection."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.dynamics import (
    ObjectState,
    nav_transitions,
    pick_goal,
    pick_transitions,
)
from lcrl_bench.benchmarks.grammar import nav_command, pick_command, words_of
from lcrl_bench.benchmarks.placement import free_placements
from lcrl_bench.benchmarks.proof import start_table
from lcrl_bench.benchmarks.targets import Target, find_targets
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.houses.classes import task_objects
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.receptacles import faces
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.reach import within_reach
from lcrl_bench.semantics import Semantics

PLACES_TRIED = 12
"""Free places looked at on one piece of furniture before the next piece is tried."""


@dataclass(frozen=True, eq=False)
class HouseSite:
    """A house with what every task in it shares."""

    house: House
    grid: Grid
    semantics: Semantics
    targets: dict[str, Target]
    moves: NDArray[np.int64]

    @classmethod
    def of(cls, house: House, grid: Grid, semantics: Semantics) -> HouseSite:
        """Find a house's targets and transitions once."""
        targets = find_targets(house, grid, semantics)
        return cls(house, grid, semantics, targets, nav_transitions(grid))


def draw_tasks(
    site: HouseSite, *, nav: int, pick: int, rng: np.random.Generator
) -> tuple[Task, ...]:
    """Draw at most `nav` and `pick` tasks of a house, all in the training split for now.

    Every sentence occurs at most once in a house. Targets are drawn without replacement for NAV;
    for PICK each object and each target comes up as evenly as the house allows.
    """
    navs = itertools.islice(_nav_tasks(site, rng), nav)
    picks = itertools.islice(_pick_tasks(site, rng), pick)
    return (*navs, *picks)


def _nav_tasks(site: HouseSite, rng: np.random.Generator) -> Iterator[Task]:
    names = list(site.targets)
    for index in rng.permutation(len(names)):
        target = site.targets[names[index]]
        goal = np.repeat(target.tiles, HEADINGS)
        task = _with_start(site, site.moves, goal, rng, Kind.NAV, target.name)
        if task is not None:
            yield task


def _pick_tasks(site: HouseSite, rng: np.random.Generator) -> Iterator[Task]:
    movable = _sole_objects(site)
    goals = [target for target in site.targets.values() if _holds_things(site, target)]
    pairs = [(thing, target) for thing in movable for target in goals]
    order = [pairs[index] for index in rng.permutation(len(pairs))]
    used: dict[str, int] = {}
    while order:
        # The pair whose object and target have come up least, first in the drawn order.
        best = min(order, key=lambda pair: used.get(pair[0].id, 0) + used.get(pair[1].name, 0))
        order.remove(best)
        thing, target = best
        task = _pick_task(site, thing, target, rng)
        if task is not None:
            used[thing.id] = used.get(thing.id, 0) + 1
            used[target.name] = used.get(target.name, 0) + 1
            yield task


def _sole_objects(site: HouseSite) -> list[PlacedObject]:
    """Task objects that are the only one of their class, so that "the cup" is no riddle."""
    by_label: dict[str, list[PlacedObject]] = {}
    for thing in site.house.objects:
        by_label.setdefault(thing.label, []).append(thing)
    return [by_label[name][0] for name in task_objects() if len(by_label.get(name, ())) == 1]


def _holds_things(site: HouseSite, target: Target) -> bool:
    """Whether "to the target" means one place only, with a surface to put something on."""
    return len(target.instances) == 1 and bool(_supports(site, target))


def _supports(site: HouseSite, target: Target) -> list[PlacedObject]:
    (instance,) = target.instances
    return [
        thing
        for thing in site.house.objects
        if faces(thing) and (thing.room == instance if target.is_room else thing.id == instance)
    ]


def _pick_task(
    site: HouseSite, thing: PlacedObject, target: Target, rng: np.random.Generator
) -> Task | None:
    (instance,) = target.instances
    if instance in (thing.room, thing.support):
        return None
    reach_a = within_reach(site.house, site.grid, thing, site.semantics)
    placed = _place(site, thing, target, reach_a, rng)
    if placed is None or not reach_a.any():
        return None
    reach_b = within_reach(site.house, site.grid, placed, site.semantics)
    table = pick_transitions(site.moves, reach_a, reach_b)
    goal = np.repeat(pick_goal(site.grid.tiles), HEADINGS)
    return _with_start(site, table, goal, rng, Kind.PICK, target.name, thing, placed)


def _place(
    site: HouseSite,
    thing: PlacedObject,
    target: Target,
    reach_a: NDArray[np.bool_],
    rng: np.random.Generator,
) -> PlacedObject | None:
    """A free place at the target that is within reach from somewhere, and never together with A."""
    supports = _supports(site, target)
    for index in rng.permutation(len(supports)):
        places = free_placements(site.house, thing, supports[index])
        for placed in itertools.islice(places, PLACES_TRIED):
            reach_b = within_reach(site.house, site.grid, placed, site.semantics)
            if reach_b.any() and not (reach_a & reach_b).any():
                return placed
    return None


def _with_start(
    site: HouseSite,
    table: NDArray[np.int64],
    goal: NDArray[np.bool_],
    rng: np.random.Generator,
    kind: Kind,
    target: str,
    thing: PlacedObject | None = None,
    placed: PlacedObject | None = None,
) -> Task | None:
    """Draw a start from which the task is admitted; None if there is none."""
    starts = start_table(table, goal, site.semantics)
    first = slice(0, site.grid.tiles * HEADINGS * (ObjectState.AT_A + 1))
    states = np.flatnonzero(starts.admitted(site.semantics)[first])
    if not len(states):
        return None
    state = int(rng.choice(states))
    words = words_of(target)
    command = pick_command(words_of(thing.label), words) if thing else nav_command(words)
    return Task(
        id=f"{site.house.id}.{command.replace(' ', '-')}",
        kind=kind,
        split=Split.TRAIN,
        house=site.house.id,
        command=command,
        target=target,
        start_tile=state // HEADINGS,
        start_heading=state % HEADINGS,
        proof=starts.proof(state),
        moved=thing.id if thing else None,
        placement=placed,
    )
