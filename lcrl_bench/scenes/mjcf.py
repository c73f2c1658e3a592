"""House to MuJoCo: a scene for any MuJoCo program, and for collision queries.

Visual geoms are in group 2 and collide with nothing; collision geoms are in group 3, which viewers
hide. Every placed object is a body named by its id; the 14 task objects are mocap bodies, so that
they can be moved. Identical objects share their meshes.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.classes import class_id, semantic_classes, task_objects
from lcrl_bench.houses.house import House, PlacedObject, Vector
from lcrl_bench.scenes.agent import add_agent
from lcrl_bench.scenes.building import building_boxes, building_surfaces
from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.scenes.panel import Box
from lcrl_bench.scenes.shapes import Part, collision_parts, object_parts
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

VISUAL: Final = 2
"""Group of the visual geoms."""
COLLISION: Final = 3
"""Group of the collision geoms."""
TILT: Final = 0.3
"""Tilt in radians of the overview camera from looking straight down."""


def house_mjcf(
    house: House,
    semantics: Semantics = DEFAULT_SEMANTICS,
    *,
    visual: bool = True,
    jointed_agent: bool = False,
) -> mujoco.MjSpec:
    """Build the MuJoCo scene of a house.

    Args:
        house: The house.
        semantics: Size and cameras of the agent.
        visual: Whether to include visual geoms; without them, building and queries are faster.
        jointed_agent: See `agent.add_agent`.

    Returns:
        A scene with one body per object, and the body `agent` with its four cameras.

    Raises:
        InvalidHouseError: If MuJoCo rejects part of it, such as a duplicate name.
    """
    scene = mujoco.MjSpec()
    scene.modelname = house.id
    scene.compiler.degree = False
    # Shell inertia needs no volume; bodies here are fixed, so it is never used.
    scene.default.mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
    builder = _SceneBuilder(scene)
    if visual:
        _set_look(scene, house)
        for surface in building_surfaces(house):
            builder.add_surface(surface)
    for box in building_boxes(house):
        builder.add_box(box)
    with _refusals(house.id):
        for thing in house.objects:
            builder.add_object(thing, visual=visual)
        add_agent(scene, semantics, jointed=jointed_agent)
    scene.assets = builder.assets
    return scene


def compile_scene(scene: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a scene.

    Raises:
        InvalidHouseError: If MuJoCo rejects it, for instance for a box without volume.
    """
    with _refusals(scene.modelname):
        return scene.compile()


@contextmanager
def _refusals(house: str) -> Iterator[None]:
    """Turn MuJoCo's errors into errors about the house."""
    try:
        yield
    except ValueError as error:
        reason = f"MuJoCo can't compile its scene: {' '.join(str(error).split())}"
        fix = "Look for extreme sizes, and for objects called 'agent' or 'world'."
        raise InvalidHouseError(house, reason, fix=fix) from error


def _set_look(scene: mujoco.MjSpec, house: House) -> None:
    """Lights, buffer sizes, and an overview camera that shows the house without its ceilings."""
    corners = np.array([point for room in house.rooms for point in room.polygon])
    low, high = corners.min(axis=0), corners.max(axis=0)
    east, north = (float(value) for value in (low + high) / 2)
    # With extent 1 the near plane of every camera is `znear` metres away, whatever the house.
    scene.stat.extent = 1
    scene.stat.center = (east, north, 1)
    visual = scene.visual
    visual.map.znear, visual.map.zfar = 0.01, 400
    visual.quality.numquads, visual.quality.numstacks = 1, 2
    visual.global_.offwidth, visual.global_.offheight, visual.global_.cameraid = 1280, 960, 0
    visual.headlight.ambient = (0.5, 0.5, 0.5)
    visual.headlight.diffuse = (0.25, 0.25, 0.25)
    visual.headlight.specular = (0, 0, 0)
    scene.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        width=64,
        height=384,
        rgb1=(0.75, 0.85, 0.95),
        rgb2=(0.95, 0.95, 0.95),
    )
    scene.worldbody.add_light(
        name="sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        castshadow=False,
        pos=(east, north, 10),
        dir=(-0.35, 0.5, -1),
        diffuse=(0.35, 0.35, 0.35),
        specular=(0, 0, 0),
    )
    away = house.height + 1.05 * float(max((high - low).max(), 3.0))
    scene.worldbody.add_camera(
        name="overview",
        pos=(east, north - math.tan(TILT) * away, away),
        xyaxes=(1, 0, 0, 0, math.cos(TILT), math.sin(TILT)),
        fovy=45,
    )


class _Piece(NamedTuple):
    """A named mesh, or a box, shared by identical objects, in the object's frame."""

    mesh: str | None
    shade: float = 1.0
    center: Vector = (0.0, 0.0, 0.0)
    half: Vector = (0.0, 0.0, 0.0)


