"""The folder that an exported house is: anyone's MuJoCo opens it, and dm_control does."""

# mujoco makes its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from house_samples import two_rooms, with_objects

from lcrl_bench.errors import InvalidFileError, InvalidHouseError
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.scenes.export import SCENE_FILE, export_scene
from lcrl_bench.scenes.mjcf import compile_scene, house_mjcf

NUMBERS = (
    *("body_pos", "body_quat", "body_mocapid", "geom_type", "geom_pos", "geom_quat", "geom_size"),
    *("geom_group", "geom_contype", "geom_conaffinity", "geom_dataid", "geom_matid"),
    *("cam_pos", "cam_quat", "cam_fovy", "cam_mode", "light_pos", "light_dir", "light_type"),
    *("mesh_vert", "mesh_face", "mat_rgba", "tex_data"),
)
"""What a scene is made of, as MuJoCo compiles it."""


def built(house: House) -> mujoco.MjModel:
    return compile_scene(house_mjcf(house))


def names(model: mujoco.MjModel) -> list[str]:
    """Names of everything, in order."""
    return [name.decode() for name in model.names.split(b"\0")]


def test_an_exported_scene_is_the_scene_that_was_built(tmp_path):
    house = generate_house(0)
    opened = mujoco.MjModel.from_xml_path(str(export_scene(house, tmp_path / "house")))
    model = built(house)
    assert names(opened) == names(model)
    for field in NUMBERS:
        found, expected = getattr(opened, field), getattr(model, field)
        # Nine digits of at most some tens of metres.
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-7, err_msg=field)
    assert opened.stat.extent == model.stat.extent
    assert opened.vis.map.znear == model.vis.map.znear


def test_an_exported_scene_has_no_words_that_older_releases_do_not_know(tmp_path):
    scene = ElementTree.parse(export_scene(two_rooms(), tmp_path / "house")).getroot()
    words = {(each.tag, name) for each in scene.iter() for name in each.attrib}
    newer = {("texture", "colorspace"), ("mesh", "content_type"), ("light", "type")}
    assert not words & newer
    assert ("light", "directional") in words


def test_a_house_that_mujoco_refuses_leaves_no_folder(tmp_path):
    cup = PlacedObject("agent", "cup", "bedroom", (1, 1, 0.05), (0.1, 0.1, 0.1), 0.0)
    with pytest.raises(InvalidHouseError, match="agent"):
        export_scene(with_objects(two_rooms(), cup), tmp_path / "new" / "house")
    assert list(tmp_path.iterdir()) == []


def test_numbers_too_small_for_a_reader_are_written_as_zero(tmp_path):
    cup = replace(two_rooms().object("cup"), yaw=1e-310)
    others = [thing for thing in two_rooms().objects if thing.id != "cup"]
    scene = export_scene(with_objects(two_rooms(), *others, cup), tmp_path / "house")
    assert mujoco.MjModel.from_xml_path(str(scene)).body("cup").quat.tolist() == [1, 0, 0, 0]


def test_an_exported_scene_is_a_physics_of_dm_control(tmp_path):
    pytest.importorskip("dm_control", reason="dm-control has no wheels from Python 3.13 on")
    if mujoco.__version__.startswith("4."):
        pytest.skip("dm_control 1.0.50 reads fields of MjModel that MuJoCo 4 no longer has")
    house = two_rooms()
    scene = export_scene(house, tmp_path / "house")
    script = (
        "import sys, warnings\n"
        # Looking for a window system, dm_control warns where there is none.
        "warnings.simplefilter('ignore')\n"
        "from dm_control.mujoco import Physics\n"
        "physics = Physics.from_xml_path(sys.argv[1])\n"
        "physics.named.data.mocap_pos['cup'] = (1.0, 1.5, 0.5)\n"
        "physics.step(nstep=10)\n"
        "assert physics.time() > 0\n"
        "assert physics.named.data.xpos['cup'].tolist() == [1.0, 1.5, 0.5]\n"
        "print(*physics.named.data.xpos.axes.row.names)\n"
    )
    # It reads MUJOCO_GL as MuJoCo does, and some values are refused.
    environment = {**os.environ, "MUJOCO_GL": ""}
    done = subprocess.run(
        [sys.executable, "-c", script, str(scene)],
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert {thing.id for thing in house.objects} | {"agent"} <= set(done.stdout.split())


def test_an_exported_folder_opens_from_anywhere(tmp_path, monkeypatch):
    house = two_rooms()
    scene = export_scene(house, tmp_path / "new" / "house")
    monkeypatch.chdir(tmp_path)
    opened, model = mujoco.MjModel.from_xml_path(str(scene)), built(house)
    assert opened.nbody == model.nbody == len(house.objects) + 2
    assert opened.ngeom == model.ngeom
    assert opened.geom_size == pytest.approx(model.geom_size, abs=1e-6)
    assert opened.mesh_vert == pytest.approx(model.mesh_vert, abs=1e-6)
    names = [path.name for path in (scene.parent / "assets").iterdir()]
    assert all(len(name) < 40 and name.isascii() for name in names)
    assert str(tmp_path) not in scene.read_text("utf-8")
    assert sorted(path.name for path in scene.parent.parent.iterdir()) == ["house"]


def test_a_moved_folder_still_opens(tmp_path):
    scene = export_scene(two_rooms(), tmp_path / "here")
    moved = scene.parent.rename(tmp_path / "there")
    assert mujoco.MjModel.from_xml_path(str(moved / SCENE_FILE)).nbody > 2


def test_exporting_twice_replaces_the_whole_folder(tmp_path):
    export_scene(two_rooms(), tmp_path / "house")
    scene = export_scene(two_rooms(furnished=False), tmp_path / "house")
    assert mujoco.MjModel.from_xml_path(str(scene)).nbody == 2
    assert not [path for path in (tmp_path / "house").rglob("*") if "chair" in path.name]


def test_a_folder_of_something_else_is_left_alone(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(InvalidFileError, match="not an exported scene"):
        export_scene(two_rooms(), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_the_same_house_is_exported_to_the_same_bytes(tmp_path):
    folders = [export_scene(two_rooms(), tmp_path / name).parent for name in ("one", "other")]
    contents = [
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*")}
        for folder in folders
    ]
    assert contents[0] == contents[1]
