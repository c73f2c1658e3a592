"""What is prepared of a training house: its mirror image."""

from __future__ import annotations

from collections import Counter

import torch
from task_samples import sample_train_set
from torch.testing import assert_close

from lcrl_bench.methods.preparation import PreparedHouse, prepare_house
from lcrl_bench.networks.grounding import Grounding, NetworkConfig, build_index
from lcrl_bench.networks.vocabulary import Vocabulary

CPU = torch.device("cpu")


def prepared(config: NetworkConfig, *, mirror: bool) -> PreparedHouse:
    train = sample_train_set(0, houses=1)
    return prepare_house(
        train.houses[0], Vocabulary.of(train.vocabulary), config, CPU, mirror=mirror
    )


def test_a_mirror_image_has_every_view_flipped_and_east_where_west_was():
    # A fully connected encoder tells columns apart.
    config = NetworkConfig(image="fc")
    views = sample_train_set(0, houses=1).tasks[0].views
    mirrored = prepared(config, mirror=True).mirrored
    assert mirrored is not None
    north, east, south, west = views.panorama_views.unbind(1)
    swapped = torch.stack([north, west, south, east], 1)
    network = Grounding(config, words=3, generator=torch.Generator().manual_seed(0))
    wanted = build_index(views.views.flip(2), swapped, config)
    assert torch.equal(mirrored.panoramas.index, wanted.panoramas.index)
    assert_close(network.encode(mirrored), network.encode(wanted))
    assert not torch.equal(
        network.encode(mirrored), network.encode(prepared(config, mirror=True).index)
    )


def test_the_house_and_its_mirror_image_are_seen_alike_often():
    house = prepared(NetworkConfig(), mirror=True)
    generator = torch.Generator().manual_seed(0)
    seen = Counter(house.look(generator) is house.mirrored for _ in range(1000))
    assert 450 < seen[True] < 550


def test_without_a_mirror_image_nothing_is_drawn():
    house = prepared(NetworkConfig(), mirror=False)
    generator = torch.Generator().manual_seed(0)
    before = generator.get_state()
    assert house.mirrored is None
    assert house.look(generator) is house.index
    assert torch.equal(generator.get_state(), before)
