"""`TaskSet`: the tasks of one house and kind as stacked MDPs, with views and commands.

A method gets a copy without tasks, scene and, unless it is an oracle, goals; see
`methods.train_set`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.benchmarks.dynamics import nav_transitions, pick_goal, pick_transitions
from lcrl_bench.benchmarks.observation import cell_panoramas
from lcrl_bench.benchmarks.targets import goal_tiles
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.policy_outcome import follow
from lcrl_bench.mdp.success import uniform_policy
from lcrl_bench.mdp.task_batch import (
    HEADINGS,
    OBJECT_STATES,
    Action,
    ObjectState,
    TaskBatch,
)
from lcrl_bench.mdp.visitation import empirical_occupancy, occupancy, occupancy_mass
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.scene import Scene

CHUNK: Final = 16
"""Tasks solved at once: bounds memory at about 100 MB, whatever the house."""


@dataclass(frozen=True, eq=False)
class TaskSet(TaskBatch):
    """Tasks of one kind in one house; `len` is their number.

    Every field but `views` has one row per task. States are laid out as in `mdp.task_batch`.
    """

    views: Panoramas
    """All panoramas of the house, shared by its sets."""
    panoramas: torch.Tensor
    """int64 [task, cell]: index in `views` of the panorama seen in each cell."""
    commands: tuple[str, ...]
    """One sentence per task: `"move the cup to the bed"`."""
    held: torch.Tensor
    """bool [task, cell]: whether the object is in the agent's hand."""
    demonstrations: torch.Tensor = field(default_factory=lambda: torch.empty(0, 0, 0).long())
    """int64 [task, demonstration, horizon + 1]: states visited by the expert; empty if none were
    sampled."""
    expert: torch.Tensor | None = None
    """float [task, state, action]: the optimal action probabilities, uniform over equally short
    paths; only for a method that declares `expert = True`."""
    tasks: tuple[Task, ...] = ()
    """The tasks themselves; empty in what a method gets."""
    origin: Scene | None = field(default=None, repr=False)
    """The house in MuJoCo; None in what a method gets."""

    @property
    def scene(self) -> Scene:
        """The house in MuJoCo.

        Raises:
            UsageError: If this is what a method gets.
        """
        if self.origin is None:
            raise UsageError("A method is not told the scene: only views, commands and dynamics.")
        return self.origin

    @property
    def kind(self) -> Kind:
        """The kind of its tasks."""
        return self.tasks[0].kind

    @cached_property
    def object_states(self) -> int:
        """Number of object states: 1 for NAV, 3 for PICK."""
        return OBJECT_STATES if bool(self.held.any()) else 1

    @cached_property
    def tiles(self) -> int:
        """Number of tiles of the house."""
        return self.cells // self.object_states

    @cached_property
    def parts(self) -> tuple[TaskSet, ...]:
        """The set in parts of at most `CHUNK` tasks, small enough to be solved at once."""
        return self.split(CHUNK)

    def split(self, size: int) -> tuple[TaskSet, ...]:
        """The set in parts of at most `size` tasks."""
        if len(self) <= size:
            return (self,)
        starts = range(0, len(self), size)
        return tuple(self.rows(range(k, min(k + size, len(self)))) for k in starts)

    @cached_property
    def random_goal_value(self) -> torch.Tensor:
        """Return of uniformly random actions for a success reward of 1: float64 [task]."""
        return follow(self, uniform_policy(self, dtype=torch.float64)).goal_value

    @cached_property
    def occupancy_mass(self) -> float:
        """Total of an occupancy; divide by it to weigh tasks equally for any horizon."""
        return occupancy_mass(self.horizon, self.discount)

    @cached_property
    def demonstration_occupancy(self) -> torch.Tensor:
        """Discounted visits of the demonstrations, averaged over them: float32 [task, cell].

        Each row sums to `occupancy_mass`.
        """
        states = self.demonstrations
        return fold_cells(empirical_occupancy(self, states, discount=self.discount))

    def feature_expectations(self, features: torch.Tensor) -> torch.Tensor:
        """What the demonstrations see on average: float32 [task, feature].

        Args:
            features: float32 [panorama, feature], such as `views.class_shares()`.

        Source: Abbeel and Ng (2004), feature expectations, here a mean: divided by the total of
        the discounted visits.
        """
        visits = torch.zeros(len(self), len(self.views), device=features.device)
        visits.scatter_add_(1, self.panoramas, self.demonstration_occupancy)
        return visits @ features / self.occupancy_mass

    @cached_property
    def last_cells(self) -> torch.Tensor:
        """The cell each demonstration ends in: int64 [task, demonstration]."""
        return self.demonstrations[:, :, -1] // HEADINGS

    @cached_property
    def expert_occupancy(self) -> torch.Tensor | None:
        """Visits of the optimal policy: float [task, state], rows sum to 1.

        None if `expert` is None.
        """
        if self.expert is None:
            return None
        timed = self.expert[:, None].expand(-1, self.horizon, -1, -1)
        return occupancy(self, timed, discount=self.discount) / self.occupancy_mass

    @cached_property
    def object_tiles(self) -> torch.Tensor:
        """Tiles where PICK's object can be taken at A: bool [task, tile]; all False for NAV."""
        if self.object_states == 1:
            return torch.zeros_like(self.goal)
        return self._interactions[:, ObjectState.AT_A] == ObjectState.HELD

    @cached_property
    def target_tiles(self) -> torch.Tensor:
        """The goal of NAV, or the tiles where PICK's object can be put at B: bool [task, tile]."""
        if self.object_states == 1:
            return self.goal
        return self._interactions[:, ObjectState.HELD] == ObjectState.AT_B

    @cached_property
    def _interactions(self) -> torch.Tensor:
        """The object state after interacting: int64 [task, object state, tile]."""
        # Interacting does the same whatever the heading, so one heading tells.
        cells = self.next_state[:, ::HEADINGS, Action.INTERACT] // HEADINGS
        return (cells // self.tiles).view(len(self), OBJECT_STATES, self.tiles)

    def place(self, state: int) -> tuple[int, int, ObjectState]:
        """The tile, the heading and the object state of a state."""
        cell, heading = divmod(state, HEADINGS)
        object_state, tile = divmod(cell, self.tiles)
        return tile, heading, ObjectState(object_state)

    @property
    def task(self) -> Task:
        """The only task of a set of one."""
        (task,) = self.tasks
        return task

    def panorama(self, state: int) -> NDArray[np.uint8]:
        """The views N, E, S, W in a state of a set of one task: [4, height, width]."""
        return self.views.pixels(self._panorama_of_cell[state // HEADINGS])

    @cached_property
    def _panorama_of_cell(self) -> list[int]:
        return self.panoramas[0].tolist()


def stack_tasks(
    scene: Scene,
    tasks: Sequence[Task],
    views: Panoramas,
    arrangements: Sequence[Arrangement],
) -> tuple[TaskSet, ...]:
    """Stack the MDPs of a house's tasks: one set per kind, NAV then PICK.

    Args:
        scene: The house.
        tasks: Some tasks of it.
        views: What `scene.panoramas(arrangements)` returned.
        arrangements: At least those that the tasks can produce.
    """
    return tuple(_stack(scene, each, views, arrangements) for each in by_kind(tasks))


def by_kind(tasks: Sequence[Task]) -> list[tuple[Task, ...]]:
    """Tasks by kind, NAV then PICK, without kinds that have none."""
    groups = [tuple(task for task in tasks if task.kind == kind) for kind in Kind]
    return [each for each in groups if each]


def _stack(
    scene: Scene, tasks: tuple[Task, ...], views: Panoramas, arrangements: Sequence[Arrangement]
) -> TaskSet:
    moves = nav_transitions(scene.grid)
    tables = [_tables(scene, moves, task) for task in tasks]
    goal = torch.from_numpy(np.stack([goal for _, goal in tables]))
    held = torch.zeros_like(goal)
    if tasks[0].kind == Kind.PICK:
        held.view(len(tasks), OBJECT_STATES, -1)[:, ObjectState.HELD] = True
    return TaskSet(
        next_state=torch.from_numpy(np.stack([table for table, _ in tables])),
        goal=goal,
        start=torch.tensor([t.start_tile * HEADINGS + t.start_heading for t in tasks]),
        horizon=scene.semantics.horizon,
        discount=scene.semantics.discount,
        views=views,
        panoramas=torch.from_numpy(cell_panoramas(tasks, arrangements, scene.grid.tiles)),
        commands=tuple(task.command for task in tasks),
        held=held,
        tasks=tasks,
        origin=scene,
    )


def one_task(scene: Scene, task: Task) -> TaskBatch:
    """The MDP of one task, without views."""
    next_state, goal = _tables(scene, nav_transitions(scene.grid), task)
    return TaskBatch(
        next_state=torch.from_numpy(next_state)[None],
        goal=torch.from_numpy(goal)[None],
        start=torch.tensor([task.start_tile * HEADINGS + task.start_heading]),
        horizon=scene.semantics.horizon,
        discount=scene.semantics.discount,
    )


def _tables(
    scene: Scene, moves: NDArray[np.int64], task: Task
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """A task's transitions, int64 [state, action], and goal, bool [cell]."""
    if task.kind == Kind.NAV:
        return moves, goal_tiles(scene, task.target)
    moved, placement = task.carried()
    reach_a, reach_b = scene.reach(scene.house.object(moved)), scene.reach(placement)
    return pick_transitions(moves, reach_a, reach_b), pick_goal(scene.grid.tiles)
