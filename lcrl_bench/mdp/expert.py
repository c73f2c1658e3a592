"""The expert: the exact optimum of the true reward, and that reward.

Source: Fu et al. (2019), appendix "Experiment Hyperparameters": a reward of 10 where the task is
done; demonstrations are drawn from the optimal policy of this reward.
"""

from __future__ import annotations

import torch

from lcrl_bench.mdp.q_iteration import q_iteration
from lcrl_bench.mdp.task_batch import TaskBatch


def true_reward(
    batch: TaskBatch, success_reward: float, *, dtype: torch.dtype = torch.float32
) -> torch.Tensor:
    """The reward of the environment: `success_reward` where the goal predicate holds, else 0.

    Returns:
        float [task, cell].
    """
    return batch.goal.to(dtype) * success_reward


def expert_policy(batch: TaskBatch, success_reward: float) -> torch.Tensor:
    """The optimal policy of the true reward, uniform over ties.

    Every step at the goal pays, so the expert arrives as soon as it can and stays there. A state
    from which no goal can be reached in time has four tied actions.

    Returns:
        float64 [task, horizon, state, action].
    """
    reward = true_reward(batch, success_reward, dtype=torch.float64)
    return q_iteration(batch, reward).policy
