"""OpenGL, rays and a naive rendering of the full MuJoCo scene show the same."""

# mujoco makes its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from house_samples import two_rooms
from numpy.typing import NDArray
from panorama_samples import agreement, need_gl, standing_points

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import House
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.houses.procthor import import_procthor
from lcrl_bench.scenes.agent import CAMERAS
from lcrl_bench.scenes.agent import NAME as AGENT
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.mjcf import VISUAL, compile_scene, house_mjcf
from lcrl_bench.scenes.panoramas import movable_objects, open_renderer
from lcrl_bench.scenes.panoramas.camera import eye_positions
from lcrl_bench.scenes.panoramas.context import open_context
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

LARGE = replace(DEFAULT_SEMANTICS, view_width=64, view_height=64)


@lru_cache(maxsize=8)
def procedural(seed: int) -> House:
    return generate_house(seed)


def panoramas(
    house: House,
    points: NDArray[np.float64],
    backend: str,
    *,
    arrangement: Arrangement = AS_FOUND,
    semantics: Semantics = DEFAULT_SEMANTICS,
) -> NDArray[np.uint8]:
    with open_renderer(
        house_surfaces(house), semantics, movable=movable_objects(house), backend=backend
    ) as renderer:
        return renderer.render(points, arrangement)


def assert_agree(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> None:
    share = agreement(one, other)
    assert share.mean() >= 0.999
    assert share.min() >= 0.99


def naive_panoramas(
    house: House, points: NDArray[np.float64], monkeypatch: pytest.MonkeyPatch
) -> NDArray[np.uint8]:
    """The exported scene through `mujoco.Renderer` and the agent's own cameras, geom by geom."""
    # mujoco.Renderer looks for a screen unless MUJOCO_GL is set, which no test does.
    contexts = mujoco.rendering.classic.renderer.gl_context
    monkeypatch.setattr(contexts, "GLContext", open_context, raising=False)
    model = compile_scene(house_mjcf(house))
    model.stat.extent, model.vis.map.znear = 1.0, 0.01
    model.vis.quality.offsamples = 0
    data = mujoco.MjData(model)
    classes = _classes_of_geoms(house, model)
    options = mujoco.MjvOption()
    options.geomgroup[:] = 0
    options.geomgroup[VISUAL] = 1
    semantics = DEFAULT_SEMANTICS
    views = np.zeros((len(points), 4, semantics.view_height, semantics.view_width), np.uint8)
    with mujoco.Renderer(model, semantics.view_height, semantics.view_width) as renderer:
        renderer.enable_segmentation_rendering()
        renderer.scene.flags[mujoco.mjtRndFlag.mjRND_CULL_FACE] = 0
        for index, eye in enumerate(eye_positions(points, semantics)):
            data.mocap_pos[model.body(AGENT).mocapid[0]] = (eye[0], eye[1], 0.0)
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            for view, camera in enumerate(CAMERAS):
                renderer.update_scene(data, camera, options)
                views[index, view] = classes[renderer.render()[..., 0]]
    return views


def _classes_of_geoms(house: House, model: mujoco.MjModel) -> NDArray[np.uint8]:
    """[geom + 1]: class of each geom; the last is for -1, nothing."""
    labels = {surface.name: surface.label for surface in house_surfaces(house)}
    labels |= {thing.id: thing.label for thing in house.objects}
    classes = np.zeros(model.ngeom + 1, np.uint8)
    for number in range(model.ngeom):
        geom = model.geom(number)
        owner = model.body(geom.bodyid[0]).name
        label = labels.get(geom.name) or labels.get(owner)
        classes[number] = class_id(label) if label else 0
    return classes


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_rays_show_what_opengl_shows_in_procedural_houses(seed: int):
    need_gl()
    house = procedural(seed)
    points = standing_points(house, 200)
    assert_agree(panoramas(house, points, "gl"), panoramas(house, points, "rays"))


def test_rays_show_what_opengl_shows_in_square_views():
    need_gl()
    house = procedural(1)
    points = standing_points(house)
    assert_agree(
        panoramas(house, points, "gl", semantics=LARGE),
        panoramas(house, points, "rays", semantics=LARGE),
    )


def test_rays_show_what_opengl_shows_in_real_houses(real_houses: Path):
    need_gl()
    tried = 0
    for path in sorted((real_houses / "procthor").rglob("*house_*.json")):
        try:
            house = import_procthor(path).house
        except InvalidFileError:
            continue
        points = standing_points(house)
        assert_agree(panoramas(house, points, "gl"), panoramas(house, points, "rays"))
        tried += 1
    assert tried > 0


@pytest.mark.parametrize("house", [two_rooms(), procedural(0)], ids=lambda house: house.id)
def test_the_fast_arrangement_shows_what_the_full_scene_shows(
    house: House, monkeypatch: pytest.MonkeyPatch
):
    need_gl()
    points = standing_points(house, 12)
    assert_agree(panoramas(house, points, "gl"), naive_panoramas(house, points, monkeypatch))


@pytest.mark.parametrize("backend", ["gl", "rays"])
def test_an_object_moved_about_looks_as_if_the_house_had_been_built_so(backend: str):
    need_gl(backend)
    house = two_rooms()
    cup = house.object("cup")
    moved = replace(cup, position=(1.7, 0.9, 0.07), yaw=2.0, support=None, room="bedroom")
    points = standing_points(house)
    others = tuple(thing for thing in house.objects if thing.id != "cup")
    without = replace(house, objects=others)
    elsewhere = replace(house, objects=(*others, moved))
    held, placed = Arrangement("cup"), Arrangement("cup", moved)
    with open_renderer(
        house_surfaces(house), movable=movable_objects(house), backend=backend
    ) as renderer:
        found = renderer.render(points)
        views = {
            arrangement: renderer.render(points, arrangement) for arrangement in (placed, held)
        }
        again = renderer.render(points)
    cup_class = class_id("cup")
    assert (found == cup_class).any()
    assert (views[placed] == cup_class).any()
    assert not (views[held] == cup_class).any()
    np.testing.assert_array_equal(views[held], panoramas(without, points, backend))
    built = panoramas(elsewhere, points, backend)
    # Moving rounds otherwise than building: a corner may fall on the other side of a pixel.
    assert (views[placed] != built).sum() <= 2
    np.testing.assert_array_equal(again, found)


def test_rays_show_what_opengl_shows_for_every_object_moved_in_a_procedural_house():
    need_gl()
    house = procedural(2)
    points = standing_points(house, 16)
    things = movable_objects(house)
    assert things
    surfaces = house_surfaces(house)
    with (
        open_renderer(surfaces, movable=things, backend="gl") as drawn,
        open_renderer(surfaces, movable=things, backend="rays") as cast,
    ):
        for thing in things:
            target = replace(thing, position=(*points[3], 0.5), yaw=thing.yaw + 1.0)
            for arrangement in (Arrangement(thing.id), Arrangement(thing.id, target)):
                assert_agree(drawn.render(points, arrangement), cast.render(points, arrangement))


@pytest.mark.parametrize("backend", ["gl", "rays"])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_layers_put_together_show_what_drawing_whole_arrangements_shows(seed: int, backend: str):
    need_gl(backend)
    house = procedural(seed)
    points = standing_points(house, 40)
    things = movable_objects(house)
    arrangements = [AS_FOUND]
    for thing, other, place in zip(things, things[1:] + things[:1], points, strict=False):
        on_the_floor = replace(thing, position=(*place, thing.size[2] / 2), yaw=thing.yaw + 1.0)
        at_the_eyes = replace(thing, position=(*place, DEFAULT_SEMANTICS.eye_height))
        inside_another = replace(thing, position=other.position, yaw=other.yaw)
        arrangements += [
            Arrangement(thing.id, place)
            for place in (None, on_the_floor, at_the_eyes, inside_another)
        ]
    with open_renderer(house_surfaces(house), movable=things, backend=backend) as renderer:
        together = renderer.render_arrangements(points, arrangements)
        for arrangement, found in zip(arrangements, together, strict=True):
            np.testing.assert_array_equal(found, renderer.render(points, arrangement))


@pytest.mark.parametrize("backend", ["gl", "rays"])
def test_few_panoramas_change_when_an_object_moves(backend: str):
    need_gl(backend)
    house = procedural(1)
    points = standing_points(house, 40)
    things = movable_objects(house)
    arrangements = [Arrangement(thing.id) for thing in things]
    with open_renderer(house_surfaces(house), movable=things, backend=backend) as renderer:
        (_, found), *changes = renderer.changes(points, arrangements)
    assert sum(len(changed) for changed, _ in changes) < len(things) * len(points) / 2
    for changed, views in changes:
        assert (views != found[changed]).any(axis=(1, 2, 3)).all(), "all that are given differ"


@pytest.mark.parametrize("backend", ["gl", "rays"])
def test_the_same_points_give_the_same_bits_whichever_way_they_are_asked_for(backend: str):
    need_gl(backend)
    house = two_rooms()
    points = standing_points(house)
    with open_renderer(house_surfaces(house), backend=backend) as renderer:
        whole = renderer.render(points)
        single = np.concatenate([renderer.render(point[None]) for point in points])
        backwards = renderer.render(points[::-1])[::-1]
        none = renderer.render(points[:0])
        (nothing,) = renderer.render_arrangements(points[:0], [AS_FOUND])
    np.testing.assert_array_equal(whole, single)
    np.testing.assert_array_equal(whole, backwards)
    assert none.shape == nothing.shape == (0, *whole.shape[1:])
    np.testing.assert_array_equal(whole, panoramas(house, points, backend))


def test_a_closed_house_shows_no_void():
    house = procedural(0)
    assert panoramas(house, standing_points(house, 200), "rays").all()
