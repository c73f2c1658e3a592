"""The doll's house: coloured meshes of a house, open to a view from above.

They are the surfaces that physics and cameras use, in the colours of their classes. The ceiling is
left off and walls are cut at chest height, so that every room is visible. Shading is baked into the
colours, so that any viewer shows the shape of things without lights.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
import trimesh
from numpy.typing import NDArray

from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.recording.palette import AGENT, Color, named_class_colors
from lcrl_bench.scenes.building import building_panels
from lcrl_bench.scenes.furnishing import object_surfaces
from lcrl_bench.scenes.panel import Box
from lcrl_bench.scenes.panoramas.merged import rotation
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.semantics import DEFAULT_SEMANTICS

CUT: Final = 1.2
"""Metres above the floor at which walls, windows and doors are cut."""
CUT_COLOR: Final[Color] = (70, 70, 78)
"""Colour of the cut faces, which read as a floor plan."""
AGENT_RADIUS: Final = DEFAULT_SEMANTICS.agent_radius
AGENT_HEIGHT: Final = DEFAULT_SEMANTICS.agent_height
_SUN: Final = np.array([-0.5, -0.75, 0.0])
_GRAIN: Final = 1e-4
"""Metres within which vertices are merged."""


@dataclass(frozen=True, eq=False)
class ColorMesh:
    """Triangles with shading baked into their colours."""

    label: str
    """Class name, or a description."""
    room: str | None
    """Id of its room; None for walls and whatever spans rooms."""
    vertices: NDArray[np.float32]
    """[vertex, 3] metres."""
    faces: NDArray[np.uint32]
    """[triangle, 3]."""
    colors: NDArray[np.uint8]
    """[vertex, 3] RGB."""


def house_meshes(
    scene: Scene, *, without: str | None = None, keep: str = ""
) -> tuple[ColorMesh, ...]:
    """A house without its ceiling, one mesh per class and room.

    What hangs on a wall above the cut is left off with the wall, except `keep`.

    Args:
        scene: The house.
        without: Id of an object to leave out because it is drawn separately.
        keep: Class of objects to show wherever they hang.
    """
    house = scene.house
    hanging = {
        thing.id
        for thing in house.objects
        if thing.base > CUT and thing.support is None and thing.label != keep
    }
    absent = hanging | {without}
    groups: dict[tuple[str | None, str], list[NDArray[np.float64]]] = {}
    for surface in scene.surfaces:
        building = surface.object is None
        if surface.label == "floor" if building else surface.object not in absent:
            triangles = surface.vertices[surface.faces]
            groups.setdefault((surface.room, surface.label), []).append(triangles)
    for panel in building_panels(house):
        for box in panel.boxes():
            if box.center[2] - box.half[2] < CUT:
                groups.setdefault((None, panel.label), []).append(_cut_box(box))
    return tuple(_mesh(label, room, parts) for (room, label), parts in groups.items())


def object_mesh(thing: PlacedObject) -> ColorMesh:
    """One object in its own frame: its box centred on the origin, facing +y."""
    here = replace(thing, position=(0.0, 0.0, 0.0), yaw=0.0)
    parts = [surface.vertices[surface.faces] for surface in object_surfaces(here)]
    return _mesh(thing.label, thing.room, parts)


def agent_mesh() -> ColorMesh:
    """The agent in its own frame: feet at the origin, facing +y, an arrow on its head."""
    body = trimesh.creation.capsule(
        height=AGENT_HEIGHT - 2 * AGENT_RADIUS, radius=AGENT_RADIUS, count=[16, 12]
    )
    body.apply_translation([0, 0, AGENT_RADIUS])
    yellow = _mesh("agent", None, [np.asarray(body.triangles)], AGENT)
    nose = np.array([[-0.16, 0.14], [0.16, 0.14], [0.0, 0.5]])
    low, high = AGENT_HEIGHT * 0.55, AGENT_HEIGHT * 0.55 + 0.1
    arrow = trimesh.creation.extrude_triangulation(nose, np.array([[0, 1, 2]]), high - low)
    arrow.apply_translation([0, 0, low])
    dark = _mesh("agent", None, [np.asarray(arrow.triangles)], (30, 30, 34))
    return _join("agent", [yellow, dark])


def ribbon(points: NDArray[np.float64], color: Color, *, width: float, height: float) -> ColorMesh:
    """A flat strip along a path on the floor.

    Args:
        points: [point, 2] metres; repeated points are skipped.
        color: Its colour.
        width: Metres.
        height: Metres above the floor.
    """
    moved = np.concatenate([[True], np.abs(np.diff(points, axis=0)).max(axis=1) > 0])
    way = points[moved]
    triangles = [np.empty((0, 3, 3))]
    for start, end in pairwise(way):
        along = (end - start) / np.linalg.norm(end - start) * width / 2
        across = np.array([-along[1], along[0]])
        a, b = start - along, end + along
        corners = np.stack([a - across, b - across, b + across, a + across])
        flat = np.column_stack([corners, np.full(4, height)])
        triangles.append(flat[[[0, 1, 2], [0, 2, 3]]])
    return _mesh("path", None, triangles, color)


def placed(mesh: ColorMesh, position: NDArray[np.float64], yaw: float) -> ColorMesh:
    """A mesh rotated by `yaw` and moved to `position`."""
    vertices = mesh.vertices @ rotation(yaw).T + position
    return replace(mesh, vertices=vertices.astype(np.float32))


def _join(label: str, meshes: Iterable[ColorMesh]) -> ColorMesh:
    """Merge several meshes into one."""
    parts = list(meshes)
    offsets = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])]).astype(np.uint32)
    return ColorMesh(
        label,
        None,
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + offset for part, offset in zip(parts, offsets, strict=True)]),
        np.concatenate([part.colors for part in parts]),
    )


def _cut_box(box: Box) -> NDArray[np.float64]:
    """The part of a box below the cut: [triangle, 3, 3]."""
    low = box.center[2] - box.half[2]
    high = min(box.center[2] + box.half[2], CUT)
    solid = trimesh.creation.box((2 * box.half[0], 2 * box.half[1], high - low))
    middle = (box.center[0], box.center[1], (low + high) / 2)
    return np.asarray(solid.triangles) @ rotation(box.yaw).T + middle


def _mesh(
    label: str,
    room: str | None,
    parts: list[NDArray[np.float64]],
    color: Color | None = None,
) -> ColorMesh:
    """Index and shade triangles: vertices with the same position and colour are shared."""
    corners = np.concatenate([np.empty((0, 3, 3)), *parts])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    corners, normals = corners[areas > 1e-12], normals[areas > 1e-12]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    base = np.asarray(named_class_colors()[label] if color is None else color)
    shades = np.clip(base * _light(normals)[:, None], 0, 255).round().astype(np.int64)
    if color is None and room is None:
        cut = (np.abs(corners[:, :, 2] - CUT) < _GRAIN).all(axis=1) & (normals[:, 2] > 0.5)
        shades[cut] = CUT_COLOR
    places = np.round(corners / _GRAIN).astype(np.int64).reshape(-1, 3)
    rows = np.column_stack([places, np.repeat(shades, 3, axis=0)])
    unique, index = np.unique(rows, axis=0, return_inverse=True)
    return ColorMesh(
        label,
        room,
        (unique[:, :3] * _GRAIN).astype(np.float32),
        index.reshape(-1, 3).astype(np.uint32),
        unique[:, 3:].astype(np.uint8),
    )


def _light(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Brightness of faces, about 0.55 .. 1.05: a bright sky and a soft sun in the south-west."""
    sky = 0.5 + 0.5 * normals[:, 2]
    return 0.62 + 0.3 * sky + 0.14 * (normals @ _SUN)
