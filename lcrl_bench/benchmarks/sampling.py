"""Sampling the tasks of a house: all candidates of the grammar, then a diverse selection."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from lcrl_bench.benchmarks.grammar import nav_command, pick_command, words_of
from lcrl_bench.benchmarks.placement import places_apart, supports_of
from lcrl_bench.benchmarks.proof import UNPROVED, start_table
from lcrl_bench.benchmarks.targets import Target, find_targets
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.benchmarks.task_set import one_task
from lcrl_bench.houses.classes import task_objects
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.scenes.scene import Scene


def draw_tasks(scene: Scene, *, nav: int, pick: int, rng: np.random.Generator) -> tuple[Task, ...]:
    """Draw at most `nav` and `pick` tasks of a house, all in the training split for now.

    Every sentence occurs at most once per house. Targets are drawn without replacement for NAV;
    for PICK, objects and targets are balanced as far as the house allows.
    """
    targets = find_targets(scene)
    navs = itertools.islice(_nav_tasks(scene, targets, rng), nav)
    picks = itertools.islice(_pick_tasks(scene, targets, rng), pick)
    return (*navs, *picks)


def _nav_tasks(
    scene: Scene, targets: dict[str, Target], rng: np.random.Generator
) -> Iterator[Task]:
    names = list(targets)
    for index in rng.permutation(len(names)):
        task = _with_start(scene, rng, Kind.NAV, names[index])
        if task is not None:
            yield task


def _pick_tasks(
    scene: Scene, targets: dict[str, Target], rng: np.random.Generator
) -> Iterator[Task]:
    movable = _sole_objects(scene)
    goals = [target for target in targets.values() if _holds_things(scene, target)]
    pairs = [(thing, target) for thing in movable for target in goals]
    order = [pairs[index] for index in rng.permutation(len(pairs))]
    used: dict[str, int] = {}
    while order:
        # The pair whose object and target were used least; ties: first in the random order.
        best = min(order, key=lambda pair: used.get(pair[0].id, 0) + used.get(pair[1].name, 0))
        order.remove(best)
        thing, target = best
        task = _pick_task(scene, thing, target, rng)
        if task is not None:
            used[thing.id] = used.get(thing.id, 0) + 1
            used[target.name] = used.get(target.name, 0) + 1
            yield task


def _sole_objects(scene: Scene) -> list[PlacedObject]:
    """Task objects that are the only ones of their class, so that "the cup" is unambiguous."""
    by_label: dict[str, list[PlacedObject]] = {}
    for thing in scene.house.objects:
        by_label.setdefault(thing.label, []).append(thing)
    return [by_label[name][0] for name in task_objects() if len(by_label.get(name, ())) == 1]


def _holds_things(scene: Scene, target: Target) -> bool:
    """Whether "to the target" is unambiguous, and has a surface to put something on."""
    return len(target.instances) == 1 and bool(_supports(scene, target))


def _supports(scene: Scene, target: Target) -> list[PlacedObject]:
    return supports_of(scene.house, target.instances, rooms=target.is_room)


def _pick_task(
    scene: Scene, thing: PlacedObject, target: Target, rng: np.random.Generator
) -> Task | None:
    (instance,) = target.instances
    if instance in (thing.room, thing.support):
        return None
    supports = _supports(scene, target)
    order = rng.permutation(len(supports))
    placed = next(places_apart(scene, thing, (supports[index] for index in order)), None)
    if placed is None:
        return None
    return _with_start(scene, rng, Kind.PICK, target.name, thing, placed)


def _with_start(
    scene: Scene,
    rng: np.random.Generator,
    kind: Kind,
    target: str,
    thing: PlacedObject | None = None,
    placed: PlacedObject | None = None,
) -> Task | None:
    """Draw a start that is admitted; None if there is none."""
    words = words_of(target)
    command = pick_command(words_of(thing.label), words) if thing else nav_command(words)
    draft = Task(
        id=f"{scene.house.id}.{command.replace(' ', '-')}",
        kind=kind,
        split=Split.TRAIN,
        house=scene.house.id,
        command=command,
        target=target,
        start_tile=0,
        start_heading=0,
        proof=UNPROVED,
        moved=thing.id if thing else None,
        placement=placed,
    )
    starts = start_table(one_task(scene, draft), scene.semantics.success_reward)
    # The object starts at its original place.
    first = slice(0, scene.grid.tiles * HEADINGS)
    states = np.flatnonzero(starts.admitted(scene.semantics)[first])
    if not len(states):
        return None
    state = int(rng.choice(states))
    return replace(
        draft,
        start_tile=state // HEADINGS,
        start_heading=state % HEADINGS,
        proof=starts.proof(state),
    )
