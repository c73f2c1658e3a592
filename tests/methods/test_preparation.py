"""What is prepared of a training house: its mirror image."""

from __future__ import annotations

from collections import Counter
from typing import get_args

import pytest
import torch
from task_samples import sample_train_set
from torch.testing import assert_close

from lcrl_bench.methods.preparation import PreparedHouse, prepare_house
from lcrl_bench.networks.fusion import ViewsName
from lcrl_bench.networks.grounding import ImageName, NetworkConfig, build_index
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

CPU = torch.device("cpu")


def prepared(config: NetworkConfig, *, mirror: bool) -> PreparedHouse:
    train = sample_train_set(0, houses=1)
    return prepare_house(
        train.houses[0], Vocabulary.of(train.vocabulary), config, CPU, mirror=mirror
    )


@pytest.mark.parametrize("views", get_args(ViewsName))
@pytest.mark.parametrize("image", get_args(ImageName))
def test_a_mirror_image_has_every_view_flipped_and_east_where_west_was(image, views):
    config = NetworkConfig(image=image, views=views)
    train = sample_train_set(0, houses=1)
    seen, words = train.tasks[0].views, len(Vocabulary.of(train.vocabulary))
    house = prepared(config, mirror=True)
    north, east, south, west = seen.panorama_views.unbind(1)
    swapped = torch.stack([north, west, south, east], 1)
    network = RewardNetwork(config, words=words, generator=torch.Generator().manual_seed(0))
    network.double()
    flipped = build_index(seen.views.flip(2), swapped, config)
    rewards = [
        score_first_tasks(network, house, network.encode(house.index, mirrored=True)),
        score_first_tasks(network, house, network.encode(flipped)),
    ]
    assert_close(*rewards)
    upright = score_first_tasks(network, house, network.encode(house.index))
    assert not torch.equal(rewards[0], upright)
    parameters = [each for each in network.parameters() if each.requires_grad]
    found, wanted = (torch.autograd.grad(reward.square().sum(), parameters) for reward in rewards)
    assert_close(found, wanted)


def score_first_tasks(
    network: RewardNetwork, house: PreparedHouse, features: torch.Tensor
) -> torch.Tensor:
    """The rewards of a house's first tasks: float [task, cell]."""
    commands = network.embed_commands(house.tokens, house.lengths)
    tasks, said = next(iter(house.with_commands(commands)))
    return network.score(features, tasks.panoramas, said)


def test_the_house_and_its_mirror_image_are_seen_alike_often():
    house = prepared(NetworkConfig(), mirror=True)
    generator = torch.Generator().manual_seed(0)
    seen = Counter(house.draw_mirrored(generator) for _ in range(1000))
    assert 450 < seen[True] < 550


def test_without_a_mirror_image_nothing_is_drawn():
    house = prepared(NetworkConfig(), mirror=False)
    generator = torch.Generator().manual_seed(0)
    before = generator.get_state()
    assert not house.draw_mirrored(generator)
    assert torch.equal(generator.get_state(), before)
