"""From a learned reward or policy to an `Episode`: re-optimise it, follow it, record everything."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.expert import expert_policy, true_reward
from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch
from lcrl_bench.mdp.visitation import occupancy
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.methods.learned import plan
from lcrl_bench.recording.episode import Episode


def episode_of(
    learned: Reward | Policy,
    one: TaskSet,
    *,
    benchmark: Benchmark,
    method: str,
    seed: int,
) -> Episode:
    """Follow the most likely actions in one task.

    Args:
        learned: A reward is re-optimised exactly in the task's house; a policy acts as it is.
        one: A set of one task.
        benchmark: Gives name, fingerprint, discount and the true reward.
        method: Name of the method that learned it.
        seed: Of the run that learned it.
    """
    planned = plan(learned, one)
    states, actions = _array(planned.states[0]), _array(planned.actions[0])
    goal = _array(one.goal[0])
    success_reward = benchmark.semantics.success_reward
    picks = one.kind == Kind.PICK
    reward = true_reward(one, success_reward, dtype=torch.float64)
    # Without a goal there is no expert.
    expert = expert_policy(one, success_reward) if goal.any() else None
    visits, expert_visits = (
        None if policy is None else _visits(one, policy) for policy in (planned.policy, expert)
    )
    return Episode(
        scene=one.scene,
        views=one.views,
        task=one.task,
        panoramas=_array(one.panoramas[0]),
        goal=goal,
        states=states,
        actions=actions,
        action_probabilities=_array(planned.policy[0])[np.arange(len(actions)), states[:-1]],
        reward=None if planned.reward is None else _array(planned.reward[0]),
        value=None if planned.value is None else _array(planned.value[0]),
        true_reward=_array(reward[0]),
        occupancy=visits,
        expert_occupancy=expert_visits,
        success=bool(goal[states // HEADINGS].any()),
        method=method,
        seed=seed,
        benchmark=benchmark.name,
        fingerprint=benchmark.fingerprint,
        near_start=_array(one.object_tiles[0]) if picks else None,
        near_end=_array(one.target_tiles[0]) if picks else None,
    )


def _visits(batch: TaskBatch, policy: torch.Tensor) -> NDArray[np.float64]:
    """Discounted visitation of each cell."""
    rho = occupancy(batch, policy.double(), discount=batch.discount)
    return _array(fold_cells(rho)[0])


def _array(tensor: torch.Tensor) -> NDArray:
    return tensor.detach().cpu().numpy().copy()
