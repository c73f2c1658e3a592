"""`CollisionProbe`: MuJoCo collision queries of where the agent's body fits."""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import House
from lcrl_bench.scenes.agent import HEAD, STEP
from lcrl_bench.scenes.mjcf import compile_scene, house_mjcf
from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.semantics import Semantics

STRIDE: Final = 0.05
"""Largest gap between queries on a path, in metres: a body 0.4 m wide misses at most 1.6 mm."""


class CollisionProbe:
    """A house's collision geometry, and the agent's body to test in it."""

    def __init__(self, house: House, semantics: Semantics) -> None:
        tallest = max(semantics.agent_height, semantics.eye_height + HEAD)
        # Objects above the body or below its step are never touched.
        level = (o for o in house.objects if o.base <= tallest and o.top >= STEP)
        house = replace(house, objects=tuple(level))
        scene = house_mjcf(house, semantics, visual=False, jointed_agent=True)
        self._model = compile_scene(scene)
        self._data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, self._data)

    def is_free(self, point: NDArray[np.float64]) -> bool:
        """Whether the agent's body touches nothing at `point`, [2] metres."""
        model, data = self._model, self._data
        data.qpos[:] = point
        mujoco.mj_kinematics(model, data)
        mujoco.mj_collision(model, data)
        # Only the agent has joints, so every contact is the agent's.
        return data.ncon == 0

    def free(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether the agent's body touches nothing: [point, 2] metres to [point]."""
        return np.array([self.is_free(point) for point in points], bool)

    def is_clear(self, start: NDArray[np.float64], end: NDArray[np.float64]) -> bool:
        """Whether the straight path between two free points, [2] metres each, is free."""
        steps = math.ceil(float(np.hypot(*(end - start))) / STRIDE)
        shares = np.arange(1, steps) / steps
        # From the middle outward: obstacles are rarely near the ends of a path.
        shares = shares[np.argsort(np.abs(shares - 0.5), kind="stable")]
        return all(self.is_free(start + share * (end - start)) for share in shares)
