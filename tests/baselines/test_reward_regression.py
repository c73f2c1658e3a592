"""Reward regression: an oracle that fits the true reward, and nothing else."""

from __future__ import annotations

import pytest
import torch
from lcrl_bench.baselines.reward_regression.method import (
    RewardRegression,
    RewardRegressionConfig,
)
from task_samples import SUCCESS_REWARD, cell_rewards, sample_train_set

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.success import success_probability

CPU = torch.device("cpu")


def fit(config: RewardRegressionConfig, *, oracle: bool = True):
    train = sample_train_set(0, oracle=oracle)
    rows = []
    learned = RewardRegression(config).fit(
        train, generator=torch.Generator().manual_seed(0), device=CPU, log=rows.append
    )
    return train, learned, rows


def test_it_says_that_it_is_an_oracle():
    assert RewardRegression.oracle


def test_scores_come_near_the_true_reward_and_solve_the_training_tasks():
    train, learned, rows = fit(RewardRegressionConfig(passes=250, least_steps=0))
    errors, rates = [], []
    for tasks in train.tasks:
        scores = cell_rewards(learned, tasks)
        # Of a PICK task one does not always see whether it is done.
        if tasks.commands[0].startswith("go"):
            errors.append((scores - tasks.goal * SUCCESS_REWARD).abs().mean())
        policy = q_iteration(tasks, scores.double()).policy
        rates.append(success_probability(tasks, policy))
    assert float(torch.stack(errors).mean()) < 1.0
    assert float(torch.cat(rates).mean()) >= 0.9
    assert rows[-1]["loss"] < 0.5 * rows[0]["loss"]


def test_without_goals_there_is_nothing_but_zero_to_learn():
    train, learned, _ = fit(RewardRegressionConfig(passes=150, least_steps=0), oracle=False)
    scores = cell_rewards(learned, train.tasks[0])
    assert float(scores.abs().max()) < 0.5


@pytest.mark.parametrize("bad", [{"expert_share": 0.7}, {"learner_share": -0.1}])
def test_shares_that_are_none_are_refused(bad):
    with pytest.raises(UsageError, match="must not be negative, nor exceed 1"):
        RewardRegressionConfig(**bad)
