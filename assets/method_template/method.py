"""MyMethod: LC-RL's gradient with a penalty on large rewards, as a starting point.

Letters: r(o, L) learned reward of an observation and a command, rho_D discounted visits of the
demonstrations, rho_r those of the soft-optimal policy of r, c penalty.

    descend   sum_s (rho_r(s) - rho_D(s)) r(o(s), L)  +  c mean_s r(o(s), L)^2

Its first term has the gradient of maximum entropy inverse reinforcement learning.

Source: Fu et al., "From Language to Goals" (ICLR 2019), equation (2); the penalty is an addition.
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
from lcrl_bench.methods.training import TrainingConfig
from lcrl_bench.networks.reward_network import RewardNetwork


@dataclass(frozen=True)
class MyMethodConfig(TrainingConfig):
    """Settings of MyMethod, besides those of training; `--set penalty=0.1` sets one."""

    temperature: float = 1.0
    """Temperature of the soft policy, in units of reward."""
    penalty: float = 0.01
    """c: cost per squared unit of reward, averaged over the cells of a task."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        if not (self.temperature > 0 and self.penalty >= 0):
            raise UsageError("temperature must be positive, penalty non-negative.")


class MyMethod(NetworkMethod[MyMethodConfig, RewardNetwork]):
    """Learns a reward whose soft-optimal policy matches the demonstrations' visits."""

    learns = NetworkReward
    Config: ClassVar[type[MyMethodConfig]] = MyMethodConfig

    def objective(
        self,
        network: RewardNetwork,
        features: torch.Tensor,
        commands: torch.Tensor,
        house: PreparedHouse,
    ) -> tuple[torch.Tensor, float]:
        """The objective of a step on all tasks of a house, and the loss to report.

        Args:
            network: The network in training.
            features: float [panorama, feature]: its features of the house's panoramas.
            commands: float [command, size]: its embeddings of the house's commands.
            house: The house's tasks.

        Returns:
            The objective to minimise, and the share of all visits in the wrong cells.
        """
        descended, misplaced = features.new_zeros(()), 0.0
        for tasks, said in house.with_commands(commands):
            reward = network.score(features, tasks.panoramas, said)
            temperature = self.config.temperature
            visits = soft_marginals(tasks, reward.detach(), temperature=temperature).occupancy
            excess = (visits - tasks.demonstration_occupancy) / tasks.occupancy_mass
            penalty = self.config.penalty * reward.square().mean(1).sum()
            descended = descended + (excess * reward).sum() + penalty
            misplaced += float(excess.abs().sum()) / 2
        return descended / house.count, misplaced / house.count
