"""Trajectories of a policy: sampled for demonstrations, the most likely one for recordings."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import torch

from lcrl_bench.mdp.dynamics import check_policy
from lcrl_bench.mdp.task_batch import TaskBatch

Choose = Callable[[torch.Tensor, int], torch.Tensor]
"""pi_t(.|s) [task, episode, action] and t -> int64 [task, episode]."""


class Trajectories(NamedTuple):
    """States and actions of episodes."""

    states: torch.Tensor
    """int64 [task, episode, horizon + 1]."""
    actions: torch.Tensor
    """int64 [task, episode, horizon]."""


def sample_trajectories(
    batch: TaskBatch, policy: torch.Tensor, *, episodes: int, generator: torch.Generator
) -> Trajectories:
    """Sample trajectories of a policy.

    Args:
        batch: The tasks.
        policy: float [task, horizon, state, action].
        episodes: Number of trajectories per task.
        generator: A CPU generator, so that samples don't depend on the device of `batch`.

    Raises:
        ValueError: If `policy` does not fit.
    """
    check_policy(batch, policy)
    shape = (batch.horizon, len(batch), episodes)
    draws = torch.rand(shape, generator=generator, dtype=torch.float64).to(policy.device)

    def draw(probabilities: torch.Tensor, time: int) -> torch.Tensor:
        edges = probabilities.to(torch.float64).cumsum(-1)
        # Scaled to just below the total, so that rounding never picks an impossible action.
        total = edges[..., -1:]
        point = draws[time, ..., None] * total
        point = torch.minimum(point, torch.nextafter(total, torch.zeros_like(total)))
        return (point >= edges).sum(-1)

    return _follow(batch, policy, episodes, draw)


def rollout(batch: TaskBatch, policy: torch.Tensor) -> Trajectories:
    """Take the most likely action at every step: one episode per task.

    Of tied actions, the lowest-numbered is taken.

    Args:
        batch: The tasks.
        policy: float [task, horizon, state, action].

    Raises:
        ValueError: If `policy` does not fit.
    """
    check_policy(batch, policy)
    return _follow(batch, policy, 1, lambda probabilities, _time: probabilities.argmax(-1))


def _follow(batch: TaskBatch, policy: torch.Tensor, episodes: int, choose: Choose) -> Trajectories:
    """Step all episodes of all tasks in parallel."""
    task = torch.arange(len(batch), device=policy.device)[:, None].expand(-1, episodes)
    state = batch.start[:, None].expand(-1, episodes)
    states, actions = [state], []
    for t in range(batch.horizon):
        action = choose(policy[task, t, state], t)
        state = batch.next_state[task, state, action]
        states.append(state)
        actions.append(action)
    return Trajectories(torch.stack(states, -1), torch.stack(actions, -1))
