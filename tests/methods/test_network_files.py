"""Rewards and policies of networks: saved and read back, in parts as at once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import pytest
import torch
from task_samples import sample_train_set

from lcrl_bench.errors import InvalidFileError, LcrlError
from lcrl_bench.methods import encoded_houses
from lcrl_bench.methods.network_policy import NetworkPolicy
from lcrl_bench.methods.network_reward import NetworkReward
from lcrl_bench.networks.grounding import ImageName, NetworkConfig
from lcrl_bench.networks.policy_network import PolicyNetwork
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

KINDS = [NetworkReward, NetworkPolicy]
IMAGES = get_args(ImageName)


def make(kind: type, image: ImageName = "pooling") -> NetworkReward | NetworkPolicy:
    vocabulary = Vocabulary.of(sample_train_set(0, houses=1).vocabulary)
    config, generator = NetworkConfig(image=image), torch.Generator().manual_seed(3)
    if kind is NetworkReward:
        network = RewardNetwork(config, words=len(vocabulary), generator=generator)
        return NetworkReward(network, vocabulary)
    return NetworkPolicy(
        PolicyNetwork(config, words=len(vocabulary), generator=generator), vocabulary
    )


def asked(
    learned: NetworkReward | NetworkPolicy, commands: Sequence[str] | None = None
) -> torch.Tensor:
    tasks = sample_train_set(0, houses=1).tasks[1]
    said = tasks.commands if commands is None else commands
    if isinstance(learned, NetworkReward):
        return learned.score(tasks.views, said)
    return learned.logits(tasks.views, said)


@pytest.mark.parametrize("image", IMAGES)
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_saved_is_read_back_to_the_bit(tmp_path: Path, kind, image):
    learned = make(kind, image)
    learned.save(tmp_path)
    again = kind.load(tmp_path)
    assert again.network.config == learned.network.config
    assert again.vocabulary == learned.vocabulary
    assert torch.equal(asked(again), asked(learned))
    assert not any(parameter.requires_grad for parameter in again.network.parameters())


@pytest.mark.parametrize("kind", KINDS)
def test_commands_in_parts_are_answered_as_at_once(monkeypatch: pytest.MonkeyPatch, kind):
    learned = make(kind)
    whole = asked(learned)
    monkeypatch.setattr(encoded_houses, "_NUMBERS_AT_ONCE", 1)
    torch.testing.assert_close(asked(learned), whole)
    assert asked(learned, ()).shape == whole[:0].shape


def test_a_policy_is_no_reward(tmp_path: Path):
    make(NetworkPolicy).save(tmp_path)
    with pytest.raises(InvalidFileError, match="can't be read as the weights of this reward"):
        NetworkReward.load(tmp_path)


@pytest.mark.parametrize("kind", KINDS)
def test_settings_of_before_there_was_a_choice_are_those_of_the_paper(tmp_path: Path, kind):
    learned = make(kind)
    learned.save(tmp_path)
    path = tmp_path / "config.json"
    document = json.loads(path.read_text())
    for name in ("image", "views", "height", "width"):
        del document["network"][name]
    path.write_text(json.dumps(document))
    assert kind.load(tmp_path).network.config == NetworkConfig()


@pytest.mark.parametrize("bad", [{"filters": "many"}, {"colour": 3}, {"image": "eye"}])
def test_settings_that_no_network_has_are_refused(tmp_path: Path, bad):
    make(NetworkReward).save(tmp_path)
    path = tmp_path / "config.json"
    document = json.loads(path.read_text())
    document["network"] |= bad
    path.write_text(json.dumps(document))
    with pytest.raises(LcrlError, match=r"not a reward|Unknown image encoder"):
        NetworkReward.load(tmp_path)


def test_what_is_seen_in_a_house_is_computed_once(monkeypatch: pytest.MonkeyPatch):
    learned, calls = make(NetworkPolicy), []
    encode = learned.network.encode
    monkeypatch.setattr(learned.network, "encode", lambda index: calls.append(1) or encode(index))
    first, second = asked(learned), asked(learned)
    assert torch.equal(first, second)
    assert len(calls) == 1
    with torch.no_grad():
        learned.network.output.bias.add_(1.0)
    assert not torch.equal(asked(learned), first)
    assert len(calls) == 2