class _SceneBuilder:
    """Adds geoms to a scene; shares materials and meshes."""

    def __init__(self, scene: mujoco.MjSpec) -> None:
        self.assets: dict[str, bytes] = {}
        """Mesh file name → its content."""
        self._scene = scene
        self._world = scene.worldbody
        self._seen_class = scene.add_default("seen", scene.default)
        look = self._seen_class.geom
        look.type, look.group = mujoco.mjtGeom.mjGEOM_MESH, VISUAL
        look.contype = look.conaffinity = 0
        self._solid_class = scene.add_default("solid", scene.default)
        self._solid_class.geom.group = COLLISION
        plane = {"type": mujoco.mjtGeom.mjGEOM_PLANE, "size": (0, 0, 1)}
        self._world.add_geom(self._solid_class, name="ground", **plane)
        self._materials: dict[tuple[str, float], str] = {}
        self._seen: dict[tuple[str, Vector, int], list[_Piece]] = {}
        self._solid: dict[tuple[str, Vector, int], list[_Piece]] = {}
        self._task = frozenset(task_objects())

    def add_surface(self, surface: Surface) -> None:
        """Add a visual mesh of the building."""
        mesh = self._mesh(surface.name.replace(":", "-"), surface.vertices, surface.faces)
        self._add_seen(self._world, surface.name, surface.label, _Piece(mesh))

    def add_box(self, box: Box) -> None:
        """Add a collision box of the building."""
        kind = {"type": mujoco.mjtGeom.mjGEOM_BOX, "pos": box.center, "size": box.half}
        self._world.add_geom(self._solid_class, name=box.name, quat=_turn(box.yaw), **kind)

    def add_object(self, thing: PlacedObject, *, visual: bool) -> None:
        """Add the body of an object."""
        place = {"pos": thing.position, "quat": _turn(thing.yaw)}
        body = self._world.add_body(name=thing.id, mocap=thing.label in self._task, **place)
        if visual:
            for number, piece in enumerate(self._visual_pieces(thing)):
                self._add_seen(body, f"{thing.id}.seen-{number}", thing.label, piece)
        for number, piece in enumerate(self._solid_pieces(thing)):
            if piece.mesh is None:
                box = mujoco.mjtGeom.mjGEOM_BOX
                kind = {"type": box, "pos": piece.center, "size": piece.half}
            else:
                kind = {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": piece.mesh}
            body.add_geom(self._solid_class, name=f"{thing.id}.solid-{number}", **kind)

    def _add_seen(self, body: mujoco.MjsBody, name: str, label: str, piece: _Piece) -> None:
        """Add a visual geom."""
        look = {"meshname": piece.mesh, "material": self._material(label, piece.shade)}
        body.add_geom(self._seen_class, name=name, **look)

    def _visual_pieces(self, thing: PlacedObject) -> list[_Piece]:
        """One mesh per shade of an object: few meshes draw and compile quickly."""
        key = (thing.label, thing.size, thing.shape)
        if key not in self._seen:
            shades = _by_shade(object_parts(*key))
            self._seen[key] = [
                _Piece(self._mesh(thing.label, *_joined(parts)), shade)
                for shade, parts in shades.items()
            ]
        return self._seen[key]

    def _solid_pieces(self, thing: PlacedObject) -> list[_Piece]:
        key = (thing.label, thing.size, thing.shape)
        if key not in self._solid:
            self._solid[key] = [self._solid_piece(part, thing) for part in collision_parts(*key)]
        return self._solid[key]

    def _solid_piece(self, part: Part, thing: PlacedObject) -> _Piece:
        low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
        center, half = _vector((low + high) / 2), _vector((high - low) / 2)
        if len(part.vertices) == 8 and np.isin(part.vertices, (low, high)).all():
            return _Piece(None, center=center, half=half)
        return _Piece(self._mesh(f"{thing.label}-solid", part.vertices, part.faces))

    def _mesh(self, name: str, vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> str:
        name = f"{name}-{len(self.assets) + 1}"
        file = f"{name}.stl"
        self.assets[file] = _stl(vertices, faces)
        self._scene.add_mesh(name=name, file=file)
        return name

    def _material(self, label: str, shade: float) -> str:
        key = (label, shade)
        if key not in self._materials:
            name = label if shade == 1.0 else f"{label}-{round(100 * shade)}"
            red, green, blue, alpha = _color(label)
            rgba = (*(min(1.0, shade * value) for value in (red, green, blue)), alpha)
            self._scene.add_material(name=name, rgba=rgba, specular=0.1, shininess=0.2)
            self._materials[key] = name
        return self._materials[key]


def _turn(yaw: float) -> tuple[float, float, float, float]:
    """The quaternion of a rotation by `yaw` radians about z."""
    return math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)


def _color(label: str) -> tuple[float, float, float, float]:
    red, green, blue = semantic_classes()[class_id(label)].color
    return red / 255, green / 255, blue / 255, 1.0


def _by_shade(parts: Iterable[Part]) -> dict[float, list[Part]]:
    """Parts by brightness relative to the object's brightest, in three steps."""
    parts = list(parts)
    bright = [max(sum(part.tint), 0.15) for part in parts]
    shades: dict[float, list[Part]] = {}
    for part, value in zip(parts, bright, strict=True):
        share = value / max(bright)
        shade = 1.0 if share > 0.85 else 0.85 if share > 0.5 else 0.7
        shades.setdefault(shade, []).append(part)
    return shades


def _joined(parts: list[Part]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=False)]
    return np.concatenate([part.vertices for part in parts]), np.concatenate(faces)


def _vector(values: NDArray[np.float64]) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _stl(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> bytes:
    """A mesh as binary STL."""
    layout = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
    triangles = np.zeros(len(faces), layout)
    triangles["corners"] = vertices[faces]
    return bytes(80) + np.uint32(len(faces)).tobytes() + triangles.tobytes()
