"""Guides: the optimal policy of the true reward, and what a run learned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.question import Model
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.task_batch import HEADINGS, Action
from lcrl_bench.methods.learned import plan
from lcrl_bench.play.walk import Walk
from lcrl_bench.recording.maps import TileMap

_PREFERENCE: Final = (Action.INTERACT, Action.FORWARD, Action.LEFT, Action.RIGHT)
"""Tied actions, first choice first."""


@dataclass(frozen=True, eq=False)
class Guide:
    """A policy that shows the player what to do next."""

    name: str
    """`"optimum"`, or the method that learned it."""
    policy: NDArray[np.float64]
    """[horizon, state, action] probabilities."""
    maps: tuple[TileMap, ...] = ()
    """Its reward and value; empty if it has no reward."""

    def advice(self, walk: Walk) -> Action | None:
        """The most likely action; ties are broken by `_PREFERENCE`.

        Returns:
            None when no step is left.
        """
        if walk.over:
            return None
        likely = self.policy[walk.steps, walk.state]
        return max(_PREFERENCE, key=lambda action: likely[action])


def optimum(one: TaskSet) -> Guide | None:
    """The shortest way to the goal; None if the goal is unknown."""
    if not one.goal.any():
        return None
    # Any reward of success has the same optimum.
    return Guide("optimum", expert_policy(one, 1.0)[0].numpy())


def learned_guide(one: TaskSet, model: Model) -> Guide:
    """A run's model as a guide: exact planning on its reward, or its policy."""
    planned = plan(model.learned, one)
    maps: tuple[TileMap, ...] = ()
    if planned.reward is not None and planned.value is not None:
        best = planned.value[0].unflatten(0, (-1, HEADINGS)).amax(1)
        maps = tuple(
            TileMap.of(key, name, array.numpy().reshape(one.object_states, one.tiles))
            for key, name, array in (
                ("reward", f"reward of {model.method}", planned.reward[0]),
                ("value", f"value by {model.method}", best),
            )
        )
    return Guide(model.method, planned.policy[0].numpy(), maps)
