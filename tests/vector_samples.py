"""Vector environments to compare: on shared tables, and of single environments."""

from __future__ import annotations

from typing import Any

import gymnasium
from environment_samples import sample_benchmark
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import VectorEnv

from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.envs.vector_environment import HouseVectorEnvironment

ENVIRONMENTS = 5


def shared(**settings: Any) -> HouseVectorEnvironment:
    """What `make_vec` makes by default."""
    vector = gymnasium.make_vec(HOUSE_ID, **_arguments(settings))
    assert isinstance(vector, HouseVectorEnvironment)
    return vector


def singles(*, autoreset_mode: str = "NextStep", copy: bool = True, **settings: Any) -> VectorEnv:
    """Gymnasium's vector of single environments."""
    return gymnasium.make_vec(
        HOUSE_ID,
        vectorization_mode="sync",
        vector_kwargs={"autoreset_mode": autoreset_mode, "copy": copy},
        **_arguments(settings),
    )


def equal(found: Any, expected: Any) -> bool:
    """Whether both have the same structure, types and values, to the bit."""
    return data_equivalence(found, expected, exact=True)


def _arguments(settings: dict[str, Any]) -> dict[str, Any]:
    usual = {"num_envs": ENVIRONMENTS, "benchmark": sample_benchmark(), "renderer": "rays"}
    return {**usual, "split": None, **settings}
