"""The whole reward network: the paper's formula, each panorama encoded once."""

from __future__ import annotations

import pytest
import torch
from task_samples import sample_train_set

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.networks.fusion import fuse, fused_size
from lcrl_bench.networks.gathering import gather_rows
from lcrl_bench.networks.patches import build_patch_index
from lcrl_bench.networks.reward_network import RewardNetwork, RewardNetworkConfig
from lcrl_bench.networks.vocabulary import Vocabulary


@pytest.mark.parametrize("fusion", ["mult", "add", "concat"])
def test_a_score_is_the_fully_connected_network_of_the_fused_embeddings(fusion):
    train = sample_train_set(1, houses=1)
    house = train.houses[0]
    tasks = house[1]
    vocabulary = Vocabulary.of(train.vocabulary)
    network = RewardNetwork(
        RewardNetworkConfig(fusion=fusion),
        words=len(vocabulary),
        generator=torch.Generator().manual_seed(0),
    )
    index = build_patch_index(tasks.views.views, tasks.views.panorama_views, classes=61)
    tokens, lengths = vocabulary.encode(tasks.commands)
    scores = network(index, tasks.panoramas, tokens, lengths)
    assert scores.shape == tasks.panoramas.shape
    images, commands = network.encode(index), network.embed_commands(tokens, lengths)
    join = {
        "mult": lambda e, c: e * c,
        "add": lambda e, c: e + c,
        "concat": lambda e, c: torch.cat([e, c]),
    }[fusion]
    for task, cell in ((0, 0), (1, 20), (2, 47)):
        e = join(images[tasks.panoramas[task, cell]], commands[task])
        expected = network.output(torch.relu(network.hidden(e)))[0]
        torch.testing.assert_close(scores[task, cell], expected)


def test_an_unknown_fusion_lists_the_known_ones():
    with pytest.raises(UnknownNameError, match="Valid: add, concat, mult"):
        fuse("multiply", torch.zeros(2), torch.zeros(2))
    with pytest.raises(UnknownNameError, match="Did you mean 'concat'"):
        fused_size("concatt", 32)


def test_gathered_rows_send_their_gradients_back():
    table = torch.randn(5, 3, dtype=torch.float64, requires_grad=True)
    index = torch.tensor([[0, 4, 4], [2, 0, 4]])
    assert torch.autograd.gradcheck(lambda rows: gather_rows(rows, index), (table,))
    assert torch.equal(gather_rows(table, index), table[index])
