"""Occlusion culling: a conservative test of which meshes are hidden behind walls.

Where a wall's triangles cover a stretch of a plane over its full height, that stretch is a solid
upright rectangle. In plan, the rectangle casts a shadow from the eye; an upright box that lies
entirely in the shadow, and between the rectangle's lower and upper edge, is invisible.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from lcrl_bench.houses.classes import class_id
from lcrl_bench.scenes.panoramas.merged import MergedMesh

_SHORTEST: Final = 0.4
"""Metres; shorter stretches of wall hide almost nothing."""
_EDGE: Final = 0.01
"""Safety margin in metres by which stretches are shortened and shadows narrowed."""


@dataclass(frozen=True, eq=False)
class Occluders:
    """Solid upright rectangles."""

    starts: NDArray[np.float64]
    """[rectangle, 2]: one end in plan, metres."""
    ends: NDArray[np.float64]
    """[rectangle, 2]: the other end."""
    heights: NDArray[np.float64]
    """[rectangle, 2]: lower and upper edge, metres above the floor."""


def find_occluders(meshes: Sequence[MergedMesh]) -> Occluders:
    """The solid stretches of the static meshes of class wall."""
    wall = class_id("wall")
    walls = [mesh for mesh in meshes if mesh.class_id == wall and mesh.object is None]
    triangles = [mesh.vertices[mesh.faces] for mesh in walls]
    found = list(_stretches(np.concatenate(triangles))) if triangles else []
    rows = np.array(found, np.float64).reshape(-1, 6)
    return Occluders(rows[:, :2], rows[:, 2:4], rows[:, 4:])


def occluded(
    occluders: Occluders, boxes: NDArray[np.float64], eyes: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether any single rectangle hides each box.

    Args:
        occluders: The solid rectangles.
        boxes: [2, box, 3] lowest and highest corner, metres.
        eyes: [eye, 3] metres.

    Returns:
        [eye, box]; True only if the whole box is hidden.
    """
    shape = (len(eyes), *occluders.starts.shape)
    eye = np.broadcast_to(eyes[:, None, :2], shape)
    start, end = np.broadcast_to(occluders.starts, shape), np.broadcast_to(occluders.ends, shape)
    # In the shadow, a box is on the far side of all three lines.
    behind = _half_plane(start, end, away_from=eye)
    beside_start = _half_plane(eye, start, away_from=2 * start - end)
    beside_end = _half_plane(eye, end, away_from=2 * end - start)
    low, high = boxes
    centres, halves = ((low + high) / 2)[:, :2].T, ((high - low) / 2)[:, :2].T
    bottoms, tops = occluders.heights.T
    shadowed = (bottoms[:, None] <= low[:, 2]) & (tops[:, None] >= high[:, 2])
    level = (bottoms <= eyes[:, 2:]) & (tops >= eyes[:, 2:])
    shadowed = shadowed & level[:, :, None]
    for normal, offset in (behind, beside_start, beside_end):
        nearest = normal @ centres - np.abs(normal) @ halves + offset[..., None]
        shadowed &= nearest > _EDGE
    return shadowed.any(axis=1)


def _half_plane(
    first: NDArray[np.float64], second: NDArray[np.float64], *, away_from: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Unit normal and offset of the line through two points, positive away from `away_from`.

    If the points coincide, or the line contains `away_from`, it is positive nowhere.
    """
    along = second - first
    normal = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    offset = -(normal * first).sum(axis=-1)
    sign = -np.sign((normal * away_from).sum(axis=-1) + offset)
    return sign[..., None] * normal, sign * offset


def _stretches(triangles: NDArray[np.float64]) -> Iterator[tuple[float, ...]]:
    """(x0, y0, x1, y1, bottom, top) of each solid stretch in upright triangles [triangle, 3, 3]."""
    edges = triangles[:, 1:] - triangles[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    upright = np.abs(normals[:, 2]) < 1e-6
    triangles, normals = triangles[upright], normals[upright, :2]
    # Both sides of a plane are the same plane: make normals point east, or else north.
    west = (normals[:, 0] < -1e-6) | ((np.abs(normals[:, 0]) <= 1e-6) & (normals[:, 1] < 0))
    normals[west] *= -1
    offsets = np.einsum("tk,tk->t", normals, triangles[:, 0, :2])
    keys = np.round(np.column_stack([normals * 1e4, offsets * 1e3]))
    planes, members = np.unique(keys, axis=0, return_inverse=True)
    for plane in range(len(planes)):
        inside = members.ravel() == plane
        normal = normals[inside][0]
        along = np.array([-normal[1], normal[0]])
        origin = offsets[inside].mean() * normal
        flat = np.stack([triangles[inside][..., :2] @ along, triangles[inside][..., 2]], axis=-1)
        bottom, top = float(flat[..., 1].min()), float(flat[..., 1].max())
        for start, end in _solid_spans(flat):
            yield (*(origin + start * along), *(origin + end * along), bottom, top)


def _solid_spans(triangles: NDArray[np.float64]) -> Iterator[tuple[float, float]]:
    """The spans of the first axis over which triangles [triangle, 3, 2] cover the full height."""
    covered = shapely.unary_union(shapely.polygons(triangles))
    left, bottom, right, top = covered.bounds
    sliver = 1e-3
    whole = shapely.box(left, bottom + sliver, right, top - sliver)
    holes = [hole.bounds for hole in shapely.get_parts(whole.difference(covered))]
    reached = left
    for start, end in [*sorted((hole[0], hole[2]) for hole in holes), (right, right)]:
        if start - reached > _SHORTEST:
            yield reached + _EDGE, start - _EDGE
        reached = max(reached, end)
