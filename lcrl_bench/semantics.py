"""`Semantics`: the constants of the agent's body, cameras and tasks.

They are part of every benchmark's fingerprint: results under other constants are not comparable.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Semantics:
    """Constants shared by all houses of a benchmark, in metres, radians, pixels and steps."""

    tile: float = 0.75
    """Side of a square grid tile."""
    agent_radius: float = 0.2
    """Radius of the agent's upright body."""
    agent_height: float = 1.2
    """Height of the agent's body."""
    eye_height: float = 1.25
    """Height of the camera above the floor."""
    pitch: float = -0.26
    """Tilt of the camera; negative looks down, so that objects within reach are visible."""
    view_width: int = 32
    """Columns of a view."""
    view_height: int = 24
    """Rows of a view."""
    horizontal_fov: float = 1.5707963267948966
    """Horizontal field of view: a quarter turn, so four views cover the full circle."""
    reach: float = 1.0
    """Horizontal distance within which the agent is at an object, or can take or put one."""
    horizon: int = 30
    """Actions in an episode (paper, appendix "Experiment Hyperparameters")."""
    discount: float = 0.99
    """gamma of all planning and visitation (paper, same place)."""
    success_reward: float = 10.0
    """True reward where the goal predicate holds (paper, same place)."""

    demonstrations: int = 10
    """Expert demonstrations per training task (paper, same place)."""


DEFAULT_SEMANTICS = Semantics()
"""The constants of all benchmarks shipped with the suite."""
