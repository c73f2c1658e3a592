"""Export of a house to a folder that any MuJoCo program opens: `scene.xml` and its meshes."""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from pathlib import Path
from typing import Final
from xml.etree import ElementTree

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.house import House
from lcrl_bench.scenes.mjcf import compile_scene, house_mjcf
from lcrl_bench.scenes.mujoco_import import mujoco
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics
from lcrl_bench.storage import atomic_folder

SCENE_FILE: Final = "scene.xml"
"""Name of the model in an exported folder."""
ASSET_FOLDER: Final = "assets"
"""Name of the mesh folder next to it."""

_NUMBERS: Final = {
    "body": ("pos", "quat"),
    "geom": ("pos", "quat", "size"),
    "camera": ("pos", "quat", "fovy"),
    "light": ("pos", "dir"),
    "material": ("rgba",),
}
"""Element → its attributes that MuJoCo writes with only six digits."""
_ZERO: Final = 1e-12
"""Numbers below this are written as zero: MuJoCo can't read those too small for a float64."""


def export_scene(house: House, folder: Path, semantics: Semantics = DEFAULT_SEMANTICS) -> Path:
    """Write a house as a folder that MuJoCo opens: `scene.xml` and its meshes.

    The folder is written atomically; an existing exported scene is replaced.

    Returns:
        The path of `scene.xml`.

    Raises:
        InvalidFileError: If `folder` exists and is not an exported scene.
        InvalidHouseError: If MuJoCo rejects the scene.
    """
    if folder.exists() and not _is_replaceable(folder):
        reason = "exists and is not an exported scene"
        raise InvalidFileError(folder, reason, fix="Name a new folder, or move this one away.")
    scene = house_mjcf(house, semantics)
    scene.meshdir = ASSET_FOLDER
    text = _scene_xml(scene, compile_scene(scene))
    with atomic_folder(folder) as fresh:
        (fresh / ASSET_FOLDER).mkdir()
        (fresh / SCENE_FILE).write_text(text, encoding="utf-8")
        for file, content in scene.assets.items():
            (fresh / ASSET_FOLDER / file).write_bytes(content)
    return folder / SCENE_FILE


def _is_replaceable(folder: Path) -> bool:
    if not folder.is_dir():
        return False
    return {entry.name for entry in folder.iterdir()} <= {SCENE_FILE, ASSET_FOLDER}


def _scene_xml(scene: mujoco.MjSpec, model: mujoco.MjModel) -> str:
    """The scene as MJCF with nine digits, readable by older releases of MuJoCo too."""
    root = ElementTree.fromstring(scene.to_xml())
    for name, attributes in _NUMBERS.items():
        for element in root.iterfind(f".//{name}[@name]"):
            compiled = getattr(model, name)(element.get("name"))
            for attribute in attributes:
                if attribute in element.attrib:
                    count = len(element.attrib[attribute].split())
                    numbers = getattr(compiled, attribute).ravel()[:count]
                    element.set(attribute, " ".join(map(_number, numbers)))
    for geom in root.iterfind(".//geom[@mesh]"):
        # A mesh has no position of its own; compiling moves it to its centre of mass.
        geom.attrib.pop("pos", None)
        geom.attrib.pop("quat", None)
    for mesh in root.iterfind("asset/mesh"):
        mesh.attrib.pop("content_type", None)
    for texture in root.iterfind("asset/texture"):
        texture.attrib.pop("colorspace", None)
    for light in root.iterfind(".//light[@type='directional']"):
        del light.attrib["type"]
        light.set("directional", "true")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _number(value: float) -> str:
    return "0" if abs(value) < _ZERO else f"{value:.9g}"
