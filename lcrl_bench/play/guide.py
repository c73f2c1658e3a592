"""Guides: the optimal policy of the true reward, and what a run learned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.dynamics import ObjectState
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.envs.reward_table import house_views
from lcrl_bench.envs.world import World
from lcrl_bench.evaluation.question import Model
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.task_batch import HEADINGS, Action
from lcrl_bench.methods.observed_house import ObservedHouse
from lcrl_bench.play.walk import Walk
from lcrl_bench.recording.maps import TileMap
from lcrl_bench.recording.rollout import solve

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


def optimum(world: World) -> Guide | None:
    """The shortest way to the goal; None if the goal is unknown."""
    if not world.goal.any():
        return None
    batch = world.tasks.rows([world.row]).batch
    # Any reward of success has the same optimum.
    return Guide("optimum", expert_policy(batch, 1.0)[0].numpy())


def learned_guide(world: World, model: Model) -> Guide:
    """A run's model as a guide: exact planning on its reward, or its policy."""
    one = world.tasks.rows([world.row])
    reward, value, policy = solve(model.learned, ObservedHouse.of(house_views(world)), one)
    maps: tuple[TileMap, ...] = ()
    if reward is not None and value is not None:
        best = value.reshape(-1, HEADINGS).max(axis=1)
        layers = 1 if world.task.kind == Kind.NAV else len(ObjectState)
        maps = tuple(
            TileMap.of(key, name, array.reshape(layers, world.tiles))
            for key, name, array in (
                ("reward", f"reward of {model.method}", reward),
                ("value", f"value by {model.method}", best),
            )
        )
    return Guide(model.method, policy[0].numpy(), maps)
