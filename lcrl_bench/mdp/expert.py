"""The true reward, and the expert: its optimal policy.

Source: Fu et al. (2019), appendix "Experiment Hyperparameters": a reward of 10 where the task is
done; demonstrations are sampled from the optimal policy of this reward.
"""

from __future__ import annotations

import torch

from lcrl_bench.mdp.dynamics import flat_successors
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.success import UNREACHABLE, distance_to_goal
from lcrl_bench.mdp.task_batch import ACTIONS, TaskBatch


def true_reward(
    batch: TaskBatch, success_reward: float, *, dtype: torch.dtype = torch.float32
) -> torch.Tensor:
    """The environment's reward: `success_reward` where the goal predicate holds, else 0.

    Returns:
        float [task, cell].
    """
    return batch.goal.to(dtype) * success_reward


def expert_policy(batch: TaskBatch, success_reward: float) -> torch.Tensor:
    """The optimal policy of the true reward, uniform over ties.

    Every step in the goal is rewarded, so the expert gets there as fast as possible and stays. In
    states from which the goal can't be reached in time, all four actions are tied.

    Returns:
        float64 [task, horizon, state, action].
    """
    reward = true_reward(batch, success_reward, dtype=torch.float64)
    return q_iteration(batch, reward).policy


def shortest_way_policy(batch: TaskBatch) -> torch.Tensor:
    """The optimal policy of the true reward without a horizon, uniform over ties.

    An action is optimal if it leads closer to the goal, or stays in it. Where the goal can be
    reached in time, this is `expert_policy` at the first step.

    Returns:
        float32 [task, state, action]; uniform where the goal can't be reached.
    """
    distance = distance_to_goal(batch)
    distance = torch.where(distance == UNREACHABLE, batch.states, distance)
    flat = flat_successors(batch)
    onward = distance.reshape(-1)[flat].view(ACTIONS, *distance.shape).permute(1, 2, 0)
    best = (onward == onward.amin(-1, keepdim=True)).to(torch.float32)
    return best / best.sum(-1, keepdim=True)
