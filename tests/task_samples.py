"""The tiny world that methods are tested in: the package's own, `lcrl_bench.methods.practice`."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from lcrl_bench.methods.observed_house import ObservedHouse, ask

from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.methods.contract import Reward, TaskSet, TrainHouse, TrainSet
from lcrl_bench.methods.practice import SUCCESS_REWARD
from lcrl_bench.methods.practice import practice_train_set as sample_train_set

__all__ = ["SUCCESS_REWARD", "cell_rewards", "sample_train_set", "with_goals"]


def with_goals(train: TrainSet, truth: TrainSet) -> list[tuple[TrainHouse, TaskSet, TaskBatch]]:
    """The task sets of a train set, each with its house and its batch with true goals."""
    return [
        (house, tasks, true_tasks.batch)
        for house, true_house in zip(train.houses, truth.houses, strict=True)
        for tasks, true_tasks in zip(house.tasks, true_house.tasks, strict=True)
    ]


def cell_rewards(
    reward: Reward, house: TrainHouse, tasks: TaskSet, commands: Sequence[str] | None = None
) -> torch.Tensor:
    """What a learned reward pays in each cell, under the tasks' own commands or others."""
    said = tasks.commands if commands is None else commands
    return ask(reward, ObservedHouse.of(house.views), said).reward(tasks.panoramas, said)
