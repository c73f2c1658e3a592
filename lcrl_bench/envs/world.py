"""`World`: one task of a house as the arrays an environment steps through.

Houses are compiled when one of their tasks is first played and a few are kept: a benchmark of a
hundred houses opens at once and stays small in memory.
"""

from __future__ import annotations

import difflib
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.compiled import CompiledHouse, CompiledTasks, compile_house
from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import HEADINGS, Action


@dataclass(frozen=True, eq=False)
class World:
    """A task of a compiled house; states are laid out as in `mdp.task_batch`."""

    compiled: CompiledHouse
    tasks: CompiledTasks
    """The compiled set the task is of."""
    row: int
    """Its place in the set."""

    @property
    def task(self) -> Task:
        """The task."""
        return self.tasks.tasks[self.row]

    @property
    def tiles(self) -> int:
        """Number of tiles of the house."""
        return self.compiled.grid.tiles

    @property
    def start(self) -> int:
        """The state an episode starts in."""
        return int(self.tasks.batch.start[self.row])

    @cached_property
    def next_state(self) -> NDArray[np.int64]:
        """[state, action]: where each action leads."""
        return self.tasks.batch.next_state[self.row].numpy()

    @cached_property
    def goal(self) -> NDArray[np.bool_]:
        """[cell]: where the goal predicate holds."""
        return self.tasks.batch.goal[self.row].numpy()

    @cached_property
    def panoramas(self) -> NDArray[np.int64]:
        """[cell]: the panorama seen in each cell."""
        return self.tasks.panoramas[self.row].numpy()

    def parts(self, state: int) -> tuple[int, int, ObjectState]:
        """The tile, the heading and the object state of a state."""
        cell, heading = divmod(state, HEADINGS)
        held, tile = divmod(cell, self.tiles)
        return tile, heading, ObjectState(held)

    def panorama(self, state: int) -> NDArray[np.uint8]:
        """What is seen in a state: a copy, uint8 [4, row, column] class ids, views N, E, S, W."""
        store = self.compiled.store
        return store.views[store.panorama_views[self.panoramas[state // HEADINGS]]]

    def take_tiles(self) -> NDArray[np.bool_]:
        """[tile]: where the object of PICK can be taken at its place A; nowhere for NAV."""
        if self.task.kind == Kind.NAV:
            return np.zeros(self.tiles, bool)
        return self._interactions()[ObjectState.AT_A] == ObjectState.HELD

    def goal_tiles(self) -> NDArray[np.bool_]:
        """[tile]: the goal of NAV; for PICK, where the object can be put at its place B."""
        if self.task.kind == Kind.NAV:
            return self.goal
        return self._interactions()[ObjectState.HELD] == ObjectState.AT_B

    def _interactions(self) -> NDArray[np.int64]:
        """PICK: the object state that interacting leads to, [object state, tile]."""
        led_to = self.next_state[::HEADINGS, Action.INTERACT] // HEADINGS // self.tiles
        return led_to.reshape(len(ObjectState), self.tiles)


class Worlds:
    """The worlds of a benchmark's tasks, compiled house by house on demand."""

    def __init__(self, benchmark: Benchmark, *, renderer: str, houses_kept: int) -> None:
        """Compile nothing yet.

        Args:
            benchmark: The benchmark.
            renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.
            houses_kept: How many compiled houses stay in memory: those used last.
        """
        self._benchmark = benchmark
        self._renderer = renderer
        self._kept = houses_kept
        self._houses: OrderedDict[str, CompiledHouse] = OrderedDict()

    def of(self, task: Task) -> World:
        """The world of a task of the benchmark."""
        compiled = self._house(task.house)
        (tasks,) = (each for each in compiled.sets if each.tasks[0].kind == task.kind)
        ids = [each.id for each in tasks.tasks]
        return World(compiled, tasks, ids.index(task.id))

    def clear(self) -> None:
        """Let go of all compiled houses."""
        self._houses.clear()

    def __len__(self) -> int:
        """How many houses are in memory."""
        return len(self._houses)

    def _house(self, name: str) -> CompiledHouse:
        compiled = self._houses.pop(name, None)
        if compiled is None:
            compiled = compile_house(self._benchmark, name, renderer=self._renderer)
        self._houses[name] = compiled
        while len(self._houses) > self._kept:
            self._houses.popitem(last=False)
        return compiled


def task_named(benchmark: Benchmark, name: str) -> Task:
    """The task of a benchmark with an id.

    Raises:
        UsageError: If there is none; suggests the nearest.
    """
    found = next((task for task in benchmark.tasks if task.id == name), None)
    if found is not None:
        return found
    near = difflib.get_close_matches(name, [task.id for task in benchmark.tasks], n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    # A benchmark has a thousand tasks: too many to list.
    raise UsageError(f"{benchmark.name} has no task '{name}'.{hint} Its tasks.json lists all.")
