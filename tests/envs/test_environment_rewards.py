"""A learned reward is paid as it scores, once a task, from the run that learned it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from environment_samples import CountingReward, sample_benchmark

from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.envs.environment import HouseEnvironment
from lcrl_bench.errors import InvalidFileError, UnknownNameError, UsageError
from lcrl_bench.evaluation.finished_runs import read_reward
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.run import run as train
from lcrl_bench.evaluation.session import Session, Workplace
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.learned import ask
from lcrl_bench.methods.tensors import TensorReward

CPU = torch.device("cpu")
METHOD = '''
import torch
from lcrl_bench.methods.contract import Method
from lcrl_bench.methods.tensors import TensorPolicy, TensorReward

class ClassSum(TensorReward):
    """Pays the sum of the class ids in sight."""
    def score(self, views, commands):
        seen = views.views.flatten(1).double().mean(1)[views.panorama_views].sum(1)
        return seen.expand(len(commands), -1)

class Anything(TensorPolicy):
    """Does anything."""
    def logits(self, views, commands):
        return torch.zeros(len(commands), len(views.panorama_views), 2, 4, 4)

class Chosen(Method):
    learns = ClassSum
    def fit(self, train, *, generator, device, log, checkpoint=None):
        return self.learns()

class Still(Method):
    learns = Anything
    fit = Chosen.fit
'''


class NowhereFinite(TensorReward):
    """Fails."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        return torch.full((len(commands), len(views)), float("nan"))


def make(**settings) -> HouseEnvironment:
    return HouseEnvironment(
        **{"benchmark": sample_benchmark(), "renderer": "rays", "split": None} | settings
    )


@pytest.fixture(scope="module")
def method(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with a method that learns a reward, and one that learns a policy."""
    path = tmp_path_factory.mktemp("methods") / "chosen.py"
    path.write_text(METHOD)
    return path


def run(method: Path, name: str, out: Path) -> Path:
    """The folder of a finished run."""
    session = Session(sample_benchmark(), Workplace(out, renderer="rays"))
    return train(RunSpec(f"{method}:{name}"), session).folder.path


def test_the_reward_of_a_run_is_paid_as_it_scores(method: Path, tmp_path: Path):
    folder = run(method, "Chosen", tmp_path)
    learned = read_reward(folder)
    environment = make(reward=str(folder))
    rng = np.random.default_rng(0)
    for tasks in load_task_sets(sample_benchmark(), device=CPU, renderer="rays"):
        commands = [task.command for task in tasks.tasks]
        scores = ask(learned, tasks.views.observed, commands).reward(tasks.panoramas, commands)
        for row, task in enumerate(tasks.tasks):
            environment.reset(options={"task": task.id})
            for _ in range(30):
                reward = environment.step(int(rng.integers(4)))[1]
                assert reward == float(scores[row, environment.state // 4])


def test_a_task_is_scored_once():
    reward = CountingReward()
    environment = make(reward=reward, houses_kept=1)
    environment.reset(seed=0)
    for _ in range(50):
        environment.reset()
    assert sorted(reward.scored) == sorted(task.command for task in sample_benchmark().tasks)


def test_a_policy_has_no_reward(method: Path, tmp_path: Path):
    with pytest.raises(UsageError, match="learned a policy"):
        make(reward=run(method, "Still", tmp_path))


def test_a_reward_that_is_no_number_is_refused():
    with pytest.raises(UsageError, match=r"'go to the bed' with a number that is not finite"):
        make(reward=NowhereFinite()).reset(options={"task": "rooms-a.go-to-the-bed"})


@pytest.mark.parametrize(
    ("config", "error", "words"),
    [
        (None, InvalidFileError, "no such file"),
        ({"settings": {}}, InvalidFileError, "not the configuration of a run"),
        ([], InvalidFileError, "not the configuration of a run"),
        ({"method": "lcrrl", "settings": {}}, UnknownNameError, "Did you mean 'lcrl'"),
        ({"method": "lcrl", "settings": {}}, InvalidFileError, "no such file"),
        ({"method": "lcrl", "settings": {}, "image_size": [8, 8]}, UsageError, "another size"),
    ],
)
def test_a_folder_that_is_no_run_says_why(config, error, words, tmp_path: Path):
    if config is not None:
        (tmp_path / "config.json").write_text(json.dumps(config))
    with pytest.raises(error, match=words):
        make(reward=tmp_path)


def test_a_reward_scores_the_houses_of_another_benchmark_too():
    other = replace(sample_benchmark(), name="other", tasks=sample_benchmark().tasks[:2])
    environment = make(benchmark=other, reward=CountingReward())
    environment.reset(options={"task": other.tasks[0].id})
    assert environment.step(0)[1] > 0
