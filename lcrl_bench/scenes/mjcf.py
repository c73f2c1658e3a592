"""House to MJCF: a scene that any MuJoCo program opens, and that collision queries are asked of.

Geoms for the eye are in group 2 and collide with nothing; geoms that collide are in group 3, which
viewers hide. Every placed object is a body of its own, with its id as name; the 14 task objects are
mocap bodies, so that they can be moved. Objects that are alike share their meshes.
"""

# dm_control and mujoco make their attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false, reportOptionalMemberAccess=false

from __future__ import annotations

import math
import tempfile
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import InvalidFileError, InvalidHouseError
from lcrl_bench.houses.classes import class_id, semantic_classes, task_objects
from lcrl_bench.houses.house import House, PlacedObject, Vector
from lcrl_bench.scenes.agent import add_agent
from lcrl_bench.scenes.building import building_boxes, building_surfaces
from lcrl_bench.scenes.panel import Box
from lcrl_bench.scenes.shapes import Part, collision_parts, object_parts
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

with warnings.catch_warnings():
    # Looking for a window system, dm_control warns where there is none; nothing here opens one.
    warnings.simplefilter("ignore")
    from dm_control import mjcf

SCENE_FILE: Final = "scene.xml"
"""Name of the model in an exported folder."""
ASSET_FOLDER: Final = "assets"
"""Name of the folder of meshes beside it."""
VISUAL: Final = 2
"""Group of the geoms that are seen."""
COLLISION: Final = 3
"""Group of the geoms that collide."""
TILT: Final = 0.3
"""Radians the overview camera leans back from looking straight down."""

# MuJoCo does not read numbers too small for a normal float64.
_ZERO: Any = 1e-12


def house_mjcf(
    house: House,
    semantics: Semantics = DEFAULT_SEMANTICS,
    *,
    visual: bool = True,
    jointed_agent: bool = False,
) -> mjcf.RootElement:
    """Build the MuJoCo scene of a house.

    Args:
        house: The house.
        semantics: Size and cameras of the agent.
        visual: Whether what is only seen is part of it; without, it is quick to build and query.
        jointed_agent: See `agent.add_agent`.

    Returns:
        A scene with a body for each object, and the body `agent` with its four cameras.
    """
    root = mjcf.RootElement(model=house.id)
    root.compiler.angle = "radian"
    # The inertia of a sheet needs no volume; bodies here are fixed, so it is never used.
    root.default.mesh.inertia = "shell"
    seen = root.default.add("default", dclass="seen").geom
    seen.set_attributes(type="mesh", group=VISUAL, contype=0, conaffinity=0)
    root.default.add("default", dclass="solid").geom.group = COLLISION
    root.worldbody.add("geom", dclass="solid", name="ground", type="plane", size=(0, 0, 1))
    builder = _SceneBuilder(root)
    if visual:
        _set_look(root, house)
        for surface in building_surfaces(house):
            builder.add_surface(surface)
    for box in building_boxes(house):
        builder.add_box(box)
    for thing in house.objects:
        builder.add_object(thing, visual=visual)
    add_agent(root, semantics, jointed=jointed_agent)
    return root


def compile_scene(root: mjcf.RootElement) -> mujoco.MjModel:
    """Compile a scene.

    Raises:
        InvalidHouseError: If MuJoCo refuses it, as it does boxes too thin to have a volume.
    """
    text = root.to_xml_string(pretty_print=False, zero_threshold=_ZERO)
    try:
        return mujoco.MjModel.from_xml_string(text, root.get_assets())
    except ValueError as error:
        reason = f"MuJoCo can't compile its scene: {' '.join(str(error).split())}"
        raise InvalidHouseError(root.model, reason, fix="Look for extreme sizes.") from error


def export_scene(house: House, folder: Path, semantics: Semantics = DEFAULT_SEMANTICS) -> Path:
    """Write a house as a folder that MuJoCo opens: `scene.xml` and its meshes.

    The folder appears whole or not at all; one that holds an exported scene already is replaced.

    Returns:
        The path of `scene.xml`.

    Raises:
        InvalidFileError: If `folder` exists and is anything but an exported scene.
    """
    if folder.exists() and not _is_replaceable(folder):
        reason = "exists and is not an exported scene"
        raise InvalidFileError(folder, reason, fix="Name a new folder, or move this one away.")
    root = house_mjcf(house, semantics)
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as name:
        fresh = Path(name) / "new"
        _write_scene(root, fresh)
        if folder.exists():
            folder.rename(Path(name) / "old")
        fresh.rename(folder)
    return folder / SCENE_FILE


def _is_replaceable(folder: Path) -> bool:
    if not folder.is_dir():
        return False
    return {entry.name for entry in folder.iterdir()} <= {SCENE_FILE, ASSET_FOLDER}


def _write_scene(root: mjcf.RootElement, folder: Path) -> None:
    (folder / ASSET_FOLDER).mkdir(parents=True)
    text = root.to_xml_string(precision=9, zero_threshold=_ZERO, filename_with_hash=False)
    # dm_control never writes `meshdir`: it expects every file beside the model.
    text = text.replace("<compiler ", f'<compiler meshdir="{ASSET_FOLDER}" ', 1)
    (folder / SCENE_FILE).write_text(text, encoding="utf-8")
    for mesh in root.asset.find_all("mesh", exclude_attachments=True):
        name = mesh.file.get_vfs_filename(filename_with_hash=False)
        (folder / ASSET_FOLDER / name).write_bytes(mesh.file.contents)


