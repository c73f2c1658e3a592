"""`TaskStack`: tasks of several houses, padded to the same number of states.

A padding state leads to itself and is never reached. The agent's input is that of the paper's DQN:
position, orientation, and the state of the object. The object has three states, not just "held or
not": as episodes don't end, "still at A" and "already at B" would look alike.

Source: Fu et al. (2019), section "Experimental Procedure".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import HEADINGS, OBJECT_STATES, Action, TaskBatch

INPUTS = 3
"""Heading, object state, tile."""


@dataclass(frozen=True)
class TaskStack:
    """Tasks of any houses; agents interact with them through `step`."""

    next_state: torch.Tensor
    """int64 [task, state, action]; padding leads to itself."""
    start: torch.Tensor
    """int64 [task]."""
    inputs: torch.Tensor
    """int64 [task, state, 3]: active rows of a task's first layer in a state: headings first,
    object states next, tiles last, so that padding adds rows only at the end."""
    rows: int
    """Rows of the first layer: 4 + 3 + the largest number of tiles."""
    horizon: int
    """Steps after which an episode is truncated and restarts."""
    discount: float
    """gamma."""

    @classmethod
    def of(cls, batches: Sequence[TaskBatch]) -> TaskStack:
        """Stack batches in the given order.

        Raises:
            UsageError: If there is none, or they differ in horizon or discount.
        """
        if not batches:
            raise UsageError("There is no task to solve: choose at least one.")
        if len(terms := {(batch.horizon, batch.discount) for batch in batches}) > 1:
            raise UsageError(f"Tasks of one stack must share horizon and discount, found {terms}.")
        states = max(batch.states for batch in batches)
        inputs = [_inputs(batch) for batch in batches]
        return cls(
            next_state=torch.cat([_pad_table(batch.next_state, states) for batch in batches]),
            start=torch.cat([batch.start for batch in batches]),
            inputs=torch.cat([pad_states(rows, states) for rows in inputs]),
            rows=1 + max(int(rows.max()) for rows in inputs),
            horizon=batches[0].horizon,
            discount=batches[0].discount,
        )

    @property
    def tasks(self) -> int:
        """Number of tasks."""
        return self.next_state.shape[0]

    @property
    def states(self) -> int:
        """Number of states of each task, padding included."""
        return self.next_state.shape[1]

    def step(self, states: torch.Tensor, actions: torch.Tensor) -> torch.Tensor:
        """Next states: int64 [task, episode], int64 [task, episode] -> int64 [task, episode]."""
        task = torch.arange(self.tasks, device=states.device)[:, None]
        return self.next_state[task, states, actions]


def object_states(batch: TaskBatch) -> int:
    """Number of object states of these tasks: 1 where interaction does nothing, else 3.

    If the number of cells is not a multiple of three, it is 1 whatever interaction does.
    """
    here = torch.arange(batch.states, device=batch.next_state.device)
    idle = bool((batch.next_state[..., Action.INTERACT] == here).all())
    return 1 if idle or batch.cells % OBJECT_STATES else OBJECT_STATES


def pad_states(values: torch.Tensor, states: int) -> torch.Tensor:
    """Pad [task, state, ...] with zeros to `states` states."""
    padded = values.new_zeros(len(values), states, *values.shape[2:])
    padded[:, : values.shape[1]] = values
    return padded


def _pad_table(next_state: torch.Tensor, states: int) -> torch.Tensor:
    here = torch.arange(states, device=next_state.device)
    padded = here[None, :, None].repeat(len(next_state), 1, next_state.shape[2])
    padded[:, : next_state.shape[1]] = next_state
    return padded


def _inputs(batch: TaskBatch) -> torch.Tensor:
    """Active rows of the first layer in each state: int64 [task, state, 3]."""
    tiles = batch.cells // object_states(batch)
    state = torch.arange(batch.states, device=batch.next_state.device)
    cell, heading = state // HEADINGS, state % HEADINGS
    moved, tile = cell // tiles + HEADINGS, cell % tiles + HEADINGS + OBJECT_STATES
    return torch.stack([heading, moved, tile], -1).expand(len(batch), -1, -1)
