"""GAIL-Exact: its loss is the discriminator's, its start is LC-RL's, its reward solves tasks."""

from __future__ import annotations

import pytest
import torch
from lcrl_bench.baselines.gail_exact.method import GailExact, GailExactConfig
from lcrl_bench.baselines.lcrl.method import LcRl, LcRlConfig
from task_samples import cell_rewards, sample_train_set, with_goals

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.success import success_probability
from lcrl_bench.methods.contract import TrainSet
from lcrl_bench.methods.network_method import network_config
from lcrl_bench.methods.preparation import PreparedHouse, prepare_house
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

CPU = torch.device("cpu")


def start(train: TrainSet) -> tuple[RewardNetwork, PreparedHouse]:
    """A network whose score is 0 everywhere, and a house."""
    sizes, vocabulary = network_config(GailExactConfig(), train), Vocabulary.of(train.vocabulary)
    generator = torch.Generator().manual_seed(0)
    network = RewardNetwork(sizes, words=len(vocabulary), generator=generator)
    with torch.no_grad():
        network.output.weight.zero_()
        network.output.bias.zero_()
    return network, prepare_house(train.houses[0], vocabulary, sizes, CPU)


def surrogate(method: GailExact | LcRl, network: RewardNetwork, house: PreparedHouse):
    features = network.encode(house.index)
    commands = network.embed_commands(house.tokens, house.lengths)
    return method.objective(network, features, commands, house)


def gradients(network: RewardNetwork, loss: torch.Tensor) -> list[torch.Tensor]:
    network.zero_grad()
    loss.backward()
    return [torch.zeros_like(p) if p.grad is None else p.grad for p in network.parameters()]


def test_at_an_undecided_discriminator_the_gradient_is_half_of_lcrls():
    network, house = start(sample_train_set(0))
    ours = gradients(network, surrogate(GailExact(), network, house)[0])
    theirs = gradients(network, surrogate(LcRl(LcRlConfig()), network, house)[0])
    assert any(bool(gradient.any()) for gradient in ours)
    for half, whole in zip(ours, theirs, strict=True):
        torch.testing.assert_close(2 * half, whole, rtol=1e-4, atol=1e-6)


def test_an_undecided_discriminator_loses_two_bits_a_task():
    network, house = start(sample_train_set(1))
    loss = surrogate(GailExact(), network, house)[1]
    assert loss == pytest.approx(2 * torch.tensor(2.0).log().item(), rel=1e-4)


@pytest.mark.parametrize("reward", ["softplus", "logit"])
def test_the_reoptimised_reward_solves_the_training_tasks(reward):
    train, truth = sample_train_set(0), sample_train_set(0, oracle=True)
    config = GailExactConfig(passes=100, least_steps=0, reward=reward)
    learned = GailExact(config).fit(
        train, generator=torch.Generator().manual_seed(0), device=CPU, log=lambda _: None
    )
    rates = []
    for tasks, batch in with_goals(train, truth):
        scores = cell_rewards(learned, tasks)
        if reward == "softplus":
            assert float(scores.min()) >= 0.0
        rates.append(success_probability(batch, q_iteration(batch, scores.double()).policy))
    assert float(torch.cat(rates).mean()) >= 0.8


def test_a_temperature_of_zero_is_refused():
    with pytest.raises(UsageError, match="temperature must be positive"):
        GailExactConfig(temperature=0.0)
