"""Optimal policy cloning: a policy of panorama, heading, held and command, fitted to the optimum.

Letters: pi*(a|s) optimal action probabilities, uniform over equally short ways; pi_theta the
network's, of what is seen, heading, held and command; w(s) a weight.

    minimise   - mean over tasks of  sum_s w(s) sum_a pi*(a|s) log pi_theta(a|s)

Source: Fu et al. (2019), section "Experimental Procedure": "We train the optimal cloning baseline
by computing the exact optimal policy using Q-iteration, and perform supervised learning to regress
directly on to the optimal action probabilities."
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.methods.network_method import NetworkMethod
from lcrl_bench.methods.network_policy import NetworkPolicy
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, TrainingConfig
from lcrl_bench.networks.policy_network import PolicyNetwork
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class CloningConfig(TrainingConfig):
    """Settings of optimal policy cloning."""

    mirror: ClassVar[bool] = False
    """No setting: what a policy does on the left it does not do on the right."""
    coverage: float = 0.0
    """Fraction of the weight spread evenly over all states, in [0, 1]; the rest is on the states
    that the optimal policy visits."""
    sharpness: float = 2.0
    """Factor on the learned logits when acting; above 1 acts more decidedly."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        if not 0 <= self.coverage <= 1:
            raise UsageError("coverage must lie in [0, 1].")
        if not self.sharpness > 0:
            raise UsageError("sharpness must be positive.")


class Cloning(NetworkMethod[CloningConfig, PolicyNetwork]):
    """Supervised learning of the optimal action probabilities."""

    expert = True
    learns = NetworkPolicy
    Config: ClassVar[type[CloningConfig]] = CloningConfig
    presets: ClassVar = {"paper": {**PAPER_TRAINING, "coverage": 1.0, "sharpness": 1.0}}

    def objective(
        self,
        network: PolicyNetwork,
        features: torch.Tensor,
        commands: torch.Tensor,
        house: PreparedHouse,
    ) -> tuple[torch.Tensor, float]:
        """The weighted cross-entropy on all tasks of a house, in nats."""
        loss = features.new_zeros(())
        for tasks, said in house.with_commands(commands):
            if tasks.expert is None or tasks.expert_occupancy is None:
                raise UsageError("Cloning needs the optimal action probabilities.")
            logits = network.logits(features, tasks.panoramas, tasks.held, said).flatten(1, 2)
            entropy = -(tasks.expert * logits.log_softmax(-1)).sum(-1)
            everywhere = self.config.coverage / tasks.states
            weight = (1 - self.config.coverage) * tasks.expert_occupancy + everywhere
            loss = loss + (weight * entropy).sum()
        return loss / house.count, float(loss.detach()) / house.count

    def wrap(self, network: PolicyNetwork, vocabulary: Vocabulary) -> NetworkPolicy:
        """The policy, sharpened."""
        with torch.no_grad():
            network.output.weight.mul_(self.config.sharpness)
            network.output.bias.mul_(self.config.sharpness)
        return NetworkPolicy(network, vocabulary)
