"""The agent's body in MuJoCo: collision geometry, and the four cameras of a panorama.

The body starts a step above the floor, so that it can walk over rugs, and carries a small ball
around the cameras, so that no camera is inside an object where the body is free.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from typing import Final

from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.semantics import Semantics

NAME: Final = "agent"
"""Name of the agent's body."""
STEP: Final = 0.04
"""Height in metres of obstacles that the agent steps over."""
HEAD: Final = 0.06
"""Radius in metres of the ball around the cameras."""
CAMERAS: Final = ("north", "east", "south", "west")
"""The cameras, in the order of headings and of a panorama's views."""

_AHEAD = ((0, 1), (1, 0), (0, -1), (-1, 0))


def add_agent(scene: mujoco.MjSpec, semantics: Semantics, *, jointed: bool = False) -> None:
    """Add the agent's body, standing at the origin of the house.

    Args:
        scene: The scene to add it to.
        semantics: Size of the body, height and tilt of the cameras.
        jointed: Give the body two sliding joints, `agent-x` and `agent-y`, instead of making it a
            mocap body. MuJoCo looks for contacts only between bodies that can move relative to
            each other, and counts a mocap body as fixed: collision queries need the joints.
    """
    body = scene.worldbody.add_body(name=NAME, mocap=not jointed)
    if jointed:
        slide = mujoco.mjtJoint.mjJNT_SLIDE
        body.add_joint(name="agent-x", type=slide, axis=(1, 0, 0))
        body.add_joint(name="agent-y", type=slide, axis=(0, 1, 0))
    half = (semantics.agent_height - STEP) / 2
    look = {"group": 3, "rgba": (0.2, 0.45, 0.85, 1), "mass": 1.0}
    cylinder, sphere = mujoco.mjtGeom.mjGEOM_CYLINDER, mujoco.mjtGeom.mjGEOM_SPHERE
    size, center = (semantics.agent_radius, half, 0), (0, 0, STEP + half)
    body.add_geom(name="agent.trunk", type=cylinder, size=size, pos=center, **look)
    eye = (0, 0, semantics.eye_height)
    body.add_geom(name="agent.head", type=sphere, size=(HEAD, 0, 0), pos=eye, **look)
    # This mode keeps a camera's compass direction however the body is turned.
    mode = mujoco.mjtCamLight.mjCAMLIGHT_TRACK
    for name, (east, north) in zip(CAMERAS, _AHEAD, strict=True):
        axes = _camera_axes(east, north, semantics.pitch)
        body.add_camera(name=name, mode=mode, pos=eye, xyaxes=axes, fovy=fovy(semantics))


def fovy(semantics: Semantics) -> float:
    """Vertical field of view in degrees, from the horizontal one and the aspect ratio."""
    across = math.tan(semantics.horizontal_fov / 2)
    shape = semantics.view_height / semantics.view_width
    return math.degrees(2 * math.atan(across * shape))


def _camera_axes(east: int, north: int, pitch: float) -> tuple[float, ...]:
    """MuJoCo's `xyaxes`: the image's right and up vectors in the house's frame."""
    sin, cos = math.sin(pitch), math.cos(pitch)
    return north, -east, 0, -sin * east, -sin * north, cos
