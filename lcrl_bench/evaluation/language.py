"""Language controls: the same learned thing, told something else.

What a task's command is replaced by:

    blank         no word at all
    shuffled      the command of another task, which shares no name with it
    wrong-target  the same sentence about another target of the same house
    paraphrase    a sentence of the same meaning, in a form that training never has

Success is always success at the task's own goal. So a method that uses language falls to chance
under the first two, and below its own figure under the third: not to zero, as the way to a wrong
target may lead past the right one. Under the last it should not fall.

Every choice depends on the benchmark alone, so all methods are told the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

from lcrl_bench.benchmarks.grammar import nav_command, pick_command, words_of
from lcrl_bench.benchmarks.paraphrases import paraphrase
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.benchmarks.task_set import TaskSet, by_house
from lcrl_bench.evaluation.harness import Sentences
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.storage import sha256_of


class Control(StrEnum):
    """What a method is told in place of the command."""

    BLANK = "blank"
    SHUFFLED = "shuffled"
    WRONG_TARGET = "wrong-target"
    PARAPHRASE = "paraphrase"


def language_controls(sets: Sequence[TaskSet]) -> dict[str, Sentences]:
    """The sentences of each control, for `evaluate_each`.

    A task for which a control has no sentence is left out of it: a house may name one target only.
    """
    shuffled = shuffled_commands([task for tasks in sets for task in tasks.tasks])
    wrong = {
        key: command
        for house in by_house(sets)
        for key, command in wrong_target_commands(house).items()
    }
    return {
        Control.BLANK.value: lambda task: "",
        Control.SHUFFLED.value: lambda task: shuffled.get(task.id),
        Control.WRONG_TARGET.value: lambda task: wrong.get(task.id),
        Control.PARAPHRASE.value: paraphrase,
    }


def shuffled_commands(tasks: Sequence[Task]) -> dict[str, str]:
    """For each task the command of another of its split and kind, which shares no name with it.

    Returns:
        Task id -> command; without the tasks for which there is no other.
    """
    groups: dict[tuple[str, str], list[Task]] = {}
    for task in sorted(tasks, key=lambda task: _lot("shuffled", task.id)):
        groups.setdefault((task.split, task.kind), []).append(task)
    found = {}
    for group in groups.values():
        for place, task in enumerate(group):
            others = (*group[place + 1 :], *group[:place])
            command = next((o.command for o in others if not names_of(o) & names_of(task)), None)
            if command is not None:
                found[task.id] = command
    return found


def wrong_target_commands(house: Sequence[TaskSet]) -> dict[str, str]:
    """For each task of a house, given its task sets, its own sentence about another target there.

    The other target is one that some task of the house names, drawn by lot; for PICK one to which
    something is moved, if there is such. A NAV target is other if nowhere both goals hold; a PICK
    target if the object is at it neither where it is found nor where it belongs.

    Returns:
        Task id -> command; without the tasks for which there is no other target.
    """
    return {
        task.id: _with_target(task, min(others, key=lambda name: _lot(task.id, name)))
        for tasks in house
        for row, task in enumerate(tasks.tasks)
        if (others := _other_targets(house, tasks, row))
    }


def names_of(task: Task) -> frozenset[str]:
    """The names in a task's command: its target, and what it moves."""
    moved = () if task.placement is None else (task.placement.label,)
    return frozenset((task.target, *moved))


def _other_targets(sets: Sequence[TaskSet], tasks: TaskSet, row: int) -> set[str]:
    task, goals = tasks.tasks[row], tasks.goal
    if task.kind == Kind.NAV:
        apart = ~(goals & goals[row]).any(1)
        return {other.target for other, ok in zip(tasks.tasks, apart.tolist(), strict=True) if ok}
    moved, placed = task.carried()
    house = tasks.scene.house
    taken = {task.target, *_fulfilled(house, house.object(moved)), *_fulfilled(house, placed)}
    every = {other.target for each in sets for other in each.tasks}
    return {other.target for other in tasks.tasks} - taken or every - taken


def _fulfilled(house: House, thing: PlacedObject) -> set[str]:
    """Every target that an object is at: its room, and all that it stands on."""
    names = {house.room(thing.room).type.value}
    below = thing.support
    while below is not None:
        support = house.object(below)
        names.add(support.label)
        below = support.support
    return names


def _with_target(task: Task, target: str) -> str:
    """The sentence of a task, about another target."""
    if task.kind == Kind.NAV:
        return nav_command(words_of(target))
    return pick_command(words_of(task.carried()[1].label), words_of(target))


def _lot(*words: str) -> str:
    """A number as good as drawn, and the same everywhere: what sorts first is chosen."""
    return sha256_of(":".join(words).encode())
