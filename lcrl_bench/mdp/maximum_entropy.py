"""Soft marginals: visits and value of the soft-optimal policy, all that a step of MaxEnt IRL needs.

Letters: r(s) reward, rho(s) = sum_{t=0..H} gamma^t d_t(s) discounted visits of the soft-optimal
policy, V_t(s) soft value, s_0 the start. Visits are the exact derivative of the value:

    d V_0(s_0) / d r(s) = rho(s)

so the likelihood of demonstrations with visits rho_D, sum_s rho_D(s) r(s) - V_0(s_0) up to the
factor 1 / alpha, has the gradient rho_D - rho.

Source: Ziebart, "Modeling Purposeful Adaptive Behavior with the Principle of Maximum Causal
Entropy" (2010); Fu et al. (2019), equation (2) and section "Computing Exact IRL Gradient Updates".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
import torch

from lcrl_bench.mdp.dynamics import (
    check_reward,
    check_transitions,
    flat_start,
    flat_successors,
    fold_cells,
    spread_cells,
    sum_into,
)
from lcrl_bench.mdp.kernels.dispatch import parallel_for, use_kernel
from lcrl_bench.mdp.planning import check_temperature
from lcrl_bench.mdp.task_batch import ACTIONS, TaskBatch


@dataclass(frozen=True)
class Marginals:
    """Visits and value of the soft-optimal policy of a reward."""

    occupancy: torch.Tensor
    """float [task, cell]: rho, visits discounted by the batch's gamma, headings summed."""
    start_value: torch.Tensor
    """float [task]: V_0(s_0), entropy included."""


def soft_marginals(batch: TaskBatch, reward: torch.Tensor, *, temperature: float) -> Marginals:
    """Solve the entropy-regularised MDPs for their marginals alone, without keeping the policy.

    For a float32 reward on a CPU a compiled kernel is used where available (`mdp.kernels`); it is
    within 1e-5 of the exact result. A float64 reward is always solved in float64 by torch.

    Args:
        batch: The tasks.
        reward: float [task, cell]; its dtype and device are those of the result.
        temperature: alpha > 0, in units of reward.

    Raises:
        ValueError: If `reward` does not fit, is not finite, or `temperature` is not positive.
    """
    return soft_marginals_of([batch], [reward], temperature=temperature)[0]


def soft_marginals_of(
    batches: Sequence[TaskBatch], rewards: Sequence[torch.Tensor], *, temperature: float
) -> tuple[Marginals, ...]:
    """`soft_marginals` of several batches at once, of one house or several.

    Torch solves them as one flat state space: launching an operation is most of the cost on a GPU,
    and is paid once for all batches.

    Args:
        batches: One or more, of the same horizon, discount and device.
        rewards: One per batch, of the same dtype.
        temperature: alpha > 0, in units of reward.

    Raises:
        ValueError: If the batches or their rewards do not fit together, or as in `soft_marginals`.
    """
    check_temperature(temperature)
    for batch, reward in zip(batches, rewards, strict=True):
        check_reward(batch, reward)
    kinds = {
        (batch.horizon, batch.discount, reward.device, reward.dtype)
        for batch, reward in zip(batches, rewards, strict=True)
    }
    if len(kinds) != 1:
        listing = "; ".join(sorted(", ".join(map(str, kind)) for kind in kinds)) or "no batch"
        raise ValueError(
            f"expected batches of one horizon, discount, device and dtype, found {listing}"
        )
    rewards = [reward.detach() for reward in rewards]
    if rewards[0].dtype == torch.float32 and use_kernel(rewards[0].device):
        pairs = zip(batches, rewards, strict=True)
        return tuple(_compiled(batch, reward, temperature) for batch, reward in pairs)
    return _flat(batches, rewards, temperature)


def _flat(
    batches: Sequence[TaskBatch], rewards: Sequence[torch.Tensor], temperature: float
) -> tuple[Marginals, ...]:
    """`soft_q_iteration`, then `occupancy`, over the states of all tasks as one flat axis."""
    horizon, discount = batches[0].horizon, batches[0].discount
    edges = [0, *accumulate(len(batch) * batch.states for batch in batches)]
    offsets = list(zip(batches, edges[:-1], strict=True))
    tables = [(flat_successors(batch) + edge).view(ACTIONS, -1) for batch, edge in offsets]
    successors = torch.cat(tables, 1).view(-1)
    start = torch.cat([flat_start(batch) + edge for batch, edge in offsets])
    r = torch.cat([spread_cells(reward).reshape(-1) for reward in rewards])

    v, policy = r, r.new_empty(horizon, ACTIONS, len(r))
    for t in reversed(range(horizon)):
        onward = v.index_select(0, successors).view(ACTIONS, -1)
        best = onward.amax(0)
        # The reward of a state is common to its actions, and cancels in their differences.
        weights = onward.sub_(best).mul_(discount / temperature).exp_()
        total = weights.sum(0)
        torch.div(weights, total, out=policy[t])
        v = r + (discount * best).add_(total.log_(), alpha=temperature)

    mass = sum_into(len(r), start, r.new_ones(len(start)))
    rho = mass.clone()
    for t in range(horizon):
        mass = sum_into(len(r), successors, (mass * policy[t]).view(-1))
        rho.add_(mass, alpha=discount ** (t + 1))

    rho_of = fold_cells(rho).split([len(batch) * batch.cells for batch in batches])
    value_of = v[start].split([len(batch) for batch in batches])
    return tuple(
        Marginals(rho.view(len(batch), batch.cells), value)
        for batch, rho, value in zip(batches, rho_of, value_of, strict=True)
    )


def _compiled(batch: TaskBatch, reward: torch.Tensor, temperature: float) -> Marginals:
    # Here, so that importing the solvers does not import numba.
    from lcrl_bench.mdp.kernels import maximum_entropy as kernel

    check_transitions(batch)
    rho, value = np.empty((len(batch), batch.cells), np.float32), np.empty(len(batch), np.float32)
    next_state, start = batch.next_state.contiguous().numpy(), batch.start.contiguous().numpy()
    r = reward.contiguous().numpy()

    def work(first: int, end: int) -> None:
        kernel.solve(
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

    parallel_for(len(batch), work)
    return Marginals(torch.from_numpy(rho), torch.from_numpy(value))
