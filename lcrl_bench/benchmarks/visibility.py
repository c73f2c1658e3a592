"""Whether a task can be told from what is seen: its target, and its object at both places."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.compiled import CompiledHouse, CompiledTasks
from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.benchmarks.observation import class_pixels
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.scenes.reach import within_reach
from lcrl_bench.semantics import Semantics

MIN_PIXELS = 2
"""Pixels of a class a panorama must show for the class to count as seen in it."""


@dataclass(frozen=True, eq=False)
class Visibility:
    """What each panorama of a compiled house shows."""

    compiled: CompiledHouse
    seen: dict[str, NDArray[np.bool_]]
    """Class name → bool [panorama]."""

    @classmethod
    def of(cls, compiled: CompiledHouse) -> Visibility:
        """Count the pixels of every class once."""
        seen = {name: pixels >= MIN_PIXELS for name, pixels in class_pixels(compiled.store)}
        return cls(compiled, seen)

    def failures(self, tasks: CompiledTasks, row: int, semantics: Semantics) -> list[str]:
        """Why a task can't be told from what is seen; empty if it can."""
        task = tasks.tasks[row]
        panoramas = tasks.panoramas[row].numpy().reshape(-1, self.compiled.grid.tiles)
        found = []
        if task.target_room is None:
            tiles = self.seen[task.target][panoramas[ObjectState.AT_A]]
            at_goal = tasks.batch.goal[row].numpy() if task.kind == Kind.NAV else True
            if not (tiles & at_goal).any():
                found.append(f"no tile shows the {task.target} it names")
        if task.kind == Kind.PICK:
            found += self._object_failures(task, panoramas, semantics)
        return found

    def _object_failures(
        self, task: Task, panoramas: NDArray[np.int64], semantics: Semantics
    ) -> list[str]:
        moved, placement = task.carried()
        house, grid = self.compiled.house, self.compiled.grid
        thing = house.object(moved)
        places = {ObjectState.AT_A: thing, ObjectState.AT_B: placement}
        found = []
        for state, place in places.items():
            near = within_reach(house, grid, place, semantics)
            if not (self.seen[thing.label][panoramas[state]] & near).any():
                found.append(f"the {thing.label} {state.name} is seen from no tile in reach of it")
        return found
