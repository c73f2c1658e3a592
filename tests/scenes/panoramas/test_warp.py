"""MuJoCo Warp, where it is installed, shows what rays show; where it is not, the error says how."""

from __future__ import annotations

import sys
from dataclasses import replace

import pytest
from panorama_samples import agreement, standing_points

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.panoramas import movable_objects, open_renderer


@pytest.mark.parametrize("seed", [0, 1])
def test_warp_shows_what_rays_show_however_objects_are_moved(seed: int):
    pytest.importorskip("mujoco_warp", reason="the extra [warp] is not installed")
    house = generate_house(seed)
    points = standing_points(house, 40)
    surfaces, things = house_surfaces(house), movable_objects(house)
    moved = replace(things[0], position=(*points[3], 0.5), yaw=things[0].yaw + 1.0)
    changes = (AS_FOUND, Arrangement(things[0].id), Arrangement(things[0].id, moved))
    with (
        open_renderer(surfaces, movable=things, backend="warp") as traced,
        open_renderer(surfaces, movable=things, backend="rays") as cast,
    ):
        for arrangement in changes:
            share = agreement(traced.render(points, arrangement), cast.render(points, arrangement))
            assert share.mean() >= 0.999
            assert share.min() >= 0.99


def test_without_warp_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco_warp", None)
    monkeypatch.delitem(sys.modules, "lcrl_bench.scenes.panoramas.warp", raising=False)
    house = generate_house(0)
    with pytest.raises(EnvironmentMissingError, match=r"pip install mujoco-warp .*--renderer rays"):
        open_renderer(house_surfaces(house), backend="warp")
