"""A bird's-eye picture of a house by ray casting: no OpenGL or screen, the same on any machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from lcrl_bench.recording.meshes import ColorMesh, placed, ribbon
from lcrl_bench.recording.palette import PATH
from lcrl_bench.recording.storyboard import Storyboard

SIZE: Final = (960, 700)
"""Columns and rows; a picture fills at least one of them, and empty borders are trimmed."""
_FINER: Final = 2
"""Rays along each side of a pixel."""
_LIFT: Final = np.radians(58.0)
"""Angle of the view above the horizon."""
_TURN: Final = np.radians(-72.0)
"""Direction of the eye from the house, counter-clockwise from east: slightly east of south."""
_VIEW: Final = np.radians(28.0)
"""Vertical field of view."""
_REACH: Final = 0.7
"""Metres within which things darken one another."""
_FEELERS: Final = 10
"""Rays cast to find what darkens a point."""
_BORDER: Final = 6
"""Pixels of margin kept around a picture."""
_BATCH: Final = 1 << 19


@dataclass(frozen=True)
class Camera:
    """Where a picture is taken from."""

    eye: NDArray[np.float64]
    """[3] metres."""
    axes: NDArray[np.float64]
    """[3, 3]: the unit vectors right, forward and up."""


def bird_picture(board: Storyboard, step: int, size: tuple[int, int] = SIZE) -> NDArray[np.uint8]:
    """The house at a step of an episode, with the agent and its path so far.

    Args:
        board: What happened.
        step: 0 .. horizon.
        size: Columns and rows; the picture fills at least one of them.

    Returns:
        uint8 [row, column, 4] RGB and opacity: 0 where there is no house.
    """
    shown = board.steps[step]
    movers = [(board.agent, shown.agent)]
    if board.thing is not None and shown.thing is not None:
        movers.append((board.thing, shown.thing))
    path = ribbon(board.points[: step + 1], PATH, width=0.07, height=0.035)
    there = [placed(mesh, pose.position, pose.yaw) for mesh, pose in movers]
    return draw([*board.scenery, path, *there], size)


def draw(meshes: Sequence[ColorMesh], size: tuple[int, int] = SIZE) -> NDArray[np.uint8]:
    """Draw meshes from above, framed to fill the picture.

    Args:
        meshes: What to draw.
        size: Columns and rows.

    Returns:
        uint8 [row, column, 4] RGB and opacity: 0 where there is nothing.
    """
    corners = np.concatenate([mesh.vertices[mesh.faces] for mesh in meshes]).astype(np.float32)
    colors = np.concatenate([mesh.colors[mesh.faces[:, 0]] for mesh in meshes])
    scene = EmbreeScene(robust=True)
    TriangleMesh(scene, corners)
    columns, rows = size[0] * _FINER, size[1] * _FINER
    camera = frame(corners.reshape(-1, 3), size)
    picture = np.zeros((rows * columns, 4))
    directions = _rays(camera, columns, rows)
    eye = camera.eye.astype(np.float32)
    for start in range(0, len(directions), _BATCH):
        rays = directions[start : start + _BATCH]
        found = scene.run(np.broadcast_to(eye, rays.shape).copy(), rays, output=True)
        hit = np.flatnonzero(found["primID"] >= 0)
        triangles = found["primID"][hit]
        points = eye + rays[hit] * found["tfar"][hit, None]
        light = _openness(scene, points, _facing(corners[triangles], rays[hit]))
        picture[start + hit, :3] = colors[triangles] * light[:, None]
        picture[start + hit, 3] = 255
    mean = picture.reshape(size[1], _FINER, size[0], _FINER, 4).mean(axis=(1, 3))
    # An edge has the colour of the rays that hit, and their share as its opacity.
    mean[..., :3] *= 255 / np.maximum(mean[..., 3:], 1)
    return _trim(mean.round().clip(0, 255).astype(np.uint8))


def _trim(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Trim a picture's empty border to a few pixels."""
    drawn = picture[..., 3] > 0
    rows, columns = np.flatnonzero(drawn.max(axis=1)), np.flatnonzero(drawn.max(axis=0))
    top, left = max(rows[0] - _BORDER, 0), max(columns[0] - _BORDER, 0)
    return picture[top : rows[-1] + _BORDER, left : columns[-1] + _BORDER]


def frame(points: NDArray[np.float32], size: tuple[int, int]) -> Camera:
    """The camera that sees exactly all points, at the usual angle."""
    back = np.array([np.cos(_TURN) * np.cos(_LIFT), np.sin(_TURN) * np.cos(_LIFT), np.sin(_LIFT)])
    forward = -back
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    axes = np.stack([right, forward, np.cross(right, forward)])
    local = points @ axes.T.astype(np.float32)
    across, along, upward = local.T
    half_height = np.tan(_VIEW / 2)
    half_width = half_height * size[0] / size[1]
    x, far_enough_x = _stand(across, along, half_width)
    z, far_enough_z = _stand(upward, along, half_height)
    return Camera(np.array([x, min(far_enough_x, far_enough_z), z]) @ axes, axes)


def _stand(across: NDArray, along: NDArray, half: float) -> tuple[float, float]:
    """Position of the eye across and along the view such that two sides of the picture are tight.

    A point is inside if `|across - eye| <= half * (along - depth)`.
    """
    upper = float((across - half * along).max())
    lower = float((-across - half * along).max())
    return (upper - lower) / 2, -(upper + lower) / (2 * half)


def _rays(camera: Camera, columns: int, rows: int) -> NDArray[np.float32]:
    """[row * column, 3] unit vectors, row 0 at the top."""
    half = np.tan(_VIEW / 2)
    x = ((2 * np.arange(columns) + 1) / columns - 1) * half * columns / rows
    z = (1 - (2 * np.arange(rows) + 1) / rows) * half
    right, forward, up = camera.axes
    rays = forward + x[None, :, None] * right + z[:, None, None] * up
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return rays.reshape(-1, 3).astype(np.float32)


def _facing(corners: NDArray[np.float32], rays: NDArray[np.float32]) -> NDArray[np.float32]:
    """[hit, 3]: unit normals of the triangles hit, on the side the rays came from."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    away = (normals * rays).sum(axis=1) > 0
    return np.where(away[:, None], -normals, normals)


def _openness(
    scene: EmbreeScene, points: NDArray[np.float32], normals: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Ambient occlusion near each point, as brightness 0.55 .. 1."""
    turns = np.arange(_FEELERS) * np.pi * (3 - np.sqrt(5))
    tilts = np.sqrt((np.arange(_FEELERS) + 0.5) / _FEELERS)
    flat = np.abs(normals[:, 2:]) > 0.9
    east, up = np.eye(3, dtype=np.float32)[[0, 2]]
    first = np.cross(normals, np.where(flat, east, up))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    starts = points + normals * np.float32(2e-3)
    closed = np.zeros(len(points), np.int64)
    for turn, tilt in zip(turns, tilts, strict=True):
        ray = first * np.float32(tilt * np.cos(turn))
        ray += second * np.float32(tilt * np.sin(turn))
        ray += normals * np.float32(np.sqrt(1 - tilt**2))
        reach = np.full(len(points), _REACH, np.float32)
        closed += np.asarray(scene.run(starts, ray, dists=reach, query="OCCLUDED")) >= 0
    return 1.0 - 0.45 * closed / _FEELERS
