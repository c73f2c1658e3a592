"""A house of a benchmark, compiled: views, grid and tasks as stacked tabular MDPs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.dynamics import (
    OBJECT_STATES,
    ObjectState,
    nav_transitions,
    pick_goal,
    pick_transitions,
)
from lcrl_bench.benchmarks.observation import (
    arrangements_of,
    cell_panoramas,
    house_views,
    resize_views,
)
from lcrl_bench.benchmarks.targets import goal_tiles
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.houses.house import House
from lcrl_bench.mdp.policy_outcome import follow
from lcrl_bench.mdp.success import uniform_policy
from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.reach import within_reach
from lcrl_bench.scenes.store import ViewStore
from lcrl_bench.semantics import Semantics


@dataclass(frozen=True, eq=False)
class CompiledTasks:
    """The tasks of one kind in one house."""

    tasks: tuple[Task, ...]
    batch: TaskBatch
    panoramas: torch.Tensor
    """int64 [task, cell]: the panorama seen in each cell."""

    @property
    def held(self) -> torch.Tensor:
        """Where the object is in the agent's hand: bool [task, cell]."""
        held = torch.zeros_like(self.batch.goal)
        if self.tasks[0].kind == Kind.PICK:
            held.view(len(self.tasks), OBJECT_STATES, -1)[:, ObjectState.HELD] = True
        return held

    @cached_property
    def random_goal_value(self) -> torch.Tensor:
        """What uniformly random actions return for a success reward of 1: float64 [task]."""
        policy = uniform_policy(self.batch, dtype=torch.float64)
        return follow(self.batch, policy).goal_value

    def rows(self, chosen: Sequence[int]) -> CompiledTasks:
        """Some of the tasks, by index, as a set of their own."""
        index = torch.tensor(chosen, dtype=torch.int64, device=self.panoramas.device)
        batch = replace(
            self.batch,
            next_state=self.batch.next_state[index],
            goal=self.batch.goal[index],
            start=self.batch.start[index],
        )
        tasks = tuple(self.tasks[row] for row in chosen)
        return CompiledTasks(tasks, batch, self.panoramas[index])


@dataclass(frozen=True, eq=False)
class CompiledHouse:
    """A house and its tasks, ready to be solved."""

    house: House
    grid: Grid
    arrangements: tuple[Arrangement, ...]
    store: ViewStore
    sets: tuple[CompiledTasks, ...]
    """One a kind that has tasks: NAV, PICK."""


def compile_house(
    benchmark: Benchmark,
    house_id: str,
    tasks: Sequence[Task] | None = None,
    *,
    renderer: str = "auto",
    image_size: tuple[int, int] | None = None,
) -> CompiledHouse:
    """Compile a house of a benchmark.

    Args:
        benchmark: Where the house and its grid are.
        house_id: Which house.
        tasks: Which of its tasks; None means all. The views always cover all, so that they are
            rendered once whatever is asked for.
        renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.
        image_size: Width and height of the views in pixels; None means the benchmark's own, which
            alone are frozen with it.

    Raises:
        UsageError: If there can be no views of that size.
    """
    house, grid = benchmark.houses[house_id], benchmark.grids[house_id]
    every = benchmark.select(house=house_id)
    arrangements = arrangements_of(every)
    optics = resize_views(benchmark.semantics, image_size)
    store = house_views(
        house,
        grid,
        arrangements,
        optics,
        renderer=renderer,
        frozen=benchmark.views.get(house_id) if optics == benchmark.semantics else None,
    )
    chosen = every if tasks is None else tuple(tasks)
    sets = []
    for kind in Kind:
        of_kind = tuple(task for task in chosen if task.kind == kind)
        if of_kind:
            batch = task_batch(house, grid, of_kind, benchmark.semantics)
            panoramas = torch.from_numpy(cell_panoramas(of_kind, arrangements, grid.tiles))
            sets.append(CompiledTasks(of_kind, batch, panoramas))
    return CompiledHouse(house, grid, arrangements, store, tuple(sets))


def task_batch(house: House, grid: Grid, tasks: Sequence[Task], semantics: Semantics) -> TaskBatch:
    """Stack the MDPs of tasks of one kind in one house."""
    moves = nav_transitions(grid)
    tables = [task_tables(house, grid, moves, task, semantics) for task in tasks]
    return TaskBatch(
        next_state=torch.from_numpy(np.stack([table for table, _ in tables])),
        goal=torch.from_numpy(np.stack([goal for _, goal in tables])),
        start=torch.tensor([t.start_tile * HEADINGS + t.start_heading for t in tasks]),
        horizon=semantics.horizon,
        discount=semantics.discount,
    )


def task_tables(
    house: House, grid: Grid, moves: NDArray[np.int64], task: Task, semantics: Semantics
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """A task's transitions and goal.

    Returns:
        int64 [state, action] and bool [cell].
    """
    if task.kind == Kind.NAV:
        return moves, goal_tiles(house, grid, task.target, semantics)
    moved, placement = task.carried()
    reach_a = within_reach(house, grid, house.object(moved), semantics)
    reach_b = within_reach(house, grid, placement, semantics)
    return pick_transitions(moves, reach_a, reach_b), pick_goal(grid.tiles)
