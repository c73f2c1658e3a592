"""What a step of maximum entropy IRL needs of the soft-optimal policy: where it goes, its value.

Letters: r(s) reward, rho(s) = sum_{t=0..H} gamma^t d_t(s) discounted visits of the soft-optimal
policy, V_t(s) soft value, s_0 the start. One is the derivative of the other, exactly:

    d V_0(s_0) / d r(s) = rho(s)

so the likelihood of demonstrations with visits rho_D, sum_s rho_D(s) r(s) - V_0(s_0) up to the
factor 1 / alpha, has the gradient rho_D - rho.

Source: Ziebart, "Modeling Purposeful Adaptive Behavior with the Principle of Maximum Causal
Entropy" (2010); Fu et al. (2019), equation (2) and section "Computing Exact IRL Gradient Updates".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from lcrl_bench.mdp.dynamics import check_reward, check_transitions, fold_cells
from lcrl_bench.mdp.kernels import share, use_kernel
from lcrl_bench.mdp.occupancy import occupancy
from lcrl_bench.mdp.q_iteration import check_temperature, soft_q_iteration
from lcrl_bench.mdp.task_batch import TaskBatch


@dataclass(frozen=True)
class Marginals:
    """Where the soft-optimal policy of a reward goes, and what it is worth."""

    occupancy: torch.Tensor
    """float [task, cell]: rho, visits discounted by the batch's gamma, headings summed."""
    start_value: torch.Tensor
    """float [task]: V_0(s_0), entropy included."""


def soft_marginals(batch: TaskBatch, reward: torch.Tensor, *, temperature: float) -> Marginals:
    """Solve the entropy-regularised MDPs for their marginals alone; no policy is kept.

    A float32 reward on a CPU goes to a compiled kernel where there is one (`mdp.kernels`), which
    is within 1e-5 of the exact result; a float64 reward is always solved in float64.

    Args:
        batch: The tasks.
        reward: float [task, cell]; its dtype and device are those of the result.
        temperature: alpha > 0, in units of reward.

    Raises:
        ValueError: If `reward` does not fit, is not finite, or `temperature` is not positive.
    """
    check_temperature(temperature)
    check_reward(batch, reward)
    reward = reward.detach()
    if reward.dtype == torch.float32 and use_kernel(reward.device):
        return _compiled(batch, reward, temperature)
    solution = soft_q_iteration(batch, reward, temperature=temperature)
    rho = occupancy(batch, solution.policy, discount=batch.discount)
    value = solution.values[:, 0].gather(1, batch.start[:, None]).squeeze(1)
    return Marginals(fold_cells(rho), value)


def _compiled(batch: TaskBatch, reward: torch.Tensor, temperature: float) -> Marginals:
    # Here, so that importing the solvers does not import numba.
    from lcrl_bench.mdp import soft_kernel

    check_transitions(batch)
    rho, value = np.empty((batch.tasks, batch.cells), np.float32), np.empty(batch.tasks, np.float32)
    next_state, start = batch.next_state.contiguous().numpy(), batch.start.contiguous().numpy()
    r = reward.contiguous().numpy()

    def work(first: int, end: int) -> None:
        soft_kernel.solve(
            next_state,
            r,
            start,
            batch.horizon,
            float(batch.discount),
            float(temperature),
            first,
            end,
            rho,
            value,
        )

    share(batch.tasks, work)
    return Marginals(torch.from_numpy(rho), torch.from_numpy(value))
