"""Asking MuJoCo where the agent's body fits."""

# mujoco makes its attributes at run time, where pyright can't see them.
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
"""Most metres between two queries on a way: a body 0.4 m wide leaves out slivers of 1.6 mm."""


class CollisionProbe:
    """A house without its looks, and the agent's body to try in it."""

    def __init__(self, house: House, semantics: Semantics) -> None:
        tallest = max(semantics.agent_height, semantics.eye_height + HEAD)
        # What hangs higher than the body or lies lower than its step is never touched.
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
        # Nothing but the agent has joints, so every contact is the agent's.
        return data.ncon == 0

    def free(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether the agent's body touches nothing: [point, 2] metres to [point]."""
        return np.array([self.is_free(point) for point in points], bool)

    def is_clear(self, start: NDArray[np.float64], end: NDArray[np.float64]) -> bool:
        """Whether the straight way between two free points, [2] metres each, is free."""
        steps = math.ceil(float(np.hypot(*(end - start))) / STRIDE)
        shares = np.arange(1, steps) / steps
        # From the middle outward: what blocks a way is rarely near its ends.
        shares = shares[np.argsort(np.abs(shares - 0.5), kind="stable")]
        return all(self.is_free(start + share * (end - start)) for share in shares)
