"""Gymnasium environments: the houses of a benchmark for anybody's reinforcement learning.

Gymnasium 1.0 took away the entry points by which an installed package was found, so an environment
is registered by importing its package: `import lcrl_bench.envs`, or the module in the name,
`gymnasium.make("lcrl_bench.envs:lcrl_bench/House-v1")`. Nothing but the name is registered: neither
torch nor MuJoCo is imported before an environment is made.
"""

from __future__ import annotations

from typing import Final

import gymnasium

from lcrl_bench.envs.spec import HouseSpec
from lcrl_bench.semantics import DEFAULT_SEMANTICS

HOUSE_ID: Final = "lcrl_bench/House-v1"
"""The environment of `lcrl_bench.envs.environment.HouseEnvironment`."""


def register() -> None:
    """Make the environments known to Gymnasium; a second time does nothing."""
    if HOUSE_ID not in gymnasium.registry:
        gymnasium.register(
            id=HOUSE_ID,
            entry_point="lcrl_bench.envs.environment:HouseEnvironment",
            max_episode_steps=DEFAULT_SEMANTICS.horizon,
        )
        gymnasium.registry[HOUSE_ID] = HouseSpec.of(gymnasium.registry[HOUSE_ID])


register()
