"""Reward regression: fit the true reward. An oracle, and the upper bound of the paper's tables.

    minimise   mean over tasks and cells of  w(s) (r_theta(o, L) - r(s))^2

with r(s) = 10 at the goal and 0 elsewhere.

What is seen does not always tell whether the goal holds (an object moved to another room), so the
best fit is the mean of the true reward over the cells that look alike.

Source: Fu et al. (2019), section "Experimental Procedure": "we can also regress directly onto the
ground-truth rewards, a method we label as 'Reward Regression'".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.methods.network_method import RewardMethod
from lcrl_bench.methods.preparation import PreparedHouse
from lcrl_bench.methods.training import PAPER_TRAINING, TrainingConfig
from lcrl_bench.networks.reward_network import RewardNetwork

SUCCESS_REWARD: Final = 10.0
"""Source: Fu et al. (2019), appendix "Experiment Hyperparameters"."""


@dataclass(frozen=True)
class RewardRegressionConfig(TrainingConfig):
    """Settings of reward regression."""

    goal_weight: float = 1.0
    """w at the goal; 1 elsewhere. Few cells are goals, so more than 1 balances the two."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        super().__post_init__()
        if not self.goal_weight > 0:
            raise UsageError("goal_weight must be positive.")


class RewardRegression(RewardMethod[RewardRegressionConfig]):
    """Least squares on the true reward."""

    oracle = True
    Config: ClassVar[type[RewardRegressionConfig]] = RewardRegressionConfig
    presets: ClassVar = {"paper": {**PAPER_TRAINING, "goal_weight": 1.0}}

    def objective(self, network: RewardNetwork, house: PreparedHouse) -> tuple[torch.Tensor, float]:
        """The weighted mean squared error on all tasks of a house."""
        features = network.encode(house.index)
        commands = network.embed_commands(house.tokens, house.lengths)
        loss = features.new_zeros(())
        for tasks in house.tasks:
            goal = tasks.batch.goal
            scores = network.score(features, tasks.panoramas, commands[tasks.rows])
            error = (scores - goal * SUCCESS_REWARD).square()
            weight = torch.where(goal, self.config.goal_weight, 1.0)
            loss = loss + ((weight * error).sum(1) / weight.sum(1)).sum()
        return loss / house.count, float(loss.detach()) / house.count
