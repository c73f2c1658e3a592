"""`TaskBatch`: the tabular MDPs of several tasks of one house, stacked.

All tasks of a batch have the same number of states. A *cell* (a tile and an object state)
determines the observation; a *state* is a cell and a heading: `state = cell * 4 + heading` with
`cell = object_state * tiles + tile`. Dynamics are deterministic, so a transition is an index.

Rewards are functions of the observation, hence per cell. The return of a trajectory
s_0 .. s_H is sum_t gamma^t r(s_t), t = 0..H: the final state counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

import torch

HEADINGS = 4


class Action(IntEnum):
    """The four actions of the paper."""

    FORWARD = 0
    LEFT = 1
    RIGHT = 2
    INTERACT = 3


ACTIONS = len(Action)


@dataclass(frozen=True)
class TaskBatch:
    """Stacked deterministic finite-horizon MDPs."""

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

    @property
    def tasks(self) -> int:
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

    def to(self, device: torch.device | str) -> TaskBatch:
        """The same batch on another device."""
        return replace(
            self,
            next_state=self.next_state.to(device),
            goal=self.goal.to(device),
            start=self.start.to(device),
        )
