"""`HouseVecEnv`: the vector environment for Stable-Baselines3, which has an interface of its own.

Only this module imports Stable-Baselines3, and nothing else imports this module.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from lcrl_bench.envs.setup import check_options
from lcrl_bench.envs.vector_environment import HouseVectorEnvironment
from lcrl_bench.errors import EnvironmentMissingError, UsageError

try:
    from stable_baselines3.common.vec_env import VecEnv
    from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices
except ImportError as error:
    raise EnvironmentMissingError(
        "lcrl_bench.envs.stable_baselines needs Stable-Baselines3: pip install stable-baselines3"
    ) from error


class HouseVecEnv(VecEnv):
    """Steps all sub-environments at once; returns what SB3's `DummyVecEnv` of single ones does."""

    def __init__(self, vector: HouseVectorEnvironment) -> None:
        """Wrap a vector environment.

        Args:
            vector: Made with `autoreset_mode="SameStep"`, as SB3 begins the next episode at once,
                and without text, which SB3 does not support.

        Raises:
            UsageError: If it was made otherwise.
        """
        mode = vector.metadata["autoreset_mode"]
        if mode is not AutoresetMode.SAME_STEP:
            raise UsageError(
                f"autoreset_mode is '{mode.value}'. Valid for Stable-Baselines3: 'SameStep'."
            )
        space = vector.single_observation_space
        if isinstance(space, spaces.Dict) and "text" in space.spaces:
            raise UsageError("text is True. Valid for Stable-Baselines3: False.")
        self.vector = vector
        super().__init__(vector.num_envs, space, vector.single_action_space)
        self._actions: Any = None

    def reset(self) -> Any:  # noqa: ANN401 - as the observation space says
        """Start an episode in each, with the seeds and options that were set before."""
        valid = [check_options(each, valid=("task",)) for each in self._options]
        tasks = [each.get("task") for each in valid]
        seen, infos = self.vector.reset(seed=self._seeds, options={"task": tasks})
        self.reset_infos = _rows(infos)
        self._reset_seeds()
        self._reset_options()
        return seen

    def step_async(self, actions: NDArray[np.integer]) -> None:
        """Remember the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Take the actions.

        Returns:
            Observations, of the next episode where one is over; rewards; whether it is over; and
            infos, with `terminal_observation` and `TimeLimit.truncated`.
        """
        seen, rewards, terminated, truncated, infos = self.vector.step(self._actions)
        over = terminated | truncated
        rows = _rows(infos)
        for number in np.flatnonzero(over).tolist():
            self.reset_infos[number] = rows[number]
            rows[number] = _row(infos["final_info"], number)
            rows[number]["terminal_observation"] = infos["final_obs"][number]
        for row, late in zip(rows, (truncated & ~terminated).tolist(), strict=True):
            row["TimeLimit.truncated"] = late
        return seen, rewards.astype(np.float32), over, rows

    def close(self) -> None:
        """Close the vector environment."""
        self.vector.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """The frames."""
        return self.vector.render()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """An attribute per sub-environment: its `task` or `state`, or one that they share."""
        own = {"task": "played", "state": "states"}
        value = getattr(self.vector, own.get(attr_name, attr_name))
        numbers = self._get_indices(indices)
        return [value[number] if attr_name in own else value for number in numbers]

    def set_attr(self, attr_name: str, value: object, indices: VecEnvIndices = None) -> None:
        """Refuse: sub-environments are rows of tables.

        Raises:
            UsageError: Always.
        """
        raise UsageError(f"Can't set {attr_name}: pass it to gymnasium.make_vec instead.")

    def env_method(
        self,
        method_name: str,
        *method_args: Any,  # noqa: ANN401 - as the base class
        indices: VecEnvIndices = None,
        **method_kwargs: Any,  # noqa: ANN401 - as the base class
    ) -> list[Any]:
        """Call `render`, the only method of a sub-environment.

        Raises:
            UsageError: If another one is named.
        """
        if method_name != "render":
            raise UsageError(f"A sub-environment has no method '{method_name}'. Valid: render.")
        frames = self.vector.render()
        return [frames[number] for number in self._get_indices(indices)]

    def env_is_wrapped(
        self,
        wrapper_class: type[Any],
        indices: VecEnvIndices = None,
    ) -> list[bool]:
        """False for each: sub-environments have no wrappers."""
        del wrapper_class
        return [False for _ in self._get_indices(indices)]


def _rows(infos: dict[str, Any]) -> list[dict[str, Any]]:
    """One dictionary per sub-environment."""
    keys = [key for key in infos if not key.startswith(("_", "final_"))]
    columns = (infos[key].tolist() for key in keys)
    return [dict(zip(keys, row, strict=True)) for row in zip(*columns, strict=True)]


def _row(infos: dict[str, Any], number: int) -> dict[str, Any]:
    """The dictionary of one sub-environment."""
    return {key: infos[key][number : number + 1].tolist()[0] for key in infos if key[0] != "_"}
