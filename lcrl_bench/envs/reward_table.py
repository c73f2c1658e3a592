"""Reward tables: the true reward of a task, or a learned one, per cell."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import OrderedDict
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.methods.learned import Reward, ask

TABLES_KEPT: Final = 4096
"""Number of most recently used tables of a learned reward kept; one takes a few kilobytes."""


class RewardTable(ABC):
    """A reward that is looked up in a table."""

    @abstractmethod
    def table(self, tasks: TaskSet, row: int) -> NDArray[np.float64]:
        """The reward of each cell of a task: float64 [cell], all finite.

        Args:
            tasks: A set of tasks.
            row: Index of the task.
        """

    @abstractmethod
    def clear(self) -> None:
        """Free cached tables."""


class TrueReward(RewardTable):
    """The environment's reward, paid wherever the goal predicate holds."""

    def __init__(self, success_reward: float) -> None:
        """Take the reward of success."""
        self._success_reward = success_reward

    def table(self, tasks: TaskSet, row: int) -> NDArray[np.float64]:
        """`success_reward` where the goal predicate holds, else 0."""
        return tasks.goal[row].numpy().astype(np.float64) * self._success_reward

    def clear(self) -> None:
        """Do nothing: nothing is cached."""


class LearnedReward(RewardTable):
    """A learned reward, scored once per task.

    A house's tasks of one kind are scored together, since a network encodes the house once for
    all of them.
    """

    def __init__(self, reward: Reward) -> None:
        """Wrap a learned reward; it scores on the CPU."""
        self._reward = reward
        self._tables: OrderedDict[str, NDArray[np.float64]] = OrderedDict()

    def table(self, tasks: TaskSet, row: int) -> NDArray[np.float64]:
        """The learned reward of each cell.

        Raises:
            UsageError: If any of them is not finite.
        """
        name = tasks.tasks[row].id
        if name not in self._tables:
            self._score(tasks)
        self._tables.move_to_end(name)
        table = self._tables[name]
        while len(self._tables) > TABLES_KEPT:
            self._tables.popitem(last=False)
        return table

    def clear(self) -> None:
        """Free all tables."""
        self._tables.clear()

    def _score(self, tasks: TaskSet) -> None:
        answers = ask(self._reward, tasks.views.observed, tasks.commands)
        rewards = answers.reward_of(tasks).cpu().numpy()
        for task, row in zip(tasks.tasks, rewards, strict=True):
            self._tables[task.id] = row
