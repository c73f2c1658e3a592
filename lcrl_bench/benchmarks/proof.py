"""Exact proofs of a task: whether it is solvable, from where, how well, and by chance.

All starts of a task are proved at once.
Source: paper, appendix "Experiment Hyperparameters" for the horizon, discount and reward.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Proof
from lcrl_bench.mdp.dynamics import spread_cells
from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.success import UNREACHABLE, distance_to_goal
from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.semantics import Semantics

SLACK = 0.2
"""Share of the horizon left when an optimal agent arrives: otherwise, demonstrations hardly show
the goal."""

MAX_RANDOM_SUCCESS = 0.05
"""Tasks that a random policy solves more often than this are too easy to separate methods."""

UNPROVED = Proof(optimal_length=UNREACHABLE, value=0.0, random_success=0.0)
"""The proof of a task about which nothing is known."""


@dataclass(frozen=True, eq=False)
class StartTable:
    """Exact values for every state as a start."""

    steps: NDArray[np.int64]
    """[state]: length of the shortest solution; -1 if there is none within the horizon."""
    value: NDArray[np.float64]
    """[state]: V* of the true reward over the horizon."""
    random_success: NDArray[np.float64]
    """[state]: probability that uniformly random actions succeed within the horizon."""

    def proof(self, state: int) -> Proof:
        """The proof of a task that starts in `state`."""
        return Proof(
            int(self.steps[state]), float(self.value[state]), float(self.random_success[state])
        )

    def admitted(self, semantics: Semantics) -> NDArray[np.bool_]:
        """Bool [state]: starts at which the task is solvable, but not solved, and not by chance."""
        solvable = (self.steps > 0) & (self.steps <= (1 - SLACK) * semantics.horizon)
        return solvable & (self.random_success <= MAX_RANDOM_SUCCESS)


def start_table(tasks: TaskBatch, success_reward: float) -> StartTable:
    """Solve a task from every start.

    Args:
        tasks: A batch of one task; its own start does not matter.
        success_reward: True reward where the goal predicate holds.
    """
    distance = distance_to_goal(tasks)[0]
    reward = true_reward(tasks, success_reward, dtype=torch.float64)
    goal, next_state = spread_cells(tasks.goal)[0].numpy(), tasks.next_state[0].numpy()
    chance = goal.astype(np.float64)
    for _ in range(tasks.horizon):
        # Success at any step counts, so the goal is absorbing here, and only here.
        chance = np.where(goal, 1.0, chance[next_state].mean(axis=1))
    return StartTable(
        steps=torch.where(distance > tasks.horizon, UNREACHABLE, distance).numpy(),
        value=q_iteration(tasks, reward).values[0, 0].numpy(),
        random_success=chance,
    )
