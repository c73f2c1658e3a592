"""LC-RL: a reward of panorama and command, learned by maximum causal entropy IRL.

Letters of the paper: r_theta(o, L) reward, rho_D state marginal of the demonstrations, rho_theta
that of the optimal policy under r_theta, gamma discount, alpha temperature.

    maximise   E_task E_demonstrations log p_theta(tau, L)                        (equation 3)
    gradient   sum_s (rho_D(s) - rho_theta(s)) grad r_theta(o(s), L)              (equation 2)

Both marginals are exact sums over the horizon, sum_t gamma^t d_t(s), the last state included.

Source: Fu et al., "From Language to Goals: Inverse Reinforcement Learning for Vision-Based
Instruction Following" (ICLR 2019), section "Language-Conditioned Reward Learning", Algorithm 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.maximum_entropy import soft_marginals
from lcrl_bench.methods.network_method import NetworkMethod
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, TrainingConfig
from lcrl_bench.networks.reward_network import RewardNetwork


@dataclass(frozen=True)
class LcRlConfig(TrainingConfig):
    """Settings of LC-RL."""

    weight_decay: float = 0.3
    """AdamW's decoupled weight decay, relative to the learning rate."""
    temperature: float = 1.0
    """alpha of the soft policy, in units of reward. (The paper gives none.)"""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        if not self.temperature > 0:
            raise UsageError("temperature must be positive.")


class LcRl(NetworkMethod[LcRlConfig, RewardNetwork]):
    """Algorithm 1 of the paper, one house at a time."""

    learns = NetworkReward
    Config: ClassVar[type[LcRlConfig]] = LcRlConfig
    presets: ClassVar = {"paper": {**PAPER_TRAINING, "mirror": False}}

    def objective(
        self,
        network: RewardNetwork,
        features: torch.Tensor,
        commands: torch.Tensor,
        house: PreparedHouse,
    ) -> tuple[torch.Tensor, float]:
        """Lines 4 to 6 of Algorithm 1 for all tasks of a house.

        Returns:
            What has the gradient, and the mean negative log-likelihood of the demonstrations, in
            nats per step.
        """
        surrogate = features.new_zeros(())
        likelihood_loss = 0.0
        for tasks, said in house.with_commands(commands):
            r = network.score(features, tasks.panoramas, said)

            # Line 5: q* by soft Q-iteration, rho_theta by the forward algorithm. The dynamics hold
            # no end of episode, which would tell the planner where the goal is.
            marginals = soft_marginals(tasks, r.detach(), temperature=self.config.temperature)

            # Line 6: the gradient of this sum in theta is minus equation (2). Dividing by the
            # mass of an occupancy makes it a difference of distributions, alike for any horizon.
            difference = marginals.occupancy - tasks.demonstration_occupancy
            surrogate = surrogate + (difference * r).sum() / tasks.occupancy_mass

            # V_0(s_0) - sum rho_D r is alpha times the negative log-likelihood, exactly: the
            # terms log pi_t = (Q_t - V_t) / alpha, weighted by gamma^t, telescope.
            fit = (tasks.demonstration_occupancy * r.detach()).sum(1)
            missing = float((marginals.start_value - fit).sum())
            likelihood_loss += missing / tasks.occupancy_mass / self.config.temperature
        return surrogate / house.count, likelihood_loss / house.count
