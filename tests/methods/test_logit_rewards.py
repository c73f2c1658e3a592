"""Rewards made of a discriminator's logit."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch

from lcrl_bench.errors import InvalidFileError, UnknownNameError
from lcrl_bench.methods.logit_rewards import reward_of_logit
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.networks.grounding import NetworkConfig
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

LOGITS = torch.linspace(-6, 6, 25, dtype=torch.float64)
PROBABILITY = 1 / (1 + (-LOGITS).exp())


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("logit", PROBABILITY.log() - (1 - PROBABILITY).log()),
        ("softplus", -(1 - PROBABILITY).log()),
        ("log-sigmoid", PROBABILITY.log()),
        ("probability", PROBABILITY),
        ("binary", (PROBABILITY > 0.5).double()),
    ],
)
def test_a_reward_is_the_function_of_the_probability_it_is_named_for(name, expected):
    torch.testing.assert_close(reward_of_logit(name, LOGITS), expected)


def test_more_likely_the_expert_never_pays_less():
    for name in ("logit", "softplus", "log-sigmoid", "probability", "binary"):
        assert bool((reward_of_logit(name, LOGITS).diff() >= 0).all()), name


def test_an_unknown_reward_is_refused_with_the_valid_ones():
    with pytest.raises(UnknownNameError, match="softplus"):
        reward_of_logit("hinge", LOGITS)


def test_a_saved_reward_keeps_what_it_makes_of_the_output_and_refuses_nonsense(tmp_path: Path):
    config = NetworkConfig(classes=5)
    network = RewardNetwork(config, words=3, generator=torch.Generator().manual_seed(0))
    NetworkReward(network, Vocabulary(("go", "bed")), transform="softplus").save(tmp_path)
    assert NetworkReward.load(tmp_path).transform == "softplus"
    file = tmp_path / "config.json"
    file.write_text(file.read_text().replace("softplus", "hinge"))
    with pytest.raises(InvalidFileError, match="'hinge' is not a reward"):
        NetworkReward.load(tmp_path)
