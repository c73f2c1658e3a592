"""`TablePool`: the tables of many tasks end to end, so that one gather steps them all.

A *position* is a row of these tables: the first position of a task plus its state. As a task has
four states per cell, `position // 4` is the row of its cell. A set of tasks (a kind in a house) is
appended when one of its tasks is first played, and shared by all sub-environments.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import TaskSets
from lcrl_bench.envs.reward_table import RewardTable
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS, ObjectState


class Column:
    """Rows of one array, with room for more."""

    def __init__(self, dtype: DTypeLike, *shape: int) -> None:
        """Start without rows; `shape` is that of a row."""
        self.rows: NDArray[Any] = np.empty((0, *shape), dtype)
        self.size = 0

    def append(self, rows: NDArray[Any]) -> None:
        """Add rows; the array grows by half, so that appending all costs as much as copying it."""
        size = self.size + len(rows)
        if size > len(self.rows):
            room = np.empty((max(size, len(self.rows) * 3 // 2), *rows.shape[1:]), self.rows.dtype)
            room[: self.size] = self.rows[: self.size]
            self.rows = room
        self.rows[self.size : size] = rows
        self.size = size


@dataclass(eq=False)
class Segment:
    """Where a set of tasks is in the tables."""

    tasks: tuple[Task, ...]
    starts: list[int]
    """The position each task's episodes start in, counted from `first`."""
    states: int
    """Number of states of each task."""
    first: int
    """Position of the first task's first state."""
    first_view: int
    views: int
    """Number of distinct views."""

    @property
    def size(self) -> int:
        """Number of positions."""
        return self.states * len(self.tasks)


