"""Objects stand where the House JSON says, with their class, and every name is one of a kind."""

from __future__ import annotations

import math

import numpy as np
import pytest
from house_samples import two_rooms, with_objects
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.furnishing import house_surfaces, object_surfaces

LABELS = [entry.name for entry in semantic_classes() if entry.group != "structure"]


@settings(max_examples=40)
@given(
    label=st.sampled_from(LABELS),
    size=st.tuples(*[st.floats(0.1, 2.0)] * 3),
    yaw=st.floats(-7, 7),
    x=st.floats(-20, 20),
)
def test_an_object_fills_its_turned_box_and_no_more(label, size, yaw, x):
    thing = PlacedObject("it", label, "bedroom", (x, -2.0, 1.0), size, yaw)
    surfaces = object_surfaces(thing)
    assert {(s.label, s.object, s.room) for s in surfaces} == {(label, "it", "bedroom")}
    points = np.concatenate([surface.vertices for surface in surfaces]) - thing.position
    cos, sin = math.cos(yaw), math.sin(yaw)
    right, front = points @ [cos, sin, 0], points @ [-sin, cos, 0]
    extent = np.stack([right, front, points[:, 2]], axis=1)
    assert (np.abs(extent) <= np.array(size) / 2 + 1e-9).all()
    assert np.ptp(extent, axis=0) == pytest.approx(size, rel=0.35)


def test_an_object_at_yaw_zero_faces_north():
    chair = PlacedObject("chair", "chair", "bedroom", (0, 0, 0.45), (0.5, 0.5, 0.9), 0.0)
    points = np.concatenate([surface.vertices for surface in object_surfaces(chair)])
    # A chair's back is what is high; it is behind, so in the south.
    assert points[points[:, 2] > 0.7][:, 1].max() < 0.05


def test_a_house_is_its_building_and_its_objects():
    bare, full = two_rooms(furnished=False), two_rooms()
    building = {surface.name for surface in house_surfaces(bare)}
    names = [surface.name for surface in house_surfaces(full)]
    assert len(set(names)) == len(names)
    assert building < set(names)
    objects = {surface.object for surface in house_surfaces(full)} - {None}
    assert objects == {thing.id for thing in full.objects}


def test_an_object_called_like_a_wall_is_not_confused_with_it():
    wall = two_rooms().walls[0]
    thing = PlacedObject(wall.id, "chair", "bedroom", (1, 1, 0.5), (0.5, 0.5, 1), 0.0)
    names = [surface.name for surface in house_surfaces(with_objects(two_rooms(), thing))]
    assert len(set(names)) == len(names)
