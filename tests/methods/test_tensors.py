"""Rewards and policies of tensors: saved and read back to the bit, damage is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch
from task_samples import sample_train_set

from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.methods.tensors import TensorPolicy, TensorReward

TENSORS = {
    "weights": torch.rand(3, 5, generator=torch.Generator().manual_seed(0)),
    "half": torch.tensor([0.5, -2.0], dtype=torch.float16),
    "counts": torch.arange(6).view(2, 3).T,
    "of no axis": torch.tensor(True),
}
SETTINGS = {"temperature": 0.5, "names": ("cup", "bed"), "more": {"depth": 2}}


class Worth(TensorReward):
    def score(self, views, commands):
        worth = self.to(views.views.device).tensors["worth"]
        seen = worth[views.views.long()].mean((1, 2))[views.panorama_views].sum(1)
        return seen.expand(len(commands), -1)


class Still(TensorPolicy):
    def logits(self, views, commands):
        return torch.zeros(len(commands), len(views.panorama_views), 2, 4, 4)


KINDS = [Worth, Still]


@pytest.mark.parametrize("kind", KINDS)
def test_tensors_and_settings_are_read_back_to_the_bit(tmp_path: Path, kind):
    learned = kind(TENSORS, SETTINGS)
    learned.save(tmp_path / "model")
    again = kind.load(tmp_path / "model")
    assert isinstance(again, kind)
    assert again.tensors.keys() == TENSORS.keys()
    for name, tensor in TENSORS.items():
        assert again.tensors[name].dtype == tensor.dtype
        assert torch.equal(again.tensors[name], tensor)
    assert again.settings == learned.settings


def test_what_is_read_back_scores_as_what_was_saved(tmp_path: Path):
    views = sample_train_set(0, houses=1).tasks[0].views
    weights = torch.nn.Parameter(torch.linspace(0, 1, 64))
    learned = Worth({"worth": weights})
    learned.save(tmp_path)
    scores = learned.score(views, ("go", ""))
    assert not scores.requires_grad
    assert torch.equal(Worth.load(tmp_path).score(views, ("go", "")), scores)


def test_tensors_that_share_memory_are_saved_each_as_it_is(tmp_path: Path):
    whole = torch.arange(4.0)
    Worth({"whole": whole, "part": whole[1:3]}).save(tmp_path)
    assert Worth.load(tmp_path).tensors["part"].tolist() == [1.0, 2.0]
    assert (tmp_path / "tensors.safetensors").stat().st_size < 400


def test_there_may_be_nothing_to_save(tmp_path: Path):
    Still().save(tmp_path)
    assert Still.load(tmp_path).tensors == {}


@pytest.mark.parametrize("bad", [{"device": torch.device("cpu")}, {"limit": float("nan")}])
def test_settings_that_json_does_not_have_are_refused_before_anything_is_trained(bad):
    with pytest.raises(UsageError, match="settings of Worth can't be saved as JSON"):
        Worth({}, bad)


def test_half_a_folder_is_refused(tmp_path: Path):
    with pytest.raises(InvalidFileError, match=r"config\.json: no such file"):
        Worth.load(tmp_path)
    Worth(TENSORS).save(tmp_path)
    (tmp_path / "tensors.safetensors").unlink()
    with pytest.raises(InvalidFileError, match=r"tensors\.safetensors: can't be read.*Train it"):
        Worth.load(tmp_path)


def test_damaged_tensors_are_refused(tmp_path: Path):
    Worth(TENSORS).save(tmp_path)
    path = tmp_path / "tensors.safetensors"
    path.write_bytes(path.read_bytes()[:-3])
    with pytest.raises(InvalidFileError, match=r"tensors\.safetensors: can't be read"):
        Worth.load(tmp_path)


@pytest.mark.parametrize("text", ["[]", "{}", '{"settings": 3, "tensors": []}'])
def test_a_configuration_of_something_else_is_refused(tmp_path: Path, text):
    Worth(TENSORS).save(tmp_path)
    (tmp_path / "config.json").write_text(text)
    with pytest.raises(InvalidFileError, match=r"config\.json: not the settings of saved tensors"):
        Worth.load(tmp_path)


def test_tensors_of_another_model_are_refused(tmp_path: Path):
    Worth(TENSORS).save(tmp_path)
    path = tmp_path / "config.json"
    document = json.loads(path.read_text())
    document["tensors"].append("bias")
    path.write_text(json.dumps(document))
    with pytest.raises(InvalidFileError, match=r"config\.json beside it names .*'bias'"):
        Worth.load(tmp_path)