class TablePool:
    """Tables of the tasks played, by position, cell and view."""

    def __init__(
        self, sets: TaskSets, reward: RewardTable, selection: Iterable[Task], *, houses_kept: int
    ) -> None:
        """Start with empty tables.

        Args:
            sets: Loads a house.
            reward: The reward to pay.
            selection: Tasks that are drawn from: when their house is loaded, so are all tasks of
                their kinds.
            houses_kept: Houses kept, apart from those that are being played.
        """
        semantics = sets.benchmark.semantics
        self._shape = (semantics.view_height, semantics.view_width)
        self._sets, self._reward, self._kept = sets, reward, houses_kept
        self._wanted = {(task.house, task.kind) for task in selection}
        self._houses: OrderedDict[str, list[Segment]] = OrderedDict()
        self._segment: dict[str, tuple[Segment, int]] = {}
        self.compactions = 0
        """How often houses were dropped; positions are invalid from then on."""
        self._allocate()

    def _allocate(self) -> None:
        self.next_state = Column(np.int32)
        """[position * 4 + action]: the position an action leads to."""
        self.cell_views = Column(np.int32, HEADINGS)
        """[cell, 4]: rows of `views` to the north, east, south and west."""
        self.reward = Column(np.float64)
        """[cell]: reward of arriving."""
        self.goal = Column(np.bool_)
        """[cell]: whether the goal predicate holds."""
        self.object_state = Column(np.int64)
        """[cell]: 0, 1 or 2, where the object is."""
        self.held = Column(np.int64)
        """[cell]: 1 where the object is held."""
        self.tile = Column(np.int64)
        """[cell]: where the agent is."""
        self.first_state = Column(np.int64)
        """[cell]: position of the first state of its task."""
        self.views = Column(np.uint8, *self._shape)
        """[view, height, width]: class ids."""

    def find(self, task: Task, playing: Callable[[], Collection[str]]) -> tuple[Segment, int]:
        """Where a task is, and its row there; its house is loaded if necessary.

        Args:
            task: A task of the benchmark.
            playing: Returns the ids of houses that must stay. If others are dropped, all positions
                change, and `compactions` counts up.

        Raises:
            UsageError: If a learned reward is not finite.
        """
        found = self._segment.get(task.id)
        if found is None:
            self._load(task, playing)
            found = self._segment[task.id]
        self._houses.move_to_end(task.house)
        return found

    def clear(self) -> None:
        """Drop everything."""
        self._houses.clear()
        self._segment.clear()
        self._sets.clear()
        self.compactions += 1
        self._allocate()

    def __len__(self) -> int:
        """Number of houses in memory."""
        return len(self._houses)

    def _load(self, task: Task, playing: Callable[[], Collection[str]]) -> None:
        """Append the wanted sets of a task's house that are not there yet."""
        if task.house not in self._houses and len(self) >= self._kept:
            self._drop_some(playing())
        there = {segment.tasks[0].kind for segment in self._houses.get(task.house, ())}
        new = [
            (tasks, self._rewards_of(tasks))
            for tasks in self._sets.house(task.house)
            if tasks.kind not in there
            and (tasks.kind == task.kind or (task.house, tasks.kind) in self._wanted)
        ]
        segments = self._houses.setdefault(task.house, [])
        for tasks, rewards in new:
            segments.append(self._append(tasks, rewards))
        for segment in segments:
            for row, each in enumerate(segment.tasks):
                self._segment[each.id] = (segment, row)

    def _rewards_of(self, tasks: TaskSet) -> NDArray[np.float64]:
        return np.concatenate([self._reward.table(tasks, row) for row in range(len(tasks))])

    def _append(self, tasks: TaskSet, rewards: NDArray[np.float64]) -> Segment:
        count, states, cells = len(tasks), tasks.states, tasks.cells
        first, first_view = self.next_state.size // ACTIONS, self.views.size
        firsts = first + states * np.arange(count)
        self.next_state.append((tasks.next_state.numpy() + firsts[:, None, None]).reshape(-1))
        # NAV sees a part of the house's views: those without the moved objects.
        sides = tasks.views.panorama_views.numpy()[tasks.panoramas.numpy()]
        used, numbers = np.unique(sides, return_inverse=True)
        self.views.append(tasks.views.views.numpy()[used])
        self.cell_views.append(numbers.reshape(-1, HEADINGS) + first_view)
        self.reward.append(rewards)
        self.goal.append(tasks.goal.numpy().reshape(-1))
        object_state, tile = np.divmod(np.arange(cells), tasks.tiles)
        self.object_state.append(np.tile(object_state, count))
        self.held.append(np.tile(object_state == ObjectState.HELD, count))
        self.tile.append(np.tile(tile, count))
        self.first_state.append(np.repeat(firsts, cells))
        starts = (tasks.start.numpy() + firsts - first).tolist()
        return Segment(tasks.tasks, starts, states, first, first_view, len(used))

    def _drop_some(self, playing: Collection[str]) -> None:
        """Drop the quarter of the houses that was played longest ago, in one go.

        One at a time, everything that is kept would be moved for each house loaded.
        """
        idle = [house for house in self._houses if house not in playing]
        dropped = idle[: max(len(self) - self._kept + 1, self._kept // 4)]
        if not dropped:
            return
        for house in dropped:
            for segment in self._houses.pop(house):
                for task in segment.tasks:
                    del self._segment[task.id]
        self._compact()

    def _compact(self) -> None:
        """Move the tables of the houses that are left together."""
        old = dict(self._columns())
        self._allocate()
        for segment in (each for house in self._houses.values() for each in house):
            first, first_view = self.next_state.size // ACTIONS, self.views.size
            shift = {
                "next_state": first - segment.first,
                "first_state": first - segment.first,
                "cell_views": first_view - segment.first_view,
            }
            for name, column in self._columns():
                begin, size = _extent(name, segment)
                rows = old[name].rows[begin : begin + size]
                column.append(rows + shift[name] if name in shift else rows)
            segment.first, segment.first_view = first, first_view
        self.compactions += 1

    def _columns(self) -> Iterator[tuple[str, Column]]:
        return ((k, each) for k, each in vars(self).items() if isinstance(each, Column))


def _extent(name: str, segment: Segment) -> tuple[int, int]:
    """The first row of a segment in a column, and the number of its rows."""
    if name == "views":
        return segment.first_view, segment.views
    if name == "next_state":
        return segment.first * ACTIONS, segment.size * ACTIONS
    return segment.first // HEADINGS, segment.size // HEADINGS
