"""Who could be asked the way: the optimum of the true reward, and what a run learned."""

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

_EAGER: Final = (Action.INTERACT, Action.FORWARD, Action.LEFT, Action.RIGHT)
"""Which of tied actions comes first."""


@dataclass(frozen=True, eq=False)
class Guide:
    """Somebody who knows what to do at every step."""

    name: str
    """`"optimum"`, or the method that learned it."""
    policy: NDArray[np.float64]
    """[horizon, state, action] probabilities."""
    maps: tuple[TileMap, ...] = ()
    """What it thinks of the house, if it thinks in rewards: reward and value."""

    def advice(self, walk: Walk) -> Action | None:
        """The likeliest action; of those that are tied, what can be done is done at once.

        Returns:
            None when no step is left.
        """
        if walk.over:
            return None
        likely = self.policy[walk.steps, walk.state]
        return max(_EAGER, key=lambda action: likely[action])


def optimum(world: World) -> Guide | None:
    """The shortest way to the goal; None where no goal is known."""
    if not world.goal.any():
        return None
    batch = world.tasks.rows([world.row]).batch
    # Any reward of success has the same optimum.
    return Guide("optimum", expert_policy(batch, 1.0)[0].numpy())


def learned_guide(world: World, model: Model) -> Guide:
    """What a run's model would do: its reward planned for exactly, or its policy."""
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
