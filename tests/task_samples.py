"""The tiny world that methods are tested in: the package's own, `lcrl_bench.methods.practice`."""

from __future__ import annotations

from collections.abc import Sequence

import torch

from lcrl_bench.methods.contract import Reward, TaskSet, TrainSet
from lcrl_bench.methods.learned import ask
from lcrl_bench.methods.practice import SUCCESS_REWARD
from lcrl_bench.methods.practice import practice_train_set as sample_train_set
from lcrl_bench.panoramas import ObservedHouse

__all__ = ["SUCCESS_REWARD", "cell_rewards", "sample_train_set", "with_goals"]


def with_goals(train: TrainSet, truth: TrainSet) -> list[tuple[TaskSet, TaskSet]]:
    """The task sets of a train set, each with the same tasks with true goals."""
    return list(zip(train.tasks, truth.tasks, strict=True))


def cell_rewards(
    reward: Reward, tasks: TaskSet, commands: Sequence[str] | None = None
) -> torch.Tensor:
    """What a learned reward pays in each cell, under the tasks' own commands or others."""
    said = tasks.commands if commands is None else commands
    return ask(reward, ObservedHouse.of(tasks.views), said).reward(tasks.panoramas, said)
