"""The nine architectures of the paper's sweep, and both ways to combine views: all learn."""

from __future__ import annotations

from itertools import product
from typing import get_args

import pytest
import torch
from task_samples import sample_train_set
from view_samples import assert_same_gradients, dense_maps, sample_panoramas, sample_views

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.networks.fusion import FusionName, ViewsName, gather_panoramas
from lcrl_bench.networks.gathering import Bags
from lcrl_bench.networks.grounding import ImageName, NetworkConfig, build_index
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

IMAGES, FUSIONS, VIEWS = get_args(ImageName), get_args(FusionName), get_args(ViewsName)
ARCHITECTURES = [
    NetworkConfig(image=image, fusion=fusion, views=views)
    for image, fusion, views in product(IMAGES, FUSIONS, VIEWS)
]


def make(config: NetworkConfig, words: int = 5) -> RewardNetwork:
    return RewardNetwork(config, words=words, generator=torch.Generator().manual_seed(0))


def label(config: NetworkConfig) -> str:
    return f"{config.image}-{config.fusion}-{config.views}"


@pytest.mark.parametrize("config", ARCHITECTURES, ids=label)
def test_every_architecture_learns_where_a_thing_is(config):
    train = sample_train_set(0, houses=1, oracle=True)
    tasks = train.tasks[0]
    vocabulary = Vocabulary.of(train.vocabulary)
    network = make(config, len(vocabulary))
    index = build_index(tasks.views.views, tasks.views.panorama_views, config)
    truth = tasks.goal.float()
    before = {name: value.clone() for name, value in network.state_dict().items()}
    optimizer = torch.optim.Adam(network.parameters(), lr=5e-3)
    losses = []
    for _ in range(25):
        scores = network(index, tasks.panoramas, *vocabulary.encode(tasks.commands))
        assert scores.shape == truth.shape
        loss = torch.nn.functional.binary_cross_entropy_with_logits(scores, truth)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.6 * losses[0]
    after = network.state_dict()
    assert all(not torch.equal(before[name], after[name]) for name in after), "all weights moved"


def test_a_maximum_over_the_views_is_one_global_maximum_over_the_panorama():
    views, panoramas = sample_views(1), sample_panoramas(1)
    encoder = PanoramaEncoder(61, generator=torch.Generator().manual_seed(1)).double()
    network = make(NetworkConfig(views="max")).double()
    network.image = encoder
    found = network.encode(build_index(views, panoramas, network.config))
    first = encoder.first_weight, encoder.first_bias
    maps = dense_maps(views, first, (encoder.second_weight, encoder.second_bias))
    expected = maps.relu()[panoramas].amax((1, 3, 4))
    torch.testing.assert_close(found, expected)
    assert_same_gradients(found, expected, dict(encoder.named_parameters()))


def test_the_views_of_a_panorama_have_no_order():
    embeddings = torch.randn(6, 3, generator=torch.Generator().manual_seed(0))
    panoramas = torch.tensor([[0, 1, 2, 5], [3, 3, 4, 1]])
    turned = panoramas.roll(1, 1)
    for views in VIEWS:
        one, other = (
            gather_panoramas(views, embeddings, Bags.of(index, size=6))
            for index in (panoramas, turned)
        )
        torch.testing.assert_close(one, other)
    summed = gather_panoramas("sum", embeddings, Bags.of(panoramas, size=6))
    torch.testing.assert_close(summed, embeddings[panoramas].sum(1))


@pytest.mark.parametrize("image", ["pooling", "film"])
def test_pooling_and_film_see_views_of_any_size(image):
    network = make(NetworkConfig(image=image))
    index = build_index(sample_views(2, height=64, width=64), sample_panoramas(2), network.config)
    panoramas, tokens = torch.zeros(1, 3, dtype=torch.int64), torch.ones(1, 2, dtype=torch.int64)
    assert network(index, panoramas, tokens, torch.tensor([2])).shape == (1, 3)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"image": "poolin"}, "Did you mean 'pooling'"),
        ({"views": "mean"}, "Valid: max, sum"),
        ({"fusion": "multiply"}, "Valid: add, concat, mult"),
    ],
)
def test_an_unknown_part_lists_the_known_ones(changed, message):
    with pytest.raises(UnknownNameError, match=message):
        make(NetworkConfig(**changed))
