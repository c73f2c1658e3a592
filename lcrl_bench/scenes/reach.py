"""`within_reach`: the tiles from which the agent can reach, take or put down a thing.

Being near is not enough: a straight line from the standing point to the thing must not cross a
wall, a window or a closed door, so nothing is grasped through a wall.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import PASSABLE, House, PlacedObject, Point
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.semantics import Semantics

INWARD: Final = 0.1
"""Metres that a line of reach extends into a footprint, so that a box that touches or slightly
penetrates a wall is not reached from the far side."""


def within_reach(
    house: House,
    grid: Grid,
    thing: PlacedObject | Sequence[Point],
    semantics: Semantics,
    *,
    walls: NDArray[np.float64] | None = None,
) -> NDArray[np.bool_]:
    """The tiles from which a thing is within reach.

    Args:
        house: Provides the walls in between.
        grid: Provides the standing points.
        thing: A placed object, or the corners of a convex footprint in order, metres.
        semantics: Provides the reach.
        walls: The house's `solid_segments`, if they are known.

    Returns:
        [tile]: whether the footprint is at most `semantics.reach` from the standing point in plan
        (0 inside it), and a straight line from the standing point to its nearest point or to its
        centre crosses no wall except through a passable opening.
    """
    corners = np.array(thing.footprint() if isinstance(thing, PlacedObject) else thing)
    nearest = nearest_points(corners, grid.points)
    distance = np.linalg.norm(nearest - grid.points, axis=1)
    near = np.flatnonzero(distance <= semantics.reach + 1e-9)
    reached = np.zeros(grid.tiles, bool)
    if len(near) == 0:
        return reached
    walls = solid_segments(house) if walls is None else walls
    middle = corners.mean(axis=0)
    inward = middle - nearest[near]
    depth = np.linalg.norm(inward, axis=1, keepdims=True)
    aims = nearest[near] + inward * np.minimum(1.0, INWARD / np.maximum(depth, 1e-12))
    start = grid.points[near]
    blocked = crosses(start, aims, walls) & crosses(
        start, np.broadcast_to(middle, aims.shape), walls
    )
    reached[near] = ~blocked
    return reached


def nearest_points(
    corners: NDArray[np.float64], points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The point of a convex polygon nearest to each point; the point itself if it lies inside.

    Args:
        corners: [corner, 2] metres, clockwise or counter-clockwise.
        points: [point, 2] metres.

    Returns:
        [point, 2] metres.
    """
    start, along = corners, np.roll(corners, -1, axis=0) - corners
    away = points[:, None, :] - start
    length = np.maximum((along**2).sum(axis=1), 1e-18)
    share = np.clip((away * along).sum(axis=2) / length, 0, 1)
    on_edge = start + share[..., None] * along
    distance = ((points[:, None, :] - on_edge) ** 2).sum(axis=2)
    nearest = on_edge[np.arange(len(points)), distance.argmin(axis=1)]
    side = along[:, 0] * away[..., 1] - along[:, 1] * away[..., 0]
    inside = np.all(side >= 0, axis=1) | np.all(side <= 0, axis=1)
    return np.where(np.expand_dims(inside, 1), points, nearest)


def solid_segments(house: House) -> NDArray[np.float64]:
    """The centre lines of all walls without passable openings: [segment, 2, 2] metres."""
    segments = []
    for wall in house.walls:
        edges = [0.0]
        for opening in wall.openings:
            if opening.kind in PASSABLE:
                edges += [opening.start, opening.end]
        edges.append(wall.length)
        for near, far in zip(edges[::2], edges[1::2], strict=True):
            if far > near:
                segments.append((wall.point(near), wall.point(far)))
    return np.array(segments, np.float64).reshape(-1, 2, 2)


def crosses(
    start: NDArray[np.float64], end: NDArray[np.float64], segments: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether each line from `start` to `end`, [line, 2], touches any of [segment, 2, 2]."""
    one, other = segments[:, 0], segments[:, 1]
    line, wall = end - start, other - one
    before = _cross(line[:, None], one - start[:, None])
    after = _cross(line[:, None], other - start[:, None])
    here = _cross(wall, start[:, None] - one)
    there = _cross(wall, end[:, None] - one)
    # Touching counts: two walls that meet in a corner leave no gap between them.
    touches = (before * after <= 1e-12) & (here * there <= 1e-12)
    return np.any(touches, axis=1, keepdims=True)[:, 0]


def _cross(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
