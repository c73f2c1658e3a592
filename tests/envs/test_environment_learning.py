"""Stable-Baselines3 takes the environment and learns in it, knowing nothing of its dynamics."""

from __future__ import annotations

from collections.abc import Sequence

import gymnasium
import numpy as np
import pytest
import torch
from environment_samples import sample_benchmark
from stable_baselines3 import DQN
from stable_baselines3.common.env_checker import check_env

from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.envs.environment import HouseEnvironment
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.tensors import TensorReward

BED = "rooms-a.go-to-the-bed"


class NearReward(TensorReward):
    """As learned rewards often are: higher the nearer the goal of the one task it knows."""

    def __init__(self) -> None:
        sets = load_task_sets(sample_benchmark(), device=torch.device("cpu"), renderer="rays")
        tasks, row = next(
            (tasks, row) for tasks in sets for row, task in enumerate(tasks.tasks) if task.id == BED
        )
        points, goal = tasks.scene.grid.points, tasks.goal[row].numpy()
        apart = np.linalg.norm(points[:, None] - points[goal], axis=2).min(axis=1)
        house = tasks.views.observed
        self.near = torch.zeros(len(house.views), dtype=torch.float64)
        self.near[house.place[tasks.panoramas[row]]] = torch.from_numpy(1 - apart / apart.max())

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
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
