"""What maximum entropy IRL asks of a planner: where the soft policy goes, and what it is worth.

The two belong together: the occupancy of the soft policy is the gradient of its value in the
reward, dV_0(s_0) / dr(cell) = rho(cell).

Source: Ziebart (2010), recurrences (9.1)-(9.3); Fu et al. (2019), equation (2).
"""

from __future__ import annotations

from dataclasses import dataclass

import torch

from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.occupancy import occupancy
from lcrl_bench.mdp.q_iteration import soft_q_iteration
from lcrl_bench.mdp.task_batch import TaskBatch


@dataclass(frozen=True)
class Marginals:
    """Of the maximum causal entropy policy of a reward."""

    occupancy: torch.Tensor
    """float [task, cell]: discounted visits, sum_{t=0..H} gamma^t d_t."""
    start_value: torch.Tensor
    """float [task]: V_0(s_0), the entropy included."""


def soft_marginals(batch: TaskBatch, reward: torch.Tensor, *, temperature: float) -> Marginals:
    """Plan softly, and follow the plan from the start.

    Args:
        batch: The tasks.
        reward: float [task, cell].
        temperature: alpha > 0, in units of reward.

    Raises:
        ValueError: If `reward` does not fit, is not finite, or `temperature` is not positive.
    """
    solution = soft_q_iteration(batch, reward, temperature=temperature)
    rho = fold_cells(occupancy(batch, solution.policy, discount=batch.discount))
    value = solution.values[:, 0].gather(1, batch.start[:, None]).squeeze(1)
    return Marginals(rho, value)
