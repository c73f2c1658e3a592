"""Whether a task can be told from what is seen: its target, and its object at both places."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.houses.classes import class_id
from lcrl_bench.mdp.task_batch import ObjectState

MIN_PIXELS = 2
"""Pixels of a class a panorama must show for the class to count as seen in it."""


def visibility_failures(tasks: TaskSet) -> list[list[str]]:
    """Why each task can't be told from what is seen; empty where it can."""
    seen = (tasks.views.class_counts() >= MIN_PIXELS).numpy()
    return [_failures(tasks, row, seen) for row in range(len(tasks))]


def _failures(tasks: TaskSet, row: int, seen: NDArray[np.bool_]) -> list[str]:
    """As `visibility_failures`, of one task; `seen` is bool [panorama, class]."""
    task = tasks.tasks[row]
    panoramas = tasks.panoramas[row].numpy().reshape(-1, tasks.tiles)
    found = []
    if task.target_room is None:
        tiles = seen[panoramas[ObjectState.AT_A], class_id(task.target)]
        at_goal = tasks.goal[row].numpy() if task.kind == Kind.NAV else True
        if not (tiles & at_goal).any():
            found.append(f"no tile shows the {task.target} it names")
    if task.kind == Kind.PICK:
        moved, placement = task.carried()
        thing = tasks.scene.house.object(moved)
        for state, place in ((ObjectState.AT_A, thing), (ObjectState.AT_B, placement)):
            near = tasks.scene.reach(place)
            if not (seen[panoramas[state], class_id(thing.label)] & near).any():
                found.append(f"the {thing.label} {state.name} is seen from no tile in reach of it")
    return found
