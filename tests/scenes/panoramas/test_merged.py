"""Merging keeps every triangle and its class; moving keeps every shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from panorama_samples import box

from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.furnishing import object_surfaces
from lcrl_bench.scenes.panoramas.merged import arranged_vertices, merge_surfaces, moved_vertices

LABELS = ("wall", "floor", "chair", "cup")
CUP = PlacedObject("cup-1", "cup", "room", (1.0, 2.0, 0.8), (0.1, 0.08, 0.12), 0.7)
places = st.floats(-20, 20)
boxes = st.tuples(st.sampled_from(LABELS), places, places, st.sampled_from([None, "cup-1"]))


def rows_of(triangles: np.ndarray) -> list:
    return sorted(map(tuple, triangles.reshape(-1, 9)))


@given(st.lists(boxes, max_size=12))
def test_every_triangle_keeps_its_class_and_its_object(things: list):
    surfaces = [
        box(str(number), label, (x, y, 0.5), (0.3, 0.4, 0.5), thing=thing)
        for number, (label, x, y, thing) in enumerate(things)
    ]
    meshes = merge_surfaces(surfaces, {"cup-1"})
    for label in LABELS:
        for thing in (None, "cup-1"):
            before = [
                s.vertices[s.faces] for s in surfaces if (s.label, s.object) == (label, thing)
            ]
            chosen = [m for m in meshes if (m.class_id, m.object) == (class_id(label), thing)]
            after = [m.vertices[m.faces] for m in chosen]
            empty = np.empty((0, 3, 3))
            assert rows_of(np.concatenate([empty, *before])) == rows_of(
                np.concatenate([empty, *after])
            )


def test_an_object_that_never_moves_is_merged_with_its_neighbours_of_its_class():
    chairs = [box(name, "chair", (1, 1, 0.5), (0.4, 0.4, 1), thing=name) for name in "ab"]
    assert len(merge_surfaces(chairs)) == 1
    assert {mesh.object for mesh in merge_surfaces(chairs, {"a"})} == {"a", None}


def test_triangles_without_area_are_left_out():
    whole = box("a", "cup", (0, 0, 0), (1, 1, 1))
    flat = replace(whole, faces=np.vstack([whole.faces, [[0, 1, 1], [2, 2, 2]]]).astype(np.int32))
    assert len(merge_surfaces([flat])[0].faces) == 12
    assert merge_surfaces([replace(whole, faces=flat.faces[-2:])]) == ()


@given(x=places, y=places, yaw=st.floats(-4, 4))
def test_moving_an_objects_mesh_gives_the_mesh_of_the_object_placed_there(
    x: float, y: float, yaw: float
):
    target = replace(CUP, position=(x, y, 0.4), yaw=yaw)
    for here, there in zip(object_surfaces(CUP), object_surfaces(target), strict=True):
        moved = moved_vertices(here.vertices, CUP, target)
        np.testing.assert_allclose(moved, there.vertices, atol=1e-9)


def test_a_held_object_has_no_place_and_others_stay():
    mesh, other = merge_surfaces(
        [
            box("a", "cup", (0, 0, 0), (1, 1, 1), thing="cup-1"),
            box("b", "cup", (0, 0, 0), (1, 1, 1)),
        ],
        {"cup-1"},
    )
    held = Arrangement(hidden="cup-1")
    assert arranged_vertices(mesh, {"cup-1": CUP}, held) is None
    assert arranged_vertices(other, {"cup-1": CUP}, held) is other.vertices
