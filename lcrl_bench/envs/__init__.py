"""Gymnasium environments: a benchmark's houses for any reinforcement learning library.

Gymnasium 1.0 removed the entry points that registered installed packages, so an environment is
registered by importing its package: `import lcrl_bench.envs`, or the module in the name,
`gymnasium.make("lcrl_bench.envs:lcrl_bench/House-v1")`. Only the name is registered: torch and
MuJoCo are not imported until an environment is made.
"""

from __future__ import annotations

from typing import Final

import gymnasium

from lcrl_bench.envs.spec import HouseSpec
from lcrl_bench.semantics import DEFAULT_SEMANTICS

HOUSE_ID: Final = "lcrl_bench/House-v1"
"""Id of `lcrl_bench.envs.environment.HouseEnvironment`."""


def register() -> None:
    """Register the environments with Gymnasium; a no-op the second time."""
    if HOUSE_ID not in gymnasium.registry:
        gymnasium.register(
            id=HOUSE_ID,
            entry_point="lcrl_bench.envs.environment:HouseEnvironment",
            vector_entry_point="lcrl_bench.envs.vector_environment:HouseVectorEnvironment",
            max_episode_steps=DEFAULT_SEMANTICS.horizon,
            # The environment itself refuses a step before a reset, and tests check its spaces and
            # types: Gymnasium's wrappers would repeat both at every step.
            order_enforce=False,
            disable_env_checker=True,
        )
        gymnasium.registry[HOUSE_ID] = HouseSpec.of(gymnasium.registry[HOUSE_ID])


register()
