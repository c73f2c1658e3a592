"""Language controls: the same model with other commands.

The replacements of a task's command:

    blank         no words
    shuffled      the command of another task, without any name in common
    wrong-target  the same sentence with another target in the same house
    paraphrase    a sentence of the same meaning, in a form that doesn't occur in training

Success always means the task's own goal. So a method that uses language drops to chance with the
first two, and below its own success with the third: not to zero, as the path to a wrong target may
pass the right one. With the last it should not drop.

All choices depend only on the benchmark, so all methods get the same commands.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

from lcrl_bench.benchmarks.grammar import nav_command, pick_command, words_of
from lcrl_bench.benchmarks.house_sets import by_house, tasks_of
from lcrl_bench.benchmarks.paraphrases import paraphrase
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.harness import Sentences
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.storage import sha256_of


class Control(StrEnum):
    """What replaces the command."""

    BLANK = "blank"
    SHUFFLED = "shuffled"
    WRONG_TARGET = "wrong-target"
    PARAPHRASE = "paraphrase"


def language_controls(sets: Sequence[TaskSet]) -> dict[str, Sentences]:
    """The commands of each control, for `evaluate_each`.

    Tasks without a command for a control are left out: a house may have only one target.
    """
    shuffled = shuffled_commands(tasks_of(sets))
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
    """For each task, the command of another one of its split and kind, without a name in common.

    Returns:
        Task id -> command, without the tasks for which there is none.
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
    """For each task of a house, given its task sets, its sentence with another target.

    The other target is drawn from those of the house's tasks; for PICK from those of PICK tasks, if
    there are any. A NAV target counts as another if no state fulfils both goals; a PICK target if
    the object is at it neither at its original place nor at its destination.

    Returns:
        Task id -> command, without the tasks for which there is no other target.
    """
    return {
        task.id: _with_target(task, min(others, key=lambda name: _lot(task.id, name)))
        for tasks in house
        for row, task in enumerate(tasks.tasks)
        if (others := _other_targets(house, tasks, row))
    }


def names_of(task: Task) -> frozenset[str]:
    """The names in a task's command: its target and the object moved."""
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
    """All targets that an object is at: its room, and everything it stands on."""
    names = {house.room(thing.room).type.value}
    below = thing.support
    while below is not None:
        support = house.object(below)
        names.add(support.label)
        below = support.support
    return names


def _with_target(task: Task, target: str) -> str:
    """The sentence of a task, with another target."""
    if task.kind == Kind.NAV:
        return nav_command(words_of(target))
    return pick_command(words_of(task.carried()[1].label), words_of(target))


def _lot(*words: str) -> str:
    """A pseudo-random sort key, the same everywhere; the smallest is chosen."""
    return sha256_of(":".join(words).encode())
