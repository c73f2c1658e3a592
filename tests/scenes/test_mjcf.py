"""The MuJoCo scene of a house: bodies, groups and cameras."""

# mujoco makes its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from house_samples import two_rooms, with_objects

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.scenes.agent import CAMERAS, STEP
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.mjcf import COLLISION, VISUAL, compile_scene, house_mjcf
from lcrl_bench.semantics import DEFAULT_SEMANTICS


def compiled(house: House, **options):
    model = compile_scene(house_mjcf(house, **options))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def test_every_object_is_a_body_with_its_name():
    house = two_rooms()
    model, data = compiled(house)
    assert model.nbody == len(house.objects) + 2
    for thing in house.objects:
        assert data.body(thing.id).xpos == pytest.approx(thing.position)


def test_what_is_seen_does_not_collide_and_what_collides_is_hidden():
    model, _ = compiled(two_rooms())
    seen = model.geom_group == VISUAL
    assert not model.geom_contype[seen].any()
    assert not model.geom_conaffinity[seen].any()
    assert (model.geom_group[~seen] == COLLISION).all()
    assert model.geom_contype[~seen].all()


def test_the_scene_has_the_triangles_of_the_surfaces():
    house = two_rooms()
    model, data = compiled(house)
    for label in {surface.label for surface in house_surfaces(house)}:
        expected = sum(area(s.vertices[s.faces]) for s in house_surfaces(house) if s.label == label)
        found = sum(
            area(triangles(model, data, geom))
            for geom in np.flatnonzero(model.geom_group == VISUAL)
            if model.material(model.geom_matid[geom]).name.rstrip("-0123456789") == label
        )
        assert found == pytest.approx(expected, rel=1e-4)


def triangles(model, data, geom) -> np.ndarray:
    mesh = model.geom_dataid[geom]
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    vertices = model.mesh_vert[first : first + count] @ data.geom_xmat[geom].reshape(3, 3).T
    first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    return (vertices + data.geom_xpos[geom])[model.mesh_face[first : first + count]]


def area(corners: np.ndarray) -> float:
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(sides, axis=1).sum() / 2)


def test_objects_that_are_alike_share_their_meshes():
    one = PlacedObject("one", "chair", "bedroom", (1, 1, 0.45), (0.5, 0.5, 0.9), 0.0)
    other = replace(one, id="other", position=(2.0, 2.0, 0.45), yaw=1.0)
    wider = replace(other, size=(0.6, 0.5, 0.9))
    alone = compiled(with_objects(two_rooms(), one))[0].nmesh
    assert compiled(with_objects(two_rooms(), one, other))[0].nmesh == alone
    assert compiled(with_objects(two_rooms(), one, wider))[0].nmesh > alone


def test_a_task_object_can_be_moved_and_furniture_cannot():
    house = two_rooms()
    model, data = compiled(house)
    assert model.body("cup").mocapid[0] >= 0
    assert model.body("table").mocapid[0] == -1
    before = {thing.id: data.body(thing.id).xpos.copy() for thing in house.objects}
    data.mocap_pos[model.body("cup").mocapid[0]] = (1.0, 1.0, 0.5)
    mujoco.mj_forward(model, data)
    geoms = np.flatnonzero(model.geom_bodyid == model.body("cup").id)
    assert data.geom_xpos[geoms] == pytest.approx(
        np.broadcast_to((1.0, 1.0, 0.5), (len(geoms), 3)), abs=0.1
    )
    moved = [name for name, place in before.items() if (data.body(name).xpos != place).any()]
    assert moved == ["cup"]


def test_cameras_look_north_east_south_west_however_the_agent_is_turned():
    model, data = compiled(two_rooms())
    mocap = model.body("agent").mocapid[0]
    data.mocap_pos[mocap] = (1.5, 1.5, 0)
    data.mocap_quat[mocap] = (math.cos(0.4), 0, 0, math.sin(0.4))
    mujoco.mj_forward(model, data)
    level, tilt = math.cos(DEFAULT_SEMANTICS.pitch), math.sin(DEFAULT_SEMANTICS.pitch)
    for name, (east, north) in zip(CAMERAS, ((0, 1), (1, 0), (0, -1), (-1, 0)), strict=True):
        axes = data.cam(name).xmat.reshape(3, 3)
        assert -axes[:, 2] == pytest.approx((level * east, level * north, tilt), abs=1e-6)
        assert axes[2, 0] == pytest.approx(0, abs=1e-6)
        assert axes[2, 1] > 0.9
        assert data.cam(name).xpos == pytest.approx((1.5, 1.5, DEFAULT_SEMANTICS.eye_height))


def test_four_cameras_close_the_circle():
    model, _ = compiled(two_rooms())
    shape = DEFAULT_SEMANTICS.view_width / DEFAULT_SEMANTICS.view_height
    for name in CAMERAS:
        across = 2 * math.atan(shape * math.tan(math.radians(model.cam(name).fovy[0]) / 2))
        assert across == pytest.approx(math.pi / 2)


def test_the_body_stands_a_step_above_the_floor_and_ends_at_its_height():
    model, data = compiled(two_rooms())
    trunk = data.geom("agent.trunk").xpos[2]
    radius, half, _ = model.geom("agent.trunk").size
    assert radius == DEFAULT_SEMANTICS.agent_radius
    assert trunk - half == pytest.approx(STEP)
    assert trunk + half == pytest.approx(DEFAULT_SEMANTICS.agent_height)


def test_the_near_plane_does_not_depend_on_the_house():
    model, _ = compiled(two_rooms())
    assert model.stat.extent == 1
    assert (model.vis.quality.numquads, model.vis.quality.numstacks) == (1, 2)


@pytest.mark.parametrize("name", ["agent", "world"])
def test_an_object_with_the_name_of_a_body_of_the_scene_is_an_invalid_house(name: str):
    cup = PlacedObject(name, "cup", "bedroom", (1, 1, 0.05), (0.1, 0.1, 0.1), 0.0)
    with pytest.raises(InvalidHouseError, match=f"can't compile its scene.*{name}"):
        compiled(with_objects(two_rooms(), cup))


def test_a_thing_without_a_volume_is_an_invalid_house():
    sheet = PlacedObject("sheet", "chair", "bedroom", (1, 1, 0.45), (1e-30, 0.5, 0.9), 0.0)
    with pytest.raises(InvalidHouseError, match="can't compile its scene"):
        compiled(with_objects(two_rooms(), sheet))


def test_numbers_next_to_zero_change_nothing():
    """Cosines of right angles and the like; MuJoCo's XML reader refuses the smallest of them."""
    one = PlacedObject("one", "chair", "bedroom", (1, 1, 0.45), (0.5, 0.5, 0.9), 0.0)
    tiny = replace(one, position=(1 + 1e-16, 1 - 1e-15, 0.45), yaw=1e-310)
    plain, shifted = (compiled(with_objects(two_rooms(), thing))[0] for thing in (one, tiny))
    assert shifted.body_pos == pytest.approx(plain.body_pos, abs=1e-12)
    assert shifted.body_quat == pytest.approx(plain.body_quat, abs=1e-12)
