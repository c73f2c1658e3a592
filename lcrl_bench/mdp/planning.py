"""Exact planning: soft and hard Q-iteration over a finite horizon, with time-indexed policies.

Letters: r(s) reward, gamma discount, alpha temperature, H horizon, t = 0..H-1. Deterministic
dynamics s' = f(s, a), so an expectation over next states is a look-up.

    V_H(s)   = r(s)
    Q_t(s,a) = r(s) + gamma V_{t+1}(f(s,a))
    soft:  V_t(s) = alpha log sum_a exp(Q_t(s,a) / alpha),  pi_t(a|s) = exp((Q_t - V_t) / alpha)
    hard:  V_t(s) = max_a Q_t(s,a),                         pi_t uniform over the maximal actions

Episodes never end early: a solver that stopped at the true goal would leak where it is to the
reward under test.

Source: Ziebart, "Modeling Purposeful Adaptive Behavior with the Principle of Maximum Causal
Entropy" (2010), recurrences (9.1)-(9.3); Fu et al. (2019), section "Computing Exact IRL Gradient
Updates".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import torch

from lcrl_bench.mdp.dynamics import check_reward, flat_successors, spread_cells
from lcrl_bench.mdp.task_batch import ACTIONS, TaskBatch

TIE_TOLERANCE = 1e-6
"""Actions whose values differ by at most this fraction of the largest value are tied."""

Backup = Callable[[torch.Tensor], tuple[torch.Tensor, torch.Tensor]]
"""Q [action, task, state] -> V [task, state] and pi [action, task, state]."""


@dataclass(frozen=True)
class Solution:
    """Values and policy of a solved batch."""

    values: torch.Tensor
    """float [task, horizon + 1, state]: V_t(s), t = 0..H."""
    policy: torch.Tensor
    """float [task, horizon, state, action]: pi_t(a|s), t = 0..H-1."""


def soft_q_iteration(batch: TaskBatch, reward: torch.Tensor, *, temperature: float) -> Solution:
    """Solve the entropy-regularised MDPs: `reward`'s maximum causal entropy policy.

    Args:
        batch: The tasks.
        reward: float [task, cell]; its dtype and device are those of the result.
        temperature: alpha > 0, in units of reward.

    Raises:
        ValueError: If `reward` does not fit, is not finite, or `temperature` is not positive.
    """
    check_temperature(temperature)

    def backup(q: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        # One exponential serves both the log-sum-exp and the policy.
        best = q.amax(0)
        weights = ((q - best) / temperature).exp_()
        total = weights.sum(0)
        return best + temperature * total.log(), weights.div_(total)

    return _solve(batch, reward, backup)


def check_temperature(temperature: float) -> None:
    """Check a temperature.

    Raises:
        ValueError: If it is not positive.
    """
    if not temperature > 0:
        raise ValueError(f"temperature must be positive, found {temperature}")


def q_iteration(
    batch: TaskBatch, reward: torch.Tensor, *, tolerance: float = TIE_TOLERANCE
) -> Solution:
    """Solve the MDPs exactly; the policy is uniform over tied actions.

    So a constant reward gives the uniform random policy, not the lowest-numbered action.

    Args:
        batch: The tasks.
        reward: float [task, cell]; its dtype and device are those of the result.
        tolerance: Actions within `tolerance * max_s |V_t(s)|` of the best are tied.

    Raises:
        ValueError: If `reward` does not fit, is not finite, or `tolerance` is negative.
    """
    if not tolerance >= 0:
        raise ValueError(f"tolerance must not be negative, found {tolerance}")

    def backup(q: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        best = q.amax(0)
        margin = tolerance * best.abs().amax(-1, keepdim=True)
        tied = (q >= best - margin).to(q.dtype)
        return best, tied.div_(tied.sum(0))

    return _solve(batch, reward, backup)


def _solve(batch: TaskBatch, reward: torch.Tensor, backup: Backup) -> Solution:
    """The backward sweep of both solvers, t = H-1..0, into preallocated tensors."""
    check_reward(batch, reward)
    tasks, states, horizon = len(batch), batch.states, batch.horizon
    r = spread_cells(reward.detach())
    successors = flat_successors(batch)
    values = r.new_empty(horizon + 1, tasks, states)
    policy = r.new_empty(horizon, ACTIONS, tasks, states)
    values[horizon] = r
    for t in reversed(range(horizon)):
        v_next = values[t + 1].view(-1).index_select(0, successors).view(ACTIONS, tasks, states)
        values[t], policy[t] = backup(r + batch.discount * v_next)
    return Solution(values.transpose(0, 1), policy.permute(2, 0, 3, 1))
