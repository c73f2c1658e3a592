"""A run's model is read back by the class that its method names, which is what `fit` returned."""

from __future__ import annotations

from pathlib import Path

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_problems
from lcrl_bench.evaluation.learned import load_reward
from noise_method import Noise, NoiseMethod

from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.run import RunRequest, SeedResult, run_seed
from lcrl_bench.methods.contract import Method
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.tensors import TensorPolicy

NOISE = f"{Path(__file__).parents[1] / 'noise_method.py'}:NoiseMethod"


class Idle(TensorPolicy):
    def logits(self, views, commands):
        return torch.zeros(len(commands), len(views.panorama_views), 2, 4, 4)


class Mistaken(NoiseMethod):
    learns = Idle


def run(name: str, method: type[Method], out: Path) -> SeedResult:
    request = RunRequest(name, method, tiny_benchmark(), out)
    return run_seed(request, tiny_problems(), 0)


def test_what_was_learned_is_read_back_to_the_bit(tmp_path: Path):
    found = run(NOISE, resolve_method(NOISE), tmp_path)
    again = load_reward(found.folder.path)
    assert type(again).__name__ == Noise.__name__
    views, said = tiny_problems()[0].observed.views, ("go to the bed", "")
    assert torch.equal(again.score(views, said), found.learned.score(views, said))


def test_a_method_that_learns_something_else_than_it_says_is_refused(tmp_path: Path):
    with pytest.raises(UsageError, match="fit returned a Noise, but learns = Idle"):
        run("mistaken", Mistaken, tmp_path)
    assert not list(tmp_path.rglob("model*"))
