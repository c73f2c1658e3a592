"""`PolicyOutcome`: where a policy leads, summed exactly over all its action sequences.

Letters: d_t(s) probability of being in s at step t, H horizon, gamma discount. Two parts of d_t are
tracked with it: the mass that has not yet met the goal, and the mass that has not yet visited the
waypoint.

Episodes never end early, so the goal predicate may hold at several steps: `arrival` is about the
first of them, `final` about step H, `goal_value` about all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from lcrl_bench.mdp.dynamics import (
    advance,
    check_policy,
    check_reward,
    check_transitions,
    flat_successors,
    spread_cells,
    start_mass,
)
from lcrl_bench.mdp.kernels.dispatch import parallel_for, use_kernel
from lcrl_bench.mdp.planning import TIE_TOLERANCE, q_iteration
from lcrl_bench.mdp.task_batch import TaskBatch


@dataclass(frozen=True)
class PolicyOutcome:
    """Where following a policy leads; float64 throughout."""

    arrival: torch.Tensor
    """[task, horizon + 1]: probability that the goal predicate holds at step t for the first time.
    """
    final: torch.Tensor
    """[task, state]: probability of being in each state at step H."""
    lost: torch.Tensor
    """[task, state]: the part of `final` that never met the goal."""
    goal_value: torch.Tensor
    """[task]: sum_{t=0..H} gamma^t P(the goal predicate holds at t); times the success reward, it
    is the true return."""
    passed: torch.Tensor
    """[task]: probability that the waypoint is visited at some step; 0 without a waypoint."""
    missed: torch.Tensor
    """[task, state]: the part of `final` that never visited the waypoint; all of it without a
    waypoint."""

    @property
    def success(self) -> torch.Tensor:
        """Probability that the goal predicate holds at some step t = 0..H: [task], in [0, 1]."""
        return self.arrival.sum(-1).clamp_(0.0, 1.0)


def follow(
    batch: TaskBatch, policy: torch.Tensor, *, waypoint: torch.Tensor | None = None
) -> PolicyOutcome:
    """Follow a policy from the start, by exact sums.

    Args:
        batch: The tasks.
        policy: float [task, horizon, state, action].
        waypoint: bool [task, cell]: cells whose visits are tracked, such as those in which the
            object of a PICK task is held; None for none.

    Raises:
        ValueError: If `policy` or `waypoint` does not fit.
    """
    check_policy(batch, policy)
    goal = spread_cells(batch.goal).double()
    mark = spread_cells(_checked(batch, waypoint)).double()
    successors = flat_successors(batch)

    everything = start_mass(batch, dtype=torch.float64)
    arrived = everything * goal
    lost = everything - arrived
    visited = everything * mark
    missed = everything - visited
    arrival, passed, goal_value = [arrived.sum(-1)], visited.sum(-1), arrived.sum(-1)
    for t in range(batch.horizon):
        everything = advance(everything, policy, successors, t)
        goal_value = goal_value + batch.discount ** (t + 1) * (everything * goal).sum(-1)
        lost = advance(lost, policy, successors, t)
        arrived = lost * goal
        arrival.append(arrived.sum(-1))
        lost = lost - arrived
        if waypoint is not None:
            missed = advance(missed, policy, successors, t)
            visited = missed * mark
            passed = passed + visited.sum(-1)
            missed = missed - visited
    return PolicyOutcome(
        arrival=torch.stack(arrival, -1),
        final=everything,
        lost=lost,
        goal_value=goal_value,
        passed=passed.clamp(0.0, 1.0),
        missed=everything if waypoint is None else missed,
    )


def follow_greedy(
    batch: TaskBatch, reward: torch.Tensor, *, waypoint: torch.Tensor | None = None
) -> PolicyOutcome:
    """Follow the optimal policy of a reward, uniform over tied actions, as `q_iteration` gives it.

    Args:
        batch: The tasks.
        reward: float [task, cell]; solved in float64, on a CPU by a compiled kernel where available
            (`mdp.kernels`), which agrees within 1e-12.
        waypoint: bool [task, cell], as in `follow`.

    Raises:
        ValueError: If `reward` or `waypoint` does not fit, or `reward` is not finite.
    """
    check_reward(batch, reward)
    reward = reward.detach().double()
    if use_kernel(reward.device):
        return _compiled(batch, reward, _checked(batch, waypoint))
    return follow(batch, q_iteration(batch, reward).policy, waypoint=waypoint)


def _compiled(batch: TaskBatch, reward: torch.Tensor, waypoint: torch.Tensor) -> PolicyOutcome:
    # Here, so that importing the solvers does not import numba.
    from lcrl_bench.mdp.kernels import policy_outcome as kernel

    check_transitions(batch)
    given = (batch.next_state, batch.goal, waypoint, reward, batch.start)
    next_state, goal, mark, r, start = (tensor.contiguous().numpy() for tensor in given)
    arrival = np.zeros((len(batch), batch.horizon + 1))
    final, lost, missed = np.zeros((3, len(batch), batch.states))
    goal_value, passed = np.zeros((2, len(batch)))

    def work(first: int, end: int) -> None:
        kernel.follow(
            next_state,
            goal,
            mark,
            r,
            start,
            float(batch.discount),
            TIE_TOLERANCE,
            first,
            end,
            arrival,
            final,
            lost,
            missed,
            goal_value,
            passed,
        )

    parallel_for(len(batch), work)
    return PolicyOutcome(
        arrival=torch.from_numpy(arrival),
        final=torch.from_numpy(final),
        lost=torch.from_numpy(lost),
        missed=torch.from_numpy(missed),
        goal_value=torch.from_numpy(goal_value),
        passed=torch.from_numpy(passed).clamp_(0.0, 1.0),
    )


def _checked(batch: TaskBatch, waypoint: torch.Tensor | None) -> torch.Tensor:
    """The waypoint, or an empty one for None.

    Raises:
        ValueError: If it is not bool [task, cell].
    """
    if waypoint is None:
        return torch.zeros_like(batch.goal)
    if waypoint.shape != batch.goal.shape or waypoint.dtype != torch.bool:
        found = f"{waypoint.dtype} {list(waypoint.shape)}"
        expected = list(batch.goal.shape)
        raise ValueError(f"waypoint must be bool [task, cell] = {expected}, found {found}")
    return waypoint
