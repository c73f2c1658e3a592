"""Optimal policy cloning: a policy of panorama, heading, held and command, fitted to the optimum.

Letters: pi*(a|s) optimal action probabilities, uniform over equally short ways; pi_theta the
network's, of what is seen, heading, held and command; w(s) a weight.

    minimise   - mean over tasks of  sum_s w(s) sum_a pi*(a|s) log pi_theta(a|s)

Source: Fu et al. (2019), section "Experimental Procedure": "We train the optimal cloning baseline
by computing the exact optimal policy using Q-iteration, and perform supervised learning to regress
directly on to the optimal action probabilities."
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.methods.contract import TaskSet
from lcrl_bench.methods.network_method import HouseObjective, NetworkMethod
from lcrl_bench.methods.network_policy import NetworkPolicy
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, Row, TrainingConfig
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

    def lessons(
        self, network: PolicyNetwork, houses: Sequence[PreparedHouse], generator: torch.Generator
    ) -> tuple[HouseObjective, None]:
        """The weighted cross-entropy on all tasks of a house, in nats, where it has any weight."""
        given = [[_lesson(tasks, self.config.coverage) for tasks in h.tasks] for h in houses]

        def objective(
            number: int, features: torch.Tensor, commands: torch.Tensor
        ) -> tuple[torch.Tensor, Row]:
            house, loss = houses[number], features.new_zeros(())
            parts = zip(given[number], house.with_commands(commands), strict=True)
            for lesson, (_, said) in parts:
                logits = network.logits(features, lesson.panoramas, lesson.held, said)
                # -sum_a pi(a) log p(a), as the probabilities of the actions sum to one.
                entropy = logits.logsumexp(-1) - (lesson.expert * logits).sum(-1)
                loss = loss + (lesson.weight * entropy).sum()
            return loss / house.count, {"loss": float(loss.detach()) / house.count}

        return objective, None

    def wrap(self, network: PolicyNetwork, vocabulary: Vocabulary) -> NetworkPolicy:
        """The policy, sharpened."""
        with torch.no_grad():
            network.output.weight.mul_(self.config.sharpness)
            network.output.bias.mul_(self.config.sharpness)
        return NetworkPolicy(network, vocabulary)


@dataclass(frozen=True)
class _Lesson:
    """What is cloned of some tasks: the cells in which any state has weight."""

    panoramas: torch.Tensor
    """int64 [task, cell]."""
    held: torch.Tensor
    """bool [task, cell]."""
    expert: torch.Tensor
    """float [task, cell, heading, action]: the optimal action probabilities."""
    weight: torch.Tensor
    """float [task, cell, heading]; sums to 1 per task."""


def _lesson(tasks: TaskSet, coverage: float) -> _Lesson:
    """The cells with weight of each task; tasks with fewer are filled up with cells without."""
    if tasks.expert is None or tasks.expert_occupancy is None:
        raise UsageError("Cloning needs the optimal action probabilities.")
    weight = (1 - coverage) * tasks.expert_occupancy + coverage / tasks.states
    weight = weight.unflatten(1, (-1, HEADINGS))
    weighs = weight.sum(-1) > 0
    order = weighs.to(torch.int8).argsort(dim=1, descending=True, stable=True)
    kept = order[:, : int(weighs.sum(1).max())]
    row = torch.arange(len(tasks), device=kept.device)[:, None]
    return _Lesson(
        panoramas=tasks.panoramas[row, kept],
        held=tasks.held[row, kept],
        expert=tasks.expert.unflatten(1, (-1, HEADINGS))[row, kept],
        weight=weight[row, kept],
    )
