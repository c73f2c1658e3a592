"""The tiny world that methods are tested in: the package's own, `lcrl_bench.methods.practice`."""

from __future__ import annotations

from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.methods.contract import TaskSet, TrainHouse, TrainSet
from lcrl_bench.methods.practice import SUCCESS_REWARD
from lcrl_bench.methods.practice import practice_train_set as sample_train_set

__all__ = ["SUCCESS_REWARD", "sample_train_set", "with_goals"]


def with_goals(train: TrainSet, truth: TrainSet) -> list[tuple[TrainHouse, TaskSet, TaskBatch]]:
    """The task sets of a train set, each with its house and its batch with true goals."""
    return [
        (house, tasks, true_tasks.batch)
        for house, true_house in zip(train.houses, truth.houses, strict=True)
        for tasks, true_tasks in zip(house.tasks, true_house.tasks, strict=True)
    ]
