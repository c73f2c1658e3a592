"""`TaskBatch`: the tabular MDPs of several tasks of one house, stacked.

All tasks of a batch have the same number of states. A *cell* (a tile and an object state)
determines the observation; a *state* is a cell and a heading: `state = cell * 4 + heading` with
`cell = object_state * tiles + tile`. Dynamics are deterministic, so a transition is an index.

Rewards are functions of the observation, hence per cell. The return of a trajectory
s_0 .. s_H is sum_t gamma^t r(s_t), t = 0..H: the final state counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import Any, Self

import torch

HEADINGS = 4


class Action(IntEnum):
    """The four actions of the paper."""

    FORWARD = 0
    LEFT = 1
    RIGHT = 2
    INTERACT = 3


ACTIONS = len(Action)


class ObjectState(IntEnum):
    """Where the object of a PICK task is; a NAV task has the first state only."""

    AT_A = 0
    """At its place in the house."""
    HELD = 1
    """In the agent's hand, seen nowhere."""
    AT_B = 2
    """Where the command wants it."""


OBJECT_STATES = len(ObjectState)


@dataclass(frozen=True, eq=False)
class TaskBatch:
    """Stacked deterministic finite-horizon MDPs; `len` is the number of tasks."""

    next_state: torch.Tensor
    """int64 [task, state, action]: where each action leads."""
    goal: torch.Tensor
    """bool [task, cell]: where the goal predicate holds."""
    start: torch.Tensor
    """int64 [task]: the state each episode starts in."""
    horizon: int
    """H: number of actions in an episode; there are H + 1 states."""
    discount: float
    """gamma, of planning and of occupancies."""

    def __len__(self) -> int:
        """Number of tasks."""
        return self.next_state.shape[0]

    @property
    def states(self) -> int:
        """Number of states of each task."""
        return self.next_state.shape[1]

    @property
    def cells(self) -> int:
        """Number of cells of each task: states / 4."""
        return self.states // HEADINGS

    def to(self, device: torch.device | str) -> Self:
        """The same tasks on another device."""
        tensors = {each.name: getattr(self, each.name) for each in fields(self)}
        moved = {k: v.to(device) for k, v in tensors.items() if isinstance(v, torch.Tensor)}
        return replace(self, **moved)

    def rows(self, chosen: Sequence[int]) -> Self:
        """Some of the tasks, by index, as a stack of their own.

        Whatever a field holds per task is selected: tensors and tuples of as many rows.
        """
        index = torch.tensor(chosen, dtype=torch.int64, device=self.next_state.device)
        kept: dict[str, Any] = {}
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, torch.Tensor) and len(value):
                kept[each.name] = value[index]
            elif isinstance(value, tuple) and value:
                kept[each.name] = tuple(value[row] for row in chosen)
        return replace(self, **kept)
