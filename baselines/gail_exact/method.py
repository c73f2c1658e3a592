"""GAIL-Exact: a discriminator trained against the exact solver's occupancy, used as a reward.

Letters: l(o, L) logit of the discriminator, D = sigmoid(l) the probability that a state is the
expert's, f(l) the reward made of it, rho_E occupancy of the demonstrations, rho_pi of the policy.

    policy          the maximum causal entropy policy of f(l), by soft Q-iteration
    discriminator   minimise  - sum_s rho_E(s) log D(s) - sum_s rho_pi(s) log(1 - D(s))

Both occupancies are normalised to one. Nothing is sampled but the demonstrations.

Source: Ho & Ermon, "Generative Adversarial Imitation Learning" (2016); Fu et al. (2019), section
"Experimental Procedure": "we also compare against GAIL using a dynamic programming solver".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch.nn import functional

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.maximum_entropy import soft_marginals
from lcrl_bench.methods.logit_rewards import LogitReward, reward_of_logit
from lcrl_bench.methods.network_method import NetworkMethod
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, TrainingConfig
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class GailExactConfig(TrainingConfig):
    """Settings of GAIL-Exact."""

    weight_decay: float = 0.3
    """AdamW's decoupled weight decay, relative to the learning rate."""
    reward: LogitReward = "softplus"
    """f: `softplus` is -log(1 - D), Ho & Ermon's; `log-sigmoid` is log D; `logit` is their sum."""
    temperature: float = 1.0
    """Temperature of the soft policy, in units of reward."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        if not self.temperature > 0:
            raise UsageError("temperature must be positive.")


class GailExact(NetworkMethod[GailExactConfig, RewardNetwork]):
    """Adversarial imitation with the sampling taken out."""

    learns = NetworkReward
    Config: ClassVar[type[GailExactConfig]] = GailExactConfig
    presets: ClassVar = {"paper": {**PAPER_TRAINING, "mirror": False, "reward": "softplus"}}

    def objective(
        self,
        network: RewardNetwork,
        features: torch.Tensor,
        commands: torch.Tensor,
        house: PreparedHouse,
    ) -> tuple[torch.Tensor, float]:
        """The discriminator's loss on all tasks of a house, in nats."""
        loss = features.new_zeros(())
        for tasks, said in house.with_commands(commands):
            logit = network.score(features, tasks.panoramas, said)
            reward = reward_of_logit(self.config.reward, logit.detach())
            marginals = soft_marginals(tasks, reward, temperature=self.config.temperature)
            rho_expert = tasks.demonstration_occupancy / tasks.occupancy_mass
            rho_policy = marginals.occupancy / tasks.occupancy_mass
            # -log D = softplus(-l) and -log(1 - D) = softplus(l).
            missed = rho_expert * functional.softplus(-logit)
            fooled = rho_policy * functional.softplus(logit)
            loss = loss + (missed + fooled).sum()
        return loss / house.count, float(loss.detach()) / house.count

    def wrap(self, network: RewardNetwork, vocabulary: Vocabulary) -> NetworkReward:
        """The reward that the policy was optimised for."""
        return NetworkReward(network, vocabulary, transform=self.config.reward)
