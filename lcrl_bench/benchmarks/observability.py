"""Is seeing enough? The true reward, projected on observations, must still solve a task.

A reward is a function of what is seen. The plainest projection scores a panorama by the mean true
reward of the states that look like it, each counted once. Where that reward, optimised exactly,
leads to the goal, seeing is enough; where it does not, another reward of what is seen might still
(see `projections`), so this is a strict test of a task, not a bound on methods.
"""

from __future__ import annotations

import torch

from lcrl_bench.benchmarks.compiled import CompiledHouse, CompiledTasks
from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.q_iteration import q_iteration
from lcrl_bench.mdp.success import success_probability
from lcrl_bench.semantics import Semantics

MIN_SUCCESS = 0.99
"""Success of the projected reward from which seeing counts as enough."""


def projected_reward(
    compiled: CompiledHouse, tasks: CompiledTasks, semantics: Semantics
) -> torch.Tensor:
    """The true reward of each task, averaged over the cells that look alike.

    Returns:
        float64 [task, cell].
    """
    reward = true_reward(tasks.batch, semantics.success_reward, dtype=torch.float64)
    rows = torch.from_numpy(compiled.store.panorama_views)
    looks = torch.unique(rows, dim=0, return_inverse=True)[1][tasks.panoramas]
    shape = (len(reward), int(looks.max()) + 1)
    total = torch.zeros(shape, dtype=torch.float64).scatter_add_(1, looks, reward)
    count = torch.zeros_like(total).scatter_add_(1, looks, torch.ones_like(reward))
    return (total / count.clamp(min=1)).gather(1, looks)


def projected_success(
    compiled: CompiledHouse, tasks: CompiledTasks, semantics: Semantics
) -> list[float]:
    """Exact success of each task when its projected reward is optimised."""
    reward = projected_reward(compiled, tasks, semantics)
    policy = q_iteration(tasks.batch, reward).policy
    return success_probability(tasks.batch, policy).tolist()
