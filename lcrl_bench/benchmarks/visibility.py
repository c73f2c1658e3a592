"""Visibility checks of tasks: the target must be visible, and the object at both places."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.houses.classes import class_id
from lcrl_bench.mdp.task_batch import ObjectState

MIN_PIXELS = 2
"""Minimum number of pixels of a class for it to count as visible in a panorama."""


def visibility_failures(tasks: TaskSet) -> list[list[str]]:
    """The visibility failures of each task; empty if it passes."""
    seen = (tasks.views.class_counts() >= MIN_PIXELS).numpy()
    return [_failures(tasks, row, seen) for row in range(len(tasks))]


def _failures(tasks: TaskSet, row: int, seen: NDArray[np.bool_]) -> list[str]:
    """Like `visibility_failures`, for one task; `seen` is bool [panorama, class]."""
    task = tasks.tasks[row]
    panoramas = tasks.panoramas[row].numpy().reshape(-1, tasks.tiles)
    found = []
    if task.target_room is None:
        tiles = seen[panoramas[ObjectState.AT_A], class_id(task.target)]
        at_goal = tasks.goal[row].numpy() if task.kind == Kind.NAV else True
        if not (tiles & at_goal).any():
            found.append(f"its target, the {task.target}, is visible from no tile")
    if task.kind == Kind.PICK:
        moved, placement = task.carried()
        thing = tasks.scene.house.object(moved)
        for state, place in ((ObjectState.AT_A, thing), (ObjectState.AT_B, placement)):
            near = tasks.scene.reach(place)
            if not (seen[panoramas[state], class_id(thing.label)] & near).any():
                found.append(f"the {thing.label} {state.name} is visible from no tile within reach")
    return found
