"""Exact success probabilities of a policy, and shortest paths to the goal.

*Success* is the paper's: the goal predicate holds at some step t <= H. *Final success* requires it
at the last step, so merely passing through the goal does not count. The random policy is the chance
level of both.
"""

from __future__ import annotations

from functools import reduce

import torch

from lcrl_bench.mdp.dynamics import (
    advance,
    check_policy,
    flat_successors,
    spread_cells,
    start_mass,
)
from lcrl_bench.mdp.task_batch import ACTIONS, TaskBatch

UNREACHABLE = -1
"""Distance where there is no path."""


def success_probability(batch: TaskBatch, policy: torch.Tensor) -> torch.Tensor:
    """Probability that the goal predicate holds at some step t = 0..H.

    Args:
        batch: The tasks.
        policy: float [task, horizon, state, action].

    Returns:
        float64 [task], in [0, 1].

    Raises:
        ValueError: If `policy` does not fit.
    """
    check_policy(batch, policy)
    outside = (~spread_cells(batch.goal)).to(torch.float64)
    successors = flat_successors(batch)
    # Mass that enters the goal is removed, so what remains at the end never arrived.
    mass = start_mass(batch, dtype=torch.float64) * outside
    for t in range(batch.horizon):
        mass = advance(mass, policy, successors, t) * outside
    return (1.0 - mass.sum(-1)).clamp_(0.0, 1.0)


def final_success_probability(batch: TaskBatch, policy: torch.Tensor) -> torch.Tensor:
    """Probability that the goal predicate holds at step H.

    Args:
        batch: The tasks.
        policy: float [task, horizon, state, action].

    Returns:
        float64 [task], in [0, 1].

    Raises:
        ValueError: If `policy` does not fit.
    """
    check_policy(batch, policy)
    successors = flat_successors(batch)
    mass = start_mass(batch, dtype=torch.float64)
    for t in range(batch.horizon):
        mass = advance(mass, policy, successors, t)
    return (mass * spread_cells(batch.goal)).sum(-1).clamp_(0.0, 1.0)


def uniform_policy(batch: TaskBatch, *, dtype: torch.dtype = torch.float32) -> torch.Tensor:
    """The random policy: float [task, horizon, state, action], an expanded scalar."""
    quarter = torch.full((), 1.0 / ACTIONS, dtype=dtype, device=batch.next_state.device)
    return quarter.expand(len(batch), batch.horizon, batch.states, ACTIONS)


def distance_to_goal(batch: TaskBatch) -> torch.Tensor:
    """Fewest actions from every state to the goal, ignoring the horizon.

    Returns:
        int64 [task, state]; `UNREACHABLE` where there is no path.
    """
    successors = flat_successors(batch)
    goal = spread_cells(batch.goal)
    # Larger than any distance; adding one can't overflow.
    far = batch.states + 1
    distance = torch.where(goal, 0, far)
    while True:
        onward = distance.view(-1).index_select(0, successors).view(ACTIONS, *distance.shape)
        # Several times faster than `amin` over the first of few dimensions.
        nearer = torch.minimum(distance, reduce(torch.minimum, onward) + 1)
        if torch.equal(nearer, distance):
            return torch.where(distance < far, distance, UNREACHABLE)
        distance = nearer


def optimal_length(batch: TaskBatch) -> torch.Tensor:
    """Fewest actions from each task's start to its goal, ignoring the horizon.

    Returns:
        int64 [task]; `UNREACHABLE` where there is no path.
    """
    return distance_to_goal(batch).gather(1, batch.start[:, None]).squeeze(1)
