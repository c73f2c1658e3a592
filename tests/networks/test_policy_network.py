"""The policy network: the paper's product of four embeddings, state by state."""

from __future__ import annotations

import pytest
import torch
from task_samples import sample_train_set
from torch.nn import functional
from view_samples import assert_same_gradients

from lcrl_bench.methods.contract import TaskSet
from lcrl_bench.networks.grounding import HouseIndex, NetworkConfig, build_index
from lcrl_bench.networks.policy_network import PolicyNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

FUSIONS = ["mult", "add", "concat"]


def make(config: NetworkConfig, seed: int = 0) -> tuple[PolicyNetwork, HouseIndex, TaskSet]:
    """A network, and a house's PICK tasks to ask it about."""
    train = sample_train_set(1, houses=1)
    house = train.houses[0]
    generator = torch.Generator().manual_seed(seed)
    words = len(Vocabulary.of(train.vocabulary))
    network = PolicyNetwork(config, words=words, generator=generator).double()
    seen = house[0].views
    index = build_index(seen.views, seen.panorama_views, config)
    return network, index, house[1]


def asked(network: PolicyNetwork, index: HouseIndex, tasks: TaskSet) -> torch.Tensor:
    tokens, lengths = vocabulary().encode(tasks.commands)
    return network(index, tasks.panoramas, tasks.held, tokens, lengths)


def vocabulary() -> Vocabulary:
    return Vocabulary.of(sample_train_set(1, houses=1).vocabulary)


@pytest.mark.parametrize("fusion", FUSIONS)
@pytest.mark.parametrize("image", ["pooling", "film"])
def test_logits_are_the_network_of_the_product_of_all_embeddings(fusion, image):
    network, index, tasks = make(NetworkConfig(fusion=fusion, image=image))
    found = asked(network, index, tasks)
    assert found.shape == (*tasks.panoramas.shape, 4, 4)
    tokens, lengths = vocabulary().encode(tasks.commands)
    fused = network.ground(
        network.encode(index), tasks.panoramas, network.embed_commands(tokens, lengths)
    )
    # Laid out in full, as the paper writes it: one product a state.
    product = fused[:, :, None] * network.heading * network.held[tasks.held.long()][:, :, None]
    expected = network.output(functional.relu(network.hidden(product)))
    torch.testing.assert_close(found, expected)
    assert_same_gradients(found, expected, dict(network.named_parameters()))


def test_heading_and_hand_are_told_apart():
    network, index, tasks = make(NetworkConfig())
    logits = asked(network, index, tasks)
    north, east = logits[:, :, 0], logits[:, :, 1]
    assert float((north - east).detach().abs().max()) > 1e-6
    tokens, lengths = vocabulary().encode(tasks.commands)
    other = network(index, tasks.panoramas, ~tasks.held, tokens, lengths)
    assert bool(((logits - other).abs().amax((2, 3)) > 0).all())


def test_products_keep_the_scale_of_what_they_multiply():
    network, _, _ = make(NetworkConfig())
    scale = network.heading[:, None] * network.held[None]
    assert 0.7 < float(scale.detach().square().mean().sqrt()) < 1.6
    assert float((scale.detach().abs() < 0.1).double().mean()) < 0.1


@pytest.mark.parametrize("held", [False, True])
def test_cloning_a_policy_lowers_its_cross_entropy(held):
    train = sample_train_set(2, houses=1, oracle=False)
    house = train.houses[0]
    tasks = house[int(held)]
    assert bool(tasks.held.any()) is held
    assert tasks.expert is not None
    words = Vocabulary.of(train.vocabulary)
    network = PolicyNetwork(
        NetworkConfig(), words=len(words), generator=torch.Generator().manual_seed(0)
    )
    index = build_index(tasks.views.views, tasks.views.panorama_views, network.config)
    target = tasks.expert.view(*tasks.panoramas.shape, 4, 4).float()
    optimizer = torch.optim.Adam(network.parameters(), lr=5e-3)
    losses = []
    for _ in range(60):
        logits = network(index, tasks.panoramas, tasks.held, *words.encode(tasks.commands))
        loss = -(target * logits.log_softmax(-1)).sum(-1).mean()
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.8 * losses[0]
