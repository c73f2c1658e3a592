"""The adapter for Stable-Baselines3 returns what SB3's own vector of single environments does."""

from __future__ import annotations

import importlib
import sys

import gymnasium
import numpy as np
import pytest
from environment_samples import sample_benchmark
from gymnasium.utils.env_checker import data_equivalence
from vector_samples import shared

from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.errors import EnvironmentMissingError, UsageError

stable_baselines3 = pytest.importorskip(
    "stable_baselines3", reason="Stable-Baselines3 is not installed"
)
from stable_baselines3 import A2C  # noqa: E402
from stable_baselines3.common.evaluation import evaluate_policy  # noqa: E402
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor  # noqa: E402

from lcrl_bench.envs.stable_baselines import HouseVecEnv  # noqa: E402

BED, CUP = "rooms-a.go-to-the-bed", "rooms-b.move-the-cup-to-the-bed"
ENVIRONMENTS = 3
IMAGES = pytest.mark.filterwarnings("ignore:.*image:UserWarning")


def adapted(**settings) -> HouseVecEnv:
    usual = {"num_envs": ENVIRONMENTS, "autoreset_mode": "SameStep", "text": False}
    return HouseVecEnv(shared(**usual | settings))


def dummy(**settings) -> DummyVecEnv:
    def make() -> gymnasium.Env:
        usual = {"benchmark": sample_benchmark(), "renderer": "rays", "split": None, "text": False}
        return gymnasium.make(HOUSE_ID, **usual | settings)

    return DummyVecEnv([make] * ENVIRONMENTS)


@pytest.mark.parametrize(
    "settings", [{"position": True}, {"observation": "tabular"}, {"observation": "state"}], ids=str
)
def test_it_returns_the_same_as_a_dummy_of_single_environments(settings):
    ours, theirs = adapted(**settings), dummy(**settings)
    assert (ours.observation_space, ours.action_space) == (
        theirs.observation_space,
        theirs.action_space,
    )
    rng = np.random.default_rng(0)
    assert ours.seed(5) == theirs.seed(5)
    assert data_equivalence(_plain(ours.reset()), _plain(theirs.reset()), exact=True)
    ended = 0
    for _ in range(70):
        actions = rng.choice([0, 0, 0, 1, 2, 3], size=ENVIRONMENTS)
        found, expected = ours.step(actions), theirs.step(actions)
        assert data_equivalence(_plain(found[0]), _plain(expected[0]), exact=True)
        assert data_equivalence(found[1:], expected[1:], exact=True)
        assert ours.reset_infos == theirs.reset_infos
        ended += found[2].sum()
    assert ended > ENVIRONMENTS


def _plain(seen):
    # SB3 returns an ordered dictionary.
    return dict(seen) if isinstance(seen, dict) else seen


def test_seeds_and_options_hold_for_one_reset():
    ours, theirs = adapted(), dummy()
    for vector in (ours, theirs):
        vector.seed(1)
        vector.set_options([{"task": BED}, {"task": CUP}, {}])
        vector.reset()
    assert [info["task"] for info in ours.reset_infos[:2]] == [BED, CUP]
    assert ours.reset_infos == theirs.reset_infos
    ours.reset()
    theirs.reset()
    assert ours.reset_infos == theirs.reset_infos
    ours.set_options({"tasks": BED})
    with pytest.raises(UsageError, match="Unknown option 'tasks'"):
        ours.reset()


def test_attributes_are_those_of_each_sub_environment():
    vector = adapted(render_mode="rgb_array")
    vector.set_options([{"task": BED}, {"task": CUP}, {"task": BED}])
    vector.reset()
    assert [task.id for task in vector.get_attr("task")] == [BED, CUP, BED]
    assert vector.get_attr("state", [1]) == [int(vector.vector.states[1])]
    assert vector.get_attr("render_mode") == ["rgb_array"] * ENVIRONMENTS
    assert vector.env_is_wrapped(gymnasium.Wrapper) == [False] * ENVIRONMENTS
    assert len(vector.env_method("render", indices=[0, 2])) == 2
    assert vector.render().shape == (2 * 704, 2 * 704, 3)
    with pytest.raises(UsageError, match=r"has no method 'close'\. Valid: render"):
        vector.env_method("close")
    with pytest.raises(UsageError, match=r"pass it to gymnasium\.make_vec"):
        vector.set_attr("terminate_at_goal", False)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"autoreset_mode": "NextStep"}, "autoreset_mode is 'NextStep'.*Valid.*'SameStep'"),
        ({"text": True}, "text is True.*Valid.*False"),
    ],
)
def test_what_stable_baselines_can_not_take_is_refused(settings, words):
    with pytest.raises(UsageError, match=words):
        adapted(**settings)


@IMAGES
def test_stable_baselines_learns_in_it_from_panoramas():
    vector = VecMonitor(adapted())
    model = A2C("MultiInputPolicy", vector, n_steps=5, seed=0).learn(60)
    rewards, lengths = evaluate_policy(
        model, vector, n_eval_episodes=4, return_episode_rewards=True
    )
    assert len(rewards) == 4
    assert max(lengths) <= 30
    vector.close()


def test_it_learns_the_way_to_the_bed():
    vector = VecMonitor(adapted(num_envs=16, tasks=[BED], observation="tabular"))
    model = A2C("MlpPolicy", vector, n_steps=8, learning_rate=3e-3, ent_coef=0.02, seed=0)
    before = evaluate_policy(model, vector, n_eval_episodes=32, deterministic=False)[0]
    model.learn(30_000)
    assert evaluate_policy(model, vector, n_eval_episodes=32, deterministic=False)[0] > before + 4


def test_without_stable_baselines_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "stable_baselines3.common.vec_env", None)
    monkeypatch.delitem(sys.modules, "lcrl_bench.envs.stable_baselines")
    with pytest.raises(EnvironmentMissingError, match="pip install stable-baselines3"):
        importlib.import_module("lcrl_bench.envs.stable_baselines")
