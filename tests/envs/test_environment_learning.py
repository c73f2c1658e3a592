"""Stable-Baselines3 takes the environment and learns in it, knowing nothing of its dynamics."""

from __future__ import annotations

from collections.abc import Sequence

import gymnasium
import numpy as np
import pytest
import torch
from environment_samples import sample_benchmark
from lcrl_bench.evaluation.problems import compile_problems
from stable_baselines3 import DQN
from stable_baselines3.common.env_checker import check_env

from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.envs.environment import HouseEnvironment
from lcrl_bench.methods.contract import HouseViews
from lcrl_bench.methods.tensors import TensorReward

BED = "rooms-a.go-to-the-bed"


class NearReward(TensorReward):
    """As learned rewards often are: higher the nearer the goal of the one task it knows."""

    def __init__(self) -> None:
        problems = compile_problems(sample_benchmark(), device=torch.device("cpu"), renderer="rays")
        problem, tasks, row = next(
            (problem, tasks, row)
            for problem in problems
            for tasks in problem.compiled.sets
            for row, task in enumerate(tasks.tasks)
            if task.id == BED
        )
        points, goal = problem.compiled.grid.points, tasks.batch.goal[row].numpy()
        apart = np.linalg.norm(points[:, None] - points[goal], axis=2).min(axis=1)
        self.near = torch.zeros(len(problem.observed.views.panorama_views), dtype=torch.float64)
        self.near[problem.observed.place[tasks.panoramas[row]]] = torch.from_numpy(
            1 - apart / apart.max()
        )

    def score(self, views: HouseViews, commands: Sequence[str]) -> torch.Tensor:
        return self.near.expand(len(commands), -1)


def make(**settings) -> gymnasium.Env:
    return gymnasium.make(
        HOUSE_ID, **{"benchmark": sample_benchmark(), "renderer": "rays", "tasks": [BED]} | settings
    )


def success(model: DQN, environment: gymnasium.Env) -> bool:
    """Whether the greedy policy reaches the true goal in an episode."""
    seen, info = environment.reset(seed=0)
    over, reached = False, False
    while not over:
        seen, _, terminated, truncated, info = environment.step(model.predict(seen, True)[0])
        over, reached = terminated or truncated, reached or info["success"]
    return reached


@pytest.mark.parametrize("settings", [{"observation": "tabular"}, {"observation": "state"}])
def test_stable_baselines_finds_nothing_wrong(settings):
    environment = make(**settings).unwrapped
    assert isinstance(environment, HouseEnvironment)
    check_env(environment)


@pytest.mark.filterwarnings("ignore:.*image:UserWarning")
def test_stable_baselines_takes_the_dictionary_without_text():
    environment = make(text=False, position=True)
    check_env(environment.unwrapped)
    model = DQN("MultiInputPolicy", environment, learning_starts=10, buffer_size=100, seed=0)
    model.learn(30)


def test_a_dqn_learns_the_way_from_a_learned_reward_alone():
    environment = make(observation="tabular", reward=NearReward())
    model = DQN(
        "MlpPolicy",
        environment,
        learning_rate=2e-3,
        buffer_size=20_000,
        learning_starts=300,
        train_freq=4,
        target_update_interval=200,
        exploration_fraction=0.5,
        policy_kwargs={"net_arch": [64]},
        seed=0,
    )
    assert not success(model, environment)
    model.learn(3_000)
    assert success(model, environment)
