"""A typed sentence in a house as a task, with its true goal if that is known.

The goal is known if the sentence follows the grammar and the house has what it names; it is then
the benchmark's own, including place B of a moved object. Any other sentence becomes a NAV task
whose goal holds nowhere, with one object state: the unchanged house.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lcrl_bench.benchmarks.grammar import words_of
from lcrl_bench.benchmarks.placement import places_apart, supports_of
from lcrl_bench.benchmarks.proof import UNPROVED, StartTable, start_table
from lcrl_bench.benchmarks.targets import Target, find_targets
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.benchmarks.task_set import one_task
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.sentences import Meaning, parse_sentence
from lcrl_bench.houses.classes import task_objects
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.names import slug
from lcrl_bench.scenes.scene import Scene

LONGEST = 200
"""Maximum length of a sentence in characters."""
_DIRECTIONS = frozenset({"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"})
"""Bidirectional classes of Unicode's control characters for the direction of writing."""


@dataclass(frozen=True)
class AskedTask:
    """A task made from a sentence."""

    task: Task
    """The task, with the proof of its start; an `optimal_length` of -1 means that the goal can't be
    reached within the horizon, or is not known."""
    known: bool
    """Whether the true goal is known."""
    note: str
    """Why the goal is not known, or which of several objects is meant; may be empty."""


def clean_sentence(sentence: str) -> str:
    """A sentence with single spaces and without control characters.

    Raises:
        UsageError: If it is empty, too long, or contains control characters.
    """
    text = " ".join(sentence.split())
    example = 'Example: "move the cup to the bedroom".'
    if not text or len(text) > LONGEST:
        found = f"{len(text)}" if text else "none"
        raise UsageError(f"A sentence needs 1 to {LONGEST} characters, found {found}. {example}")
    bad = next((letter for letter in text if _is_control_character(letter)), None)
    if bad is not None:
        raise UsageError(f"A sentence can't contain control characters, found {bad!a}. {example}")
    return text


def _is_control_character(letter: str) -> bool:
    """Whether a character controls a terminal or the direction of writing, or is half of a pair.

    Joiners, which emoji and some scripts need, are not.
    """
    directs = unicodedata.bidirectional(letter) in _DIRECTIONS
    return directs or unicodedata.category(letter) in {"Cc", "Cs", "Zl", "Zp"}


def asked_task(
    scene: Scene,
    sentence: str,
    *,
    split: Split,
    tasks: Sequence[Task] = (),
    start: int | None = None,
) -> AskedTask:
    """Make a task from a sentence.

    Args:
        scene: The house.
        sentence: The agent's command, used verbatim except for spaces.
        split: The split of the house for the model.
        tasks: The house's own tasks; one with the same meaning provides its start and place B.
        start: Tile to start on, facing north; None means that of a task with the same meaning, else
            one from which the goal is neither near nor out of reach, else the middle of the house.

    Raises:
        UsageError: If the sentence is invalid, or `start` is not a tile of the house.
    """
    sentence = clean_sentence(sentence)
    if start is not None and not 0 <= start < scene.grid.tiles:
        raise UsageError(
            f"--start {start}: no such tile in {scene.house.id}; use 0 .. {scene.grid.tiles - 1}."
        )
    meaning = parse_sentence(sentence)
    same = next((task for task in tasks if _means(scene, task, meaning)), None)
    draft, note = (same, "") if same is not None else _draft(scene, meaning)
    named = replace(
        draft,
        id=f"{scene.house.id}.asked.{slug(sentence)}",
        split=split if same is None else same.split,
        command=sentence,
    )
    one = one_task(scene, named)
    starts = start_table(one, scene.semantics.success_reward)
    state = _start(scene, starts, same, start)
    known = bool(one.goal.any())
    task = replace(
        named,
        start_tile=state // HEADINGS,
        start_heading=state % HEADINGS,
        proof=starts.proof(state) if known else UNPROVED,
    )
    return AskedTask(task, known, note)


def _means(scene: Scene, task: Task, meaning: Meaning | None) -> bool:
    thing = None if task.moved is None else scene.house.object(task.moved).label
    return meaning == Meaning(task.kind, task.target, thing)


def _draft(scene: Scene, meaning: Meaning | None) -> tuple[Task, str]:
    """A task without start and proof, and a note on it."""
    open_end = Task("", Kind.NAV, Split.TRAIN, scene.house.id, "", "", 0, 0, UNPROVED)
    if meaning is None:
        reason = 'the sentence is neither "go to X" nor "move X to Y" with names of this suite'
        return open_end, reason
    target = find_targets(scene).get(meaning.target)
    if target is None:
        return open_end, f"no {words_of(meaning.target)} can be reached in {scene.house.id}"
    goal = replace(open_end, target=target.name)
    if meaning.thing is None:
        return goal, ""
    thing, placed, note = _moved(scene, meaning.thing, target)
    if placed is None:
        return open_end, note
    return replace(goal, kind=Kind.PICK, moved=thing, placement=placed), note


def _moved(scene: Scene, label: str, target: Target) -> tuple[str | None, PlacedObject | None, str]:
    """The object to move, its destination, and a note on them."""
    word, goal = words_of(label), words_of(target.name)
    if label not in task_objects():
        valid = ", ".join(map(words_of, sorted(task_objects())))
        return None, None, f"a {word} can't be moved; movable: {valid}"
    things = [thing for thing in scene.house.objects if thing.label == label]
    if not things:
        return None, None, f"{scene.house.id} has no {word}"
    for thing in things:
        # An object can't be moved to where it already is.
        instances = set(target.instances) - {thing.room, thing.support, thing.id}
        supports = supports_of(scene.house, instances, rooms=target.is_room)
        place = next(places_apart(scene, thing, supports), None)
        if place is not None:
            several = len(things) > 1 or len(target.instances) > 1
            where = place.room if target.is_room else f"the {goal} in {place.room}"
            meant = f"the {word} in {thing.room} and {where} are meant"
            return thing.id, place, f"of several, {meant}" if several else ""
    return None, None, f"there is no free place at the {goal} for a {word} from elsewhere"


def _start(scene: Scene, starts: StartTable, same: Task | None, tile: int | None) -> int:
    """The state to start in."""
    if tile is not None:
        return tile * HEADINGS
    if same is not None:
        return same.start_tile * HEADINGS + same.start_heading
    # The object starts at its original place.
    first = slice(0, scene.grid.tiles * HEADINGS)
    for chosen in (starts.admitted(scene.semantics), starts.steps > 0):
        states = np.flatnonzero(chosen[first])
        if len(states):
            order = np.argsort(starts.steps[states], kind="stable")
            return int(states[order[len(order) // 2]])
    points = scene.grid.points
    middle = np.linalg.norm(points - points.mean(axis=0), axis=1).argmin()
    return int(middle) * HEADINGS
