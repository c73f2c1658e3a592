"""Surfaces to merged meshes: few large meshes per class instead of many small ones.

Drawing fewer meshes is faster, and a panorama only needs the class of each pixel. So static
surfaces are merged by class, room and neighbourhood (small enough that much of it is out of view
at once); each movable object keeps its own meshes, so that it can be hidden or moved without
rebuilding anything.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.surface import Surface

_NEIGHBOURHOOD: Final = 3.0
"""Side in metres of the squares merged: a trade-off of few draws and tight bounding boxes."""


@dataclass(frozen=True, eq=False)
class MergedMesh:
    """Triangles of one class that are drawn or hidden together."""

    class_id: int
    """0..60: its pixel value."""
    room: str | None
    """Id of its room; None if it spans rooms."""
    object: str | None
    """Id of the movable object it is part of; None if it is static."""
    vertices: NDArray[np.float64]
    """[vertex, 3] metres, house frame."""
    faces: NDArray[np.int32]
    """[triangle, 3] vertex indices; none of them degenerate."""


def merge_surfaces(
    surfaces: Sequence[Surface], movable: Collection[str] = ()
) -> tuple[MergedMesh, ...]:
    """Merge surfaces by class, room, neighbourhood and movable object, in order of appearance.

    Args:
        surfaces: Everything in the house.
        movable: Ids of the objects that keep their own meshes.

    Returns:
        The merged meshes, without faces of zero area and without empty meshes.
    """
    groups: dict[tuple[int, str | None, str | None, tuple[int, int]], list[Surface]] = {}
    for surface in surfaces:
        owner = surface.object if surface.object in movable else None
        place = (0, 0) if owner else _neighbourhood(surface)
        key = (class_id(surface.label), surface.room, owner, place)
        groups.setdefault(key, []).append(surface)
    merged = (_merge(*key[:3], parts) for key, parts in groups.items())
    return tuple(mesh for mesh in merged if len(mesh.faces))


def _neighbourhood(surface: Surface) -> tuple[int, int]:
    """The square in plan that contains the centre of the surface's bounding box."""
    middle = (surface.vertices.min(axis=0) + surface.vertices.max(axis=0)) / 2
    column, row = np.floor(middle[:2] / _NEIGHBOURHOOD)
    return int(column), int(row)


def _merge(
    class_number: int, room: str | None, owner: str | None, parts: Sequence[Surface]
) -> MergedMesh:
    offsets = np.cumsum([0] + [len(part.vertices) for part in parts[:-1]])
    vertices = np.concatenate([part.vertices for part in parts])
    shifted = [part.faces + offset for part, offset in zip(parts, offsets, strict=True)]
    faces = np.concatenate(shifted).astype(np.int32)
    edges = vertices[faces[:, 1:]] - vertices[faces[:, :1]]
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return MergedMesh(class_number, room, owner, vertices, faces[areas > 0])


def moved_vertices(
    vertices: NDArray[np.float64], source: PlacedObject, target: PlacedObject
) -> NDArray[np.float64]:
    """The vertices of an object moved rigidly from one pose to another.

    Args:
        vertices: [vertex, 3] metres, house frame, of the object at `source`.
        source: The object at the pose of the vertices.
        target: The same object at the new pose.

    Returns:
        [vertex, 3] metres, house frame.
    """
    turn = rotation(target.yaw - source.yaw)
    return (vertices - np.asarray(source.position)) @ turn.T + np.asarray(target.position)


def rotation(yaw: float) -> NDArray[np.float64]:
    """[3, 3]: the rotation by `yaw` radians counter-clockwise about z."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def arranged_vertices(
    mesh: MergedMesh, movable: Mapping[str, PlacedObject], arrangement: Arrangement
) -> NDArray[np.float64] | None:
    """The vertices of a movable object's mesh in an arrangement; None while it is invisible.

    Args:
        mesh: A mesh with an `object`.
        movable: The movable objects at their original places, by id.
        arrangement: Which of them is hidden or moved.
    """
    if mesh.object is None or mesh.object != arrangement.hidden:
        return mesh.vertices
    if arrangement.placed is None:
        return None
    return moved_vertices(mesh.vertices, movable[mesh.object], arrangement.placed)


def moved_pose(
    position: NDArray[np.float64],
    matrix: NDArray[np.float64],
    source: PlacedObject,
    target: PlacedObject,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """`moved_vertices` for a frame: its origin [3] and its axes [3, 3] in the house's frame."""
    origin = moved_vertices(position[None, :], source, target)[0]
    return origin, rotation(target.yaw - source.yaw) @ matrix
