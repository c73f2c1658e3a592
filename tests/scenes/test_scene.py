"""A scene derives what is asked for, once, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from house_samples import two_rooms

from lcrl_bench.houses.classes import class_id
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes import scene as scene_module
from lcrl_bench.scenes import walkable
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.reach import within_reach
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS

DERIVED = {"grid", "model", "surfaces"}
HEAVY = "[name for name in ('mujoco', 'OpenGL') if name in sys.modules]"


def printed(program: str) -> list[str]:
    """What a fresh process prints."""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.parametrize(
    "module",
    [
        "lcrl_bench.scenes.scene",
        "lcrl_bench.methods.contract",
        "lcrl_bench.benchmarks.task_sets",
        "lcrl_bench.evaluation.harness",
    ],
)
def test_importing_it_imports_neither_mujoco_nor_opengl(module: str):
    assert printed(f"import sys, {module}; print({HEAVY})") == ["[]"]


def test_a_scene_of_a_known_grid_needs_no_mujoco_until_its_model_is_asked_for():
    program = f"""
import sys
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
benchmark = read_benchmark(benchmark_folder("mini"))
scene = benchmark.scene(min(benchmark.houses))
assert scene.grid.tiles > 10
assert scene.reach(scene.house.objects[0]).shape == (scene.grid.tiles,)
print({HEAVY})
print(scene.model.nbody > len(scene.house.objects))
print('mujoco' in sys.modules)
"""
    assert printed(program) == ["[]", "True", "True"]


def test_nothing_is_derived_before_it_is_asked_for():
    scene = Scene(two_rooms())
    assert not DERIVED & set(vars(scene))
    assert repr(scene) == "Scene(two-rooms: 2 rooms, 5 objects)"
    assert not DERIVED & set(vars(scene))
    assert scene.grid.tiles == build_grid(two_rooms(), DEFAULT_SEMANTICS).tiles
    assert DERIVED & set(vars(scene)) == {"grid"}
    assert len(scene.surfaces) == len(house_surfaces(two_rooms()))
    assert DERIVED & set(vars(scene)) == {"grid", "surfaces"}


def test_everything_is_derived_once(monkeypatch: pytest.MonkeyPatch):
    derived = []

    def counted(*arguments):
        derived.append(arguments)
        return build_grid(*arguments)

    monkeypatch.setattr(walkable, "build_grid", counted)
    scene = Scene(two_rooms())
    for name in DERIVED:
        assert getattr(scene, name) is getattr(scene, name), name
    scene.reach(two_rooms().objects[0])
    assert len(derived) == 1


def test_a_grid_that_is_given_is_not_derived(monkeypatch: pytest.MonkeyPatch):
    grid = build_grid(two_rooms(), DEFAULT_SEMANTICS)
    monkeypatch.setattr(walkable, "build_grid", lambda *_: pytest.fail("derived"))
    assert Scene(two_rooms(), grid=grid).grid is grid


def test_the_model_has_a_body_for_every_object():
    house = two_rooms()
    model = Scene(house).model
    assert {thing.id for thing in house.objects} <= {model.body(k).name for k in range(model.nbody)}


def test_reach_is_that_of_its_house_and_grid():
    scene = Scene(two_rooms())
    cup = scene.house.object("cup")
    expected = within_reach(scene.house, scene.grid, cup, scene.semantics)
    assert scene.reach(cup).tolist() == expected.tolist()
    assert expected.any()


def test_panoramas_are_numbered_by_arrangement_and_tile():
    scene = Scene(two_rooms(), renderer="rays")
    tiles = scene.grid.tiles
    found = scene.panoramas()
    both = scene.panoramas((AS_FOUND, Arrangement("cup")))
    assert (len(found), len(both)) == (tiles, 2 * tiles)
    assert found.house == both.house == "two-rooms"
    for tile in range(tiles):
        np.testing.assert_array_equal(both.pixels(tile), found.pixels(tile))
    cups = both.class_counts()[:, class_id("cup")].reshape(2, tiles)
    assert cups[0].any()
    assert not cups[1].any(), "what is held is seen nowhere"


def test_panoramas_are_rendered_once_and_named_after_their_own_house(
    monkeypatch: pytest.MonkeyPatch, tmp_path
):
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path))
    first = Scene(two_rooms(), renderer="rays").panoramas()
    monkeypatch.setattr(scene_module, "open_renderer", lambda *_, **__: pytest.fail("rendered"))
    again = Scene(two_rooms(), renderer="rays").panoramas()
    assert (first.views == again.views).all()
    assert (first.panorama_views == again.panorama_views).all()
    assert isinstance(again, Panoramas)
    assert first.house == again.house == "two-rooms"


def test_a_damaged_file_of_frozen_views_is_passed_over_with_a_notice(tmp_path, caplog):
    frozen = tmp_path / "frozen.npz"
    frozen.write_bytes(b"damaged")
    chosen = Scene(two_rooms(), renderer="rays", frozen=frozen).panoramas()
    assert caplog.text == "", "with a renderer of one's own choice frozen views are not looked at"
    found = Scene(two_rooms(), frozen=frozen).panoramas()
    assert "rendering instead of using frozen views" in caplog.text
    assert len(found) == len(chosen)


def test_a_house_of_other_semantics_has_a_grid_of_its_own():
    coarse = Scene(two_rooms(), replace(DEFAULT_SEMANTICS, tile=1.0)).grid
    assert coarse.tile == 1.0
    assert coarse.tiles < Scene(two_rooms()).grid.tiles
