"""Occupancy measures of policies (by the forward algorithm) and of demonstrations.

Letters: d_t(s) probability of being in s at step t, gamma discount, H horizon.

    d_0 = start;  d_{t+1}(s') = sum_{s,a} d_t(s) pi_t(a|s) [f(s,a) = s']
    rho(s) = sum_{t=0..H} gamma^t d_t(s)

The final state counts, as it does in the return. Both occupancies must use the planner's gamma:
only then is rho_demonstrations - rho_policy the gradient of a likelihood.

Source: Fu et al. (2019), equation (2) and section "Computing Exact IRL Gradient Updates".
"""

from __future__ import annotations

import torch

from lcrl_bench.mdp.dynamics import advance, check_policy, flat_successors, start_mass, sum_into
from lcrl_bench.mdp.task_batch import TaskBatch


def occupancy_mass(horizon: int, discount: float) -> float:
    """What an occupancy sums to: sum_{t=0..H} gamma^t."""
    if discount == 1.0:
        return float(horizon + 1)
    return (1.0 - discount ** (horizon + 1)) / (1.0 - discount)


def occupancy(batch: TaskBatch, policy: torch.Tensor, *, discount: float) -> torch.Tensor:
    """Discounted state visitation of a policy, exactly.

    Args:
        batch: The tasks.
        policy: float [task, horizon, state, action].
        discount: gamma of the sum; `batch.discount` for a gradient.

    Returns:
        float [task, state]; `fold_cells` gives it per cell.

    Raises:
        ValueError: If `policy` does not fit, or its probabilities don't sum to one.
    """
    check_policy(batch, policy)
    successors = flat_successors(batch)
    mass = start_mass(batch, dtype=policy.dtype)
    rho = mass.clone()
    for t in range(batch.horizon):
        mass = advance(mass, policy, successors, t)
        rho.add_(mass, alpha=discount ** (t + 1))
    _check_mass(rho, occupancy_mass(batch.horizon, discount))
    return rho


def empirical_occupancy(
    batch: TaskBatch,
    states: torch.Tensor,
    *,
    discount: float,
    dtype: torch.dtype = torch.float32,
) -> torch.Tensor:
    """Average discounted state visitation of trajectories.

    Args:
        batch: The tasks.
        states: int64 [task, trajectory, horizon + 1].
        discount: gamma of the sum.
        dtype: Floating-point type of the result.

    Returns:
        float [task, state], with the same total as `occupancy`.

    Raises:
        ValueError: If `states` has the wrong shape or no trajectory.
    """
    tasks, trajectories, steps = states.shape
    if (tasks, steps) != (len(batch), batch.horizon + 1) or trajectories == 0:
        expected = f"[{len(batch)}, at least 1, {batch.horizon + 1}]"
        raise ValueError(f"states must be {expected}, found {list(states.shape)}")
    times = torch.arange(steps, device=states.device, dtype=torch.float64)
    weights = (discount**times / trajectories).to(dtype).expand_as(states)
    offsets = torch.arange(tasks, device=states.device) * batch.states
    index = (states + offsets[:, None, None]).reshape(-1)
    return sum_into(tasks * batch.states, index, weights.reshape(-1)).view(tasks, batch.states)


def _check_mass(rho: torch.Tensor, expected: float) -> None:
    """Check the total of an occupancy, which is off if the policy was not normalised."""
    worst = float((rho.sum(-1) - expected).abs().max()) if rho.numel() else 0.0
    allowed = (1e-3 if rho.dtype == torch.float32 else 1e-9) * expected
    # Written so that a NaN fails too.
    if not worst <= allowed:
        reason = "does the policy sum to one over actions?"
        raise ValueError(f"occupancy is off its total {expected:.6g} by {worst:.3g}: {reason}")
