"""The reward of a transition: paid on arrival, plus potential-based shaping.

Letters: r(s') reward of the cell arrived in, phi potential, gamma discount.

    R(s, s') = r(s') + gamma phi(s') - phi(s)

Without termination, no phi changes the optimal policy: over an infinite trajectory the differences
telescope to -phi(s_0). A truncated episode continues in the values that it bootstraps from, so phi
is not zeroed there.

Source: Ng, Harada and Russell, "Policy invariance under reward transformations" (1999); Fu et al.
(2019), section "Experimental Procedure": "a state-based potential equal to the optimal value
function".
"""

from __future__ import annotations

import torch

from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch


def shaped_reward(
    rewards: torch.Tensor,
    potentials: torch.Tensor | None,
    states: torch.Tensor,
    successors: torch.Tensor,
    *,
    discount: float,
) -> torch.Tensor:
    """Rewards of transitions, shaped if there is a potential.

    Args:
        rewards: float [task, cell].
        potentials: float [task, state]; None for no shaping.
        states: int64 [task, n]: s.
        successors: int64 [task, n]: s'.
        discount: gamma.

    Returns:
        float [task, n].
    """
    r = rewards.gather(1, successors // HEADINGS)
    if potentials is None:
        return r
    return r + discount * potentials.gather(1, successors) - potentials.gather(1, states)


def optimal_values(batch: TaskBatch, reward: torch.Tensor) -> torch.Tensor:
    """The paper's potential: V_0 of exact Q-iteration, float32 [task, state].

    Computing it needs the dynamics.
    """
    return q_iteration(batch, reward.double()).values[:, 0].float()
