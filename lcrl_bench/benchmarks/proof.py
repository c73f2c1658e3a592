"""Exact facts about a task: is it solvable, from where, how well, and by chance?

All starts of a task are proved at once by sweeping backwards over its transition table.
Source: paper, appendix "Experiment Hyperparameters" for the horizon, discount and reward.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Proof
from lcrl_bench.semantics import Semantics

SLACK = 0.2
"""Share of the horizon that is left when an optimal agent arrives: a task that is barely done in
time shows next to nothing of its goal in a demonstration."""

MAX_RANDOM_SUCCESS = 0.05
"""A task that a random policy solves more often than this is too easy to tell methods apart."""


@dataclass(frozen=True, eq=False)
class StartTable:
    """What is exactly known of every state as a start."""

    steps: NDArray[np.int64]
    """[state]: actions of the shortest solution; -1 where there is none within the horizon."""
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
        """Bool [state]: starts from which the task is solvable, not solved, and not by chance."""
        solvable = (self.steps > 0) & (self.steps <= (1 - SLACK) * semantics.horizon)
        return solvable & (self.random_success <= MAX_RANDOM_SUCCESS)


def start_table(
    next_state: NDArray[np.int64], goal: NDArray[np.bool_], semantics: Semantics
) -> StartTable:
    """Solve a task from every start.

    Args:
        next_state: int64 [state, action].
        goal: bool [state]: where the goal predicate holds.
        semantics: Horizon, discount and reward.
    """
    horizon = semantics.horizon
    reward = semantics.success_reward * goal
    steps = np.where(goal, 0, horizon + 1)
    value = reward.astype(np.float64)
    chance = goal.astype(np.float64)
    for _ in range(horizon):
        steps = np.minimum(steps, steps[next_state].min(axis=1) + 1)
        value = reward + semantics.discount * value[next_state].max(axis=1)
        # Success at any step counts, so the goal absorbs here and only here.
        chance = np.where(goal, 1.0, chance[next_state].mean(axis=1))
    return StartTable(np.where(steps > horizon, -1, steps), value, chance)
