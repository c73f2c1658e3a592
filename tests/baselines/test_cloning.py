"""Optimal policy cloning: it fits the optimal action probabilities, and acts by them."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from lcrl_bench.baselines.cloning.method import Cloning, CloningConfig
from task_samples import sample_train_set

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.success import success_probability
from lcrl_bench.methods.contract import TrainSet
from lcrl_bench.methods.learned import ask
from lcrl_bench.panoramas import ObservedHouse

CPU = torch.device("cpu")


def fit(config: CloningConfig, train: TrainSet):
    return Cloning(config).fit(
        train, generator=torch.Generator().manual_seed(0), device=CPU, log=lambda _: None
    )


def success(learned, train: TrainSet) -> float:
    rates = []
    for tasks in train.tasks:
        answers = ask(learned, ObservedHouse.of(tasks.views), tasks.commands)
        policy = answers.policy(tasks.panoramas, tasks.held, tasks.commands)[:, None]
        policy = policy.expand(-1, tasks.horizon, -1, -1)
        rates.append(success_probability(tasks, policy))
    return float(torch.cat(rates).mean())


def test_it_says_what_it_is_handed():
    assert Cloning.expert
    assert not Cloning.oracle


def test_it_learns_to_act_in_the_training_houses_and_sharper_is_surer():
    train = sample_train_set(0, oracle=True)
    config = CloningConfig(passes=150, least_steps=0, sharpness=1.0)
    plain, sharp = fit(config, train), fit(replace(config, sharpness=4.0), train)
    untrained = fit(CloningConfig(passes=1, least_steps=0, learning_rate=1e-12), train)
    assert success(plain, train) > success(untrained, train) + 0.3
    tasks = train.tasks[0]
    logits = [each.logits(tasks.views, tasks.commands) for each in (plain, sharp)]
    torch.testing.assert_close(logits[1], 4.0 * logits[0], rtol=1e-4, atol=1e-4)


def test_without_the_optimum_it_can_not_be_trained():
    train = sample_train_set(0, houses=1)
    blind = tuple(replace(tasks, expert=None) for tasks in train.tasks)
    with pytest.raises(UsageError, match="optimal action probabilities"):
        fit(CloningConfig(passes=1, least_steps=0), replace(train, tasks=blind))


@pytest.mark.parametrize("bad", [{"coverage": 1.5}, {"sharpness": 0.0}])
def test_settings_out_of_range_are_refused(bad):
    with pytest.raises(UsageError, match=r"coverage must lie|sharpness must be"):
        CloningConfig(**bad)
