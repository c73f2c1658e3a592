"""`VectorPictures`: the paths of sub-environments, and the frames that show them."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import TaskSets
from lcrl_bench.envs.frame import FramePainter
from lcrl_bench.envs.text_map import text_map


class VectorPictures:
    """Remembers the states of the episodes being played, and draws them."""

    def __init__(self, sets: TaskSets, environments: int, render_mode: str) -> None:
        """Start with no episodes.

        Args:
            sets: Loads a house.
            environments: Number of sub-environments.
            render_mode: `"rgb_array"` or `"ansi"`.
        """
        self._sets, self._text = sets, render_mode == "ansi"
        self._horizon = sets.benchmark.semantics.horizon
        self._paths: list[list[int]] = [[] for _ in range(environments)]
        self._shown: dict[int, TaskSet] = {}
        self._painters: dict[int, FramePainter] = {}

    def begin(self, number: int, state: int) -> None:
        """Start an episode of a sub-environment in a state."""
        self._paths[number] = [state]

    def extend(self, states: NDArray[np.int64], *, fresh: Collection[int]) -> None:
        """Add the current states, but for sub-environments whose episode just began.

        Args:
            states: int64 [sub-environment].
            fresh: Indices of these sub-environments.
        """
        for number, state in enumerate(states.tolist()):
            if number not in fresh:
                self._paths[number].append(state)

    def frame(self, number: int, task: Task) -> Any:  # noqa: ANN401 - as the render mode says
        """The frame of a sub-environment, as `HouseEnvironment.render` returns it."""
        shown = self._shown.get(number)
        if shown is None or shown.task.id != task.id:
            shown = self._shown[number] = self._sets.single(task)
        if self._text:
            return text_map(shown, self._paths[number], horizon=self._horizon)
        if number not in self._painters:
            self._painters[number] = FramePainter(horizon=self._horizon)
        return self._painters[number].paint(shown, self._paths[number])

    def clear(self) -> None:
        """Free drawings."""
        self._shown.clear()
        self._painters.clear()
