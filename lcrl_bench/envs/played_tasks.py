"""`PlayedTasks`: the tasks of an environment, ready to be played; recently used houses are kept.

Tables are memory views of a house's task sets: without copies, and several times faster to index
from Python than arrays.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import torch

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import house_task_sets, task_unknown
from lcrl_bench.envs.observation import Layout
from lcrl_bench.envs.setup import Setup, compute_alone_if_forked, facts_of


@dataclass(frozen=True, eq=False, slots=True)
class PlayedTask:
    """One task, ready to be played."""

    tasks: TaskSet
    """The set that contains it."""
    row: int
    """Its index there."""
    start: int
    """The state episodes start in."""
    next_state: Sequence[int]
    """[state * 4 + action]: where each action leads."""
    goal: Sequence[bool]
    """[cell]: whether the goal predicate holds."""
    reward: Sequence[float]
    """[cell]: the reward of arriving."""
    observe: Callable[[int], Any]
    """Maps a state to its observation."""
    facts: dict[str, Any]
    """What `info` says of the task; `success` is to be set, in a copy."""

    @classmethod
    def of(cls, setup: Setup, tasks: TaskSet, row: int, layout: Layout) -> PlayedTask:
        """Prepare a task of a set.

        Args:
            setup: What is shown and paid.
            tasks: The set.
            row: Index of the task.
            layout: Of the set.

        Raises:
            UsageError: If a learned reward is not finite.
        """
        return cls(
            tasks=tasks,
            row=row,
            start=int(tasks.start[row]),
            next_state=_look_up(tasks.next_state[row]),
            goal=_look_up(tasks.goal[row]),
            reward=setup.reward.table(tasks, row).data,
            observe=setup.observer.episode(tasks, row, layout),
            facts={"success": False, **facts_of(tasks.tasks[row])},
        )


@dataclass(eq=False)
class _House:
    sets: tuple[TaskSet, ...]
    layouts: tuple[Layout, ...] = field(init=False)
    ready: dict[str, PlayedTask] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.layouts = tuple(map(Layout.of, self.sets))

    def place(self, name: str) -> tuple[TaskSet, int, Layout] | None:
        """The set of a task, its row and the set's layout, by the task's id."""
        for tasks, layout in zip(self.sets, self.layouts, strict=True):
            for row, task in enumerate(tasks.tasks):
                if task.id == name:
                    return tasks, row, layout
        return None


class PlayedTasks:
    """The tasks of the houses in memory; `len` is the number of these houses."""

    def __init__(self, setup: Setup) -> None:
        """Start with no house in memory."""
        self._setup = setup
        self._houses: OrderedDict[str, _House] = OrderedDict()

    def of(self, task: Task) -> PlayedTask:
        """A task of the benchmark; its house is loaded if necessary.

        Raises:
            UsageError: If the task is not in the benchmark, or a learned reward is not finite.
        """
        house = self._house(task.house)
        played = house.ready.get(task.id)
        if played is None:
            compute_alone_if_forked()
            place = house.place(task.id)
            if place is None:
                raise task_unknown(self._setup.benchmark, task.id)
            played = house.ready[task.id] = PlayedTask.of(self._setup, *place)
        return played

    def clear(self) -> None:
        """Drop all houses."""
        self._houses.clear()

    def __len__(self) -> int:
        """Number of houses in memory."""
        return len(self._houses)

    def _house(self, name: str) -> _House:
        house = self._houses.get(name)
        if house is None:
            compute_alone_if_forked()
            setup = self._setup
            house = _House(house_task_sets(setup.benchmark, name, renderer=setup.renderer))
            self._houses[name] = house
            while len(self._houses) > setup.houses_kept:
                self._houses.popitem(last=False)
        self._houses.move_to_end(name)
        return house


def _look_up(tensor: torch.Tensor) -> Any:  # noqa: ANN401 - a memory view of any type of number
    """A tensor's numbers in a row: its own memory, which Python indexes faster than arrays."""
    return tensor.numpy().reshape(-1).data
