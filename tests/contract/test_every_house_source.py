"""What every house source's houses must be good for, whatever they came from."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from house_samples import two_rooms as written_by_hand
from houses.procthor_samples import two_rooms as procthor_json

from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.document import house_digest, house_to_json, parse_house
from lcrl_bench.houses.house import House
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.houses.sources import house_sources, import_house
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.scenes.export import export_scene
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.panoramas import open_renderer
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS

SOURCES = [entry.name for entry in house_sources()]


@pytest.fixture(params=SOURCES)
def house(request, tmp_path) -> House:
    """A house of each registered source."""
    files = {"procthor": procthor_json, "lcrl": lambda: house_to_json(written_by_hand())}
    if request.param == "procedural":
        return generated()
    assert request.param in files, f"give the contract a sample of the source '{request.param}'"
    path = tmp_path / "sample.json"
    path.write_text(json.dumps(files[request.param]()))
    return import_house(path, source=request.param).house


@lru_cache(maxsize=1)
def generated() -> House:
    return generate_house(21)


def test_it_keeps_every_law_and_survives_its_file(house):
    validate_house(house)
    again = parse_house(house_to_json(house), path="memory")
    assert again == house
    assert house_digest(again) == house_digest(house)


def test_an_agent_can_reach_every_room_that_doors_connect(house):
    grid = build_grid(house, DEFAULT_SEMANTICS)
    assert grid.report.rooms_missed == ()
    assert set(grid.rooms) == {room.id for room in house.rooms}


def test_its_scene_opens_in_mujoco_from_anywhere(house, tmp_path, monkeypatch):
    path = export_scene(house, tmp_path / "scene")
    monkeypatch.chdir(Path("/"))
    model = mujoco.MjModel.from_xml_path(str(path))
    names = {model.body(k).name for k in range(model.nbody)}
    assert {thing.id for thing in house.objects} <= names


def test_what_is_in_it_is_seen_and_nothing_is_void(house):
    grid = build_grid(house, DEFAULT_SEMANTICS)
    with open_renderer(house_surfaces(house), backend="rays") as renderer:
        seen = renderer.render(grid.points)
    assert not (seen == class_id("void")).any()
    large = {thing.label for thing in house.objects if min(thing.size[0], thing.size[2]) > 0.4}
    assert large
    assert {class_id(label) for label in large} <= set(np.unique(seen).tolist())
