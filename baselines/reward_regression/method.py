"""Reward regression: fit the true reward. An oracle, and the upper bound of the paper's tables.

    minimise   mean over tasks of  sum_s w(s) (r_theta(o, L) - r(s))^2

with r(s) = 10 at the goal and 0 elsewhere. What is seen does not always tell whether the goal holds
(the object is where it belongs, but in another room), so the best fit is the w-mean of the true
reward over the states that look alike. The weight w mixes three distributions: where the optimum
goes, where the policy of the reward as it stands goes, and all states alike.

Source: Fu et al. (2019), section "Experimental Procedure": "we can also regress directly onto the
ground-truth rewards, a method we label as 'Reward Regression'". The weights are ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.maximum_entropy import soft_marginals
from lcrl_bench.methods.contract import TaskSet
from lcrl_bench.methods.network_method import NetworkMethod
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, TrainingConfig
from lcrl_bench.networks.reward_network import RewardNetwork

SUCCESS_REWARD: Final = 10.0
"""Source: Fu et al. (2019), appendix "Experiment Hyperparameters"."""


@dataclass(frozen=True)
class RewardRegressionConfig(TrainingConfig):
    """Settings of reward regression."""

    passes: int = 80
    """Passes over the training houses; one step of Adam per house."""
    weight_decay: float = 0.2
    """AdamW's decoupled weight decay, relative to the learning rate."""
    dropout: float = 0.1
    """Fraction of the image features left out of each step, in [0, 1)."""
    expert_share: float = 0.4
    """Fraction of the weight on what the optimal policy visits."""
    learner_share: float = 0.4
    """Fraction on what the soft policy of the learned reward visits, where its mistakes show."""
    temperature: float = 1.0
    """Temperature of that policy, in units of reward."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        shares = (self.expert_share, self.learner_share)
        if min(shares) < 0 or sum(shares) > 1:
            raise UsageError("expert_share and learner_share must not be negative, nor exceed 1.")
        if not self.temperature > 0:
            raise UsageError("temperature must be positive.")


class RewardRegression(NetworkMethod[RewardRegressionConfig, RewardNetwork]):
    """Least squares on the true reward."""

    oracle = True
    expert = True
    learns = NetworkReward
    Config: ClassVar[type[RewardRegressionConfig]] = RewardRegressionConfig
    presets: ClassVar = {
        "paper": {**PAPER_TRAINING, "mirror": False, "expert_share": 0.0, "learner_share": 0.0}
    }

    def objective(
        self,
        network: RewardNetwork,
        features: torch.Tensor,
        commands: torch.Tensor,
        house: PreparedHouse,
    ) -> tuple[torch.Tensor, float]:
        """The weighted mean squared error on all tasks of a house."""
        loss = features.new_zeros(())
        for tasks, said in house.with_commands(commands):
            scores = network.score(features, tasks.panoramas, said)
            error = (scores - tasks.goal * SUCCESS_REWARD).square()
            loss = loss + (self._weight(tasks, scores.detach()) * error).sum()
        return loss / house.count, float(loss.detach()) / house.count

    def _weight(self, tasks: TaskSet, scores: torch.Tensor) -> torch.Tensor:
        """w: float [task, cell]; sums to 1 per task."""
        config = self.config
        if tasks.expert_occupancy is None:
            raise UsageError("Reward regression needs the optimal action probabilities.")
        weight = config.expert_share * fold_cells(tasks.expert_occupancy)
        if config.learner_share:
            learner = soft_marginals(tasks, scores, temperature=config.temperature)
            weight = weight + config.learner_share * learner.occupancy / tasks.occupancy_mass
        rest = 1.0 - config.expert_share - config.learner_share
        return weight + rest / tasks.cells