def _set_look(root: mjcf.RootElement, house: House) -> None:
    """Lights, buffer sizes, and an overview camera that shows the house without its ceilings."""
    corners = np.array([point for room in house.rooms for point in room.polygon])
    low, high = corners.min(axis=0), corners.max(axis=0)
    east, north = (float(value) for value in (low + high) / 2)
    # With extent 1 the near plane of every camera is `znear` metres away, whatever the house.
    root.statistic.extent = 1
    root.statistic.center = (east, north, 1)
    root.visual.map.znear, root.visual.map.zfar = 0.01, 400
    root.visual.quality.numquads, root.visual.quality.numstacks = 1, 2
    getattr(root.visual, "global").set_attributes(offwidth=1280, offheight=960, cameraid=0)
    root.visual.headlight.set_attributes(
        ambient=(0.5, 0.5, 0.5), diffuse=(0.25, 0.25, 0.25), specular=(0, 0, 0)
    )
    sky, ground = (0.75, 0.85, 0.95), (0.95, 0.95, 0.95)
    look = {"type": "skybox", "builtin": "gradient", "width": 64, "height": 384}
    root.asset.add("texture", name="sky", rgb1=sky, rgb2=ground, **look)
    root.worldbody.add(
        "light",
        name="sun",
        directional=True,
        castshadow=False,
        pos=(east, north, 10),
        dir=(-0.35, 0.5, -1),
        diffuse=(0.35, 0.35, 0.35),
        specular=(0, 0, 0),
    )
    away = house.height + 1.05 * float(max((high - low).max(), 3.0))
    root.worldbody.add(
        "camera",
        name="overview",
        pos=(east, north - math.tan(TILT) * away, away),
        xyaxes=(1, 0, 0, 0, math.cos(TILT), math.sin(TILT)),
        fovy=45,
    )


class _Piece(NamedTuple):
    """A mesh, or the box it is, of objects that are alike, in their own frame."""

    mesh: mjcf.Element | None
    shade: float = 1.0
    center: Vector = (0.0, 0.0, 0.0)
    half: Vector = (0.0, 0.0, 0.0)


class _SceneBuilder:
    """Adds geoms to a scene; shares materials and meshes."""

    def __init__(self, root: mjcf.RootElement) -> None:
        self._root = root
        self._world: Any = root.worldbody
        self._meshes = 0
        self._materials: dict[tuple[str, float], str] = {}
        self._seen: dict[tuple[str, Vector, int], list[_Piece]] = {}
        self._solid: dict[tuple[str, Vector, int], list[_Piece]] = {}
        self._task = frozenset(task_objects())

    def add_surface(self, surface: Surface) -> None:
        """Add a mesh of the building that is only seen."""
        name = surface.name.replace(":", "-")
        piece = _Piece(self._mesh(name, surface.vertices, surface.faces))
        self._world.add("geom", name=surface.name, **self._look(surface.label, piece))

    def add_box(self, box: Box) -> None:
        """Add a box of the building that collides."""
        self._world.add(
            "geom",
            dclass="solid",
            name=box.name,
            type="box",
            pos=box.center,
            size=box.half,
            euler=(0, 0, box.yaw),
        )

    def add_object(self, thing: PlacedObject, *, visual: bool) -> None:
        """Add the body of an object."""
        body: Any = self._world.add(
            "body",
            name=thing.id,
            pos=thing.position,
            euler=(0, 0, thing.yaw),
            mocap=True if thing.label in self._task else None,
        )
        if visual:
            for number, piece in enumerate(self._visual_pieces(thing)):
                name = f"{thing.id}.seen-{number}"
                body.add("geom", name=name, **self._look(thing.label, piece))
        for number, piece in enumerate(self._solid_pieces(thing)):
            kind = {"type": "box", "pos": piece.center, "size": piece.half}
            if piece.mesh is not None:
                kind = {"type": "mesh", "mesh": piece.mesh}
            body.add("geom", dclass="solid", name=f"{thing.id}.solid-{number}", **kind)

    def _look(self, label: str, piece: _Piece) -> dict[str, Any]:
        """Attributes of a geom that is only seen."""
        material = self._material(label, piece.shade)
        return {"dclass": "seen", "mesh": piece.mesh, "material": material}

    def _visual_pieces(self, thing: PlacedObject) -> list[_Piece]:
        """One mesh for each shade of an object: few meshes draw and compile quickly."""
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

    def _mesh(self, name: str, vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Any:  # noqa: ANN401 - an mjcf element
        self._meshes += 1
        name = f"{name}-{self._meshes}"
        asset = mjcf.Asset(_stl(vertices, faces), ".stl", name)
        return self._root.asset.add("mesh", name=name, file=asset)

    def _material(self, label: str, shade: float) -> str:
        key = (label, shade)
        if key not in self._materials:
            name = label if shade == 1.0 else f"{label}-{round(100 * shade)}"
            red, green, blue, alpha = _color(label)
            rgba = (*(min(1.0, shade * value) for value in (red, green, blue)), alpha)
            self._root.asset.add("material", name=name, rgba=rgba, specular=0.1, shininess=0.2)
            self._materials[key] = name
        return self._materials[key]


def _color(label: str) -> tuple[float, float, float, float]:
    red, green, blue = semantic_classes()[class_id(label)].color
    return red / 255, green / 255, blue / 255, 1.0


def _by_shade(parts: Iterable[Part]) -> dict[float, list[Part]]:
    """Parts by how bright they are beside their object's brightest, in three steps."""
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
