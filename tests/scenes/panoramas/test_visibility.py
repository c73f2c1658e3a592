"""What is left out of a drawing is nowhere to be seen."""

from __future__ import annotations

import numpy as np
from house_samples import two_rooms
from hypothesis import given, settings
from hypothesis import strategies as st
from panorama_samples import box

from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import Opening, OpeningKind
from lcrl_bench.scenes.building import building_surfaces
from lcrl_bench.scenes.panoramas.camera import eye_positions
from lcrl_bench.scenes.panoramas.merged import merge_surfaces
from lcrl_bench.scenes.panoramas.occlusion import find_occluders, occluded
from lcrl_bench.scenes.panoramas.rays import RayRenderer
from lcrl_bench.scenes.panoramas.visibility import bounding_boxes, in_frustum
from lcrl_bench.semantics import DEFAULT_SEMANTICS

VASE = class_id("vase")
places = st.floats(-4, 4)
sizes = st.floats(0.05, 2)
heights = st.floats(0.5, 3)
walls = st.lists(
    st.tuples(places, places, st.floats(0.1, 4), st.floats(0.1, 4), heights), max_size=5
)
things = st.tuples(places, places, heights, sizes, sizes, sizes)


def shown(surfaces, points) -> np.ndarray:
    """[point, view]: whether a vase is seen by rays."""
    return (RayRenderer(surfaces, DEFAULT_SEMANTICS, ()).render(points) == VASE).any(axis=(2, 3))


@settings(max_examples=200)
@given(walls=walls, thing=things, eye=st.tuples(places, places))
def test_a_thing_that_is_not_drawn_is_not_hit_by_any_ray(walls: list, thing: tuple, eye: tuple):
    built = [
        box(f"wall-{number}", "wall", (x, y, high / 2), (wide, deep, high))
        for number, (x, y, wide, deep, high) in enumerate(walls)
    ]
    vase = box("vase", "vase", thing[:3], thing[3:])
    meshes = merge_surfaces([*built, vase])
    points = np.array([eye])
    eyes = eye_positions(points, DEFAULT_SEMANTICS)
    boxes = bounding_boxes([vase.vertices])
    drawn = in_frustum(boxes, eyes, DEFAULT_SEMANTICS)[..., 0]
    drawn &= ~occluded(find_occluders(meshes), boxes, eyes)
    assert not (shown([*built, vase], points) & ~drawn).any()


def test_what_lies_behind_a_view_is_not_drawn():
    eyes = np.array([[0.0, 0.0, 1.25]])
    north = bounding_boxes([np.array([[-0.1, 2.0, 1.0], [0.1, 2.2, 1.2]])])
    assert in_frustum(north, eyes, DEFAULT_SEMANTICS).ravel().tolist() == [
        True,
        False,
        False,
        False,
    ]


def hidden_in_the_kitchen(*openings: Opening) -> bool:
    """Whether a walled-off table in the kitchen is left out for an eye in the bedroom."""
    meshes = merge_surfaces(building_surfaces(two_rooms(*openings)))
    table = bounding_boxes([np.array([[4.0, 1.0, 0.0], [5.0, 2.0, 0.75]])])
    eyes = np.array([[1.5, 1.5, 1.25]])
    return bool(occluded(find_occluders(meshes), table, eyes)[0, 0])


def test_a_wall_between_hides_the_next_room():
    assert hidden_in_the_kitchen(Opening(OpeningKind.DOOR, 0.1, 0.3, 0.0, 2.0))


def test_through_a_door_the_next_room_is_drawn():
    assert not hidden_in_the_kitchen(Opening(OpeningKind.DOOR, 1.0, 2.0, 0.0, 2.05))


def test_a_lower_wall_hides_no_more_than_stands_below_its_top():
    wall = merge_surfaces([box("wall", "wall", (0, 2, 0.75), (6, 0.1, 1.5))])
    eyes = np.array([[0.0, 0.0, 1.25]])
    low = np.array([[-0.5, 3.0, 0.0], [0.5, 3.5, 1.4]])
    high = np.array([[-0.5, 3.0, 0.0], [0.5, 3.5, 1.7]])
    hidden = occluded(find_occluders(wall), bounding_boxes([low, high]), eyes)
    assert hidden.ravel().tolist() == [True, False]


def test_without_walls_nothing_is_hidden():
    meshes = merge_surfaces([box("vase", "vase", (0, 2, 1), (1, 1, 1))])
    boxes = bounding_boxes([meshes[0].vertices, None])
    assert not occluded(find_occluders(meshes), boxes, np.zeros((3, 3))).any()
