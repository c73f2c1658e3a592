"""A spec says how an environment was made, also as JSON, and makes it again."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import cloudpickle
import gymnasium
import numpy as np
import pytest
from environment_samples import CountingReward, sample_benchmark
from gymnasium.envs.registration import EnvSpec

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.envs.spec import HouseSpec
from lcrl_bench.errors import UsageError

HORIZON = 30


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample benchmark on disk."""
    path = tmp_path_factory.mktemp("benchmarks") / "rooms"
    write_benchmark(path, sample_benchmark())
    return path


def make(folder: Path, **settings) -> gymnasium.Env:
    ids = tuple(task.id for task in sample_benchmark().tasks[:3])
    arguments = {"benchmark": folder, "tasks": ids, "renderer": "rays"}
    return gymnasium.make(HOUSE_ID, **arguments | {"houses_kept": np.int64(2)} | settings)


def test_the_horizon_is_the_longest_episode():
    assert gymnasium.spec(HOUSE_ID).max_episode_steps == HORIZON
    one = gymnasium.make(HOUSE_ID, benchmark=sample_benchmark())
    assert one.spec is not None
    assert one.spec.max_episode_steps == HORIZON
    many = gymnasium.make_vec(HOUSE_ID, num_envs=2, benchmark=sample_benchmark())
    assert many.spec is not None
    assert many.spec.max_episode_steps == HORIZON


def test_an_episode_is_as_long_as_the_spec_says(folder: Path):
    environment = make(folder)
    environment.reset(seed=0)
    ends = [environment.step(3)[2:4] for _ in range(HORIZON)]
    assert ends == [(False, False)] * (HORIZON - 1) + [(False, True)]


def test_another_horizon_is_said(caplog):
    semantics = replace(sample_benchmark().semantics, horizon=40)
    longer = replace(sample_benchmark(), semantics=semantics)
    environment = gymnasium.make(HOUSE_ID, benchmark=longer, max_episode_steps=40, renderer="rays")
    assert "max_episode_steps=40" in caplog.text
    environment.reset(options={"task": longer.tasks[0].id})
    ends = [environment.step(3)[3] for _ in range(40)]
    assert ends == [False] * 39 + [True]


def test_json_makes_the_same_environment(folder: Path):
    environment = make(folder, observation="state")
    assert environment.spec is not None
    spec = EnvSpec.from_json(environment.spec.to_json())
    again = gymnasium.make(spec)
    assert environment.spec == again.spec == spec
    assert str(environment) == str(again)
    assert environment.observation_space == again.observation_space
    for seed in range(5):
        assert environment.reset(seed=seed) == again.reset(seed=seed)
        assert environment.step(seed % 4) == again.step(seed % 4)


def test_a_vector_environment_is_written_down_too(folder: Path):
    vector = gymnasium.make_vec(HOUSE_ID, num_envs=2, benchmark=folder, split=None)
    assert vector.spec is not None
    again = gymnasium.make_vec(EnvSpec.from_json(vector.spec.to_json()))
    assert (again.num_envs, again.single_observation_space) == (2, vector.single_observation_space)


@pytest.mark.parametrize(
    ("argument", "thing"),
    [("benchmark", sample_benchmark()), ("reward", CountingReward())],
    ids=["benchmark", "reward"],
)
def test_an_object_has_no_json_but_makes_the_environment_again(folder: Path, argument, thing):
    environment = make(folder, **{argument: thing})
    spec = environment.spec
    assert spec is not None
    words = f"with {argument}=<{type(thing).__name__}>.*Give {argument} as a string"
    for error in (UsageError, ValueError):
        with pytest.raises(error, match=words):
            spec.to_json()
    assert str(gymnasium.make(spec)) == str(environment)


@pytest.mark.parametrize("pickler", [pickle, cloudpickle])
def test_a_spec_travels_to_another_process(folder: Path, pickler):
    spec = make(folder).spec
    assert spec is not None
    arrived = pickle.loads(pickler.dumps(spec))
    assert isinstance(arrived, HouseSpec)
    assert arrived == spec


def test_specs_of_other_content_differ(folder: Path):
    assert make(folder).spec != make(folder, text=False).spec
    assert make(folder).spec != "a spec"
