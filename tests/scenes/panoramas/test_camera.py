"""Where the four views look, shown by a marker in an empty world."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from panorama_samples import BACKENDS, ORIGIN, box, need_gl

from lcrl_bench.houses.classes import class_id
from lcrl_bench.scenes.panoramas import open_renderer
from lcrl_bench.scenes.panoramas.camera import ray_directions, view_axes
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

NORTH, EAST, SOUTH, WEST = range(4)
LEVEL = replace(DEFAULT_SEMANTICS, pitch=0.0)
VASE, CUP = class_id("vase"), class_id("cup")


def at_eye_level(east: float, north: float, up: float = 0.0):
    return box("vase", "vase", (east, north, DEFAULT_SEMANTICS.eye_height + up), (0.3, 0.3, 0.3))


def seen_from_origin(*surfaces, backend: str, semantics: Semantics = LEVEL):
    need_gl(backend)
    with open_renderer(surfaces, semantics, backend=backend) as renderer:
        return renderer.render(ORIGIN)[0]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("view", "east", "north"), [(NORTH, 0, 2), (EAST, 2, 0), (SOUTH, 0, -2), (WEST, -2, 0)]
)
def test_a_thing_is_in_the_middle_of_the_view_that_faces_it_and_in_no_other(
    backend: str, view: int, east: float, north: float
):
    views = seen_from_origin(at_eye_level(east, north), backend=backend)
    rows, columns = np.nonzero(views[view] == VASE)
    assert len(rows) > 0
    assert abs(rows.mean() - 11.5) < 1
    assert abs(columns.mean() - 15.5) < 1
    assert not np.delete(views, view, axis=0).any()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("view", "east", "north"), [(NORTH, -1, 2), (EAST, 2, 1), (SOUTH, 1, -2), (WEST, -2, -1)]
)
def test_what_is_on_the_left_hand_is_on_the_left_of_the_view(
    backend: str, view: int, east: float, north: float
):
    columns = np.nonzero(seen_from_origin(at_eye_level(east, north), backend=backend)[view])[1]
    assert len(columns) > 0
    assert columns.max() < 16


@pytest.mark.parametrize("backend", BACKENDS)
def test_what_is_above_the_eye_is_in_the_upper_rows(backend: str):
    rows = np.nonzero(seen_from_origin(at_eye_level(0, 2, up=0.5), backend=backend)[NORTH])[0]
    assert len(rows) > 0
    assert rows.max() < 12


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_negative_pitch_looks_down_in_every_view(backend: str):
    around = [at_eye_level(*place) for place in ((0, 2), (2, 0), (0, -2), (-2, 0))]
    views = seen_from_origin(*around, backend=backend, semantics=DEFAULT_SEMANTICS)
    for view in views:
        rows = np.nonzero(view)[0]
        assert len(rows) > 0
        assert rows.mean() < 10


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_nearer_of_two_things_is_seen(backend: str):
    near = box("cup", "cup", (0, 1, 1.25), (1, 0.1, 1))
    views = seen_from_origin(at_eye_level(0, 2), near, backend=backend)
    assert set(np.unique(views)) == {0, CUP}


@pytest.mark.parametrize("backend", BACKENDS)
def test_where_nothing_is_the_class_is_void(backend: str):
    assert not seen_from_origin(at_eye_level(0, 2), backend=backend)[SOUTH].any()


@pytest.mark.parametrize("backend", BACKENDS)
def test_something_void_still_hides_what_is_behind(backend: str):
    curtain = box("nothing", "void", (0, 1, 1.25), (2, 0.1, 2))
    assert not seen_from_origin(at_eye_level(0, 2), curtain, backend=backend).any()


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_inside_of_a_box_is_seen(backend: str):
    room = box("room", "wall", (0, 0, 1.25), (4, 4, 2.5))
    views = seen_from_origin(room, backend=backend)
    assert (views == class_id("wall")).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_nothing_nearer_than_a_centimetre_is_seen(backend: str):
    # Around the eye itself, which stands a few millimetres beside the point.
    veil = box("veil", "cup", (0.0031, 0.0047, 1.25), (0.016, 0.016, 0.016))
    assert not seen_from_origin(veil, backend=backend).any()


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_view_may_be_square(backend: str):
    square = replace(LEVEL, view_width=64, view_height=64)
    views = seen_from_origin(at_eye_level(2, 0), backend=backend, semantics=square)
    rows, columns = np.nonzero(views[EAST])
    assert views.shape == (4, 64, 64)
    assert abs(rows.mean() - 31.5) < 1
    assert abs(columns.mean() - 31.5) < 1
    assert abs(np.ptp(rows) - np.ptp(columns)) <= 1


@given(
    pitch=st.floats(-1, 1),
    width=st.integers(1, 40),
    height=st.integers(1, 40),
    fov=st.floats(0.2, 2.5),
)
def test_every_pixel_looks_one_unit_forward_and_pixels_are_square(
    pitch: float, width: int, height: int, fov: float
):
    semantics = replace(
        DEFAULT_SEMANTICS,
        pitch=pitch,
        view_width=width,
        view_height=height,
        horizontal_fov=fov,
    )
    axes, rays = view_axes(semantics), ray_directions(semantics)
    np.testing.assert_allclose(
        axes @ axes.transpose(0, 2, 1), np.tile(np.eye(3), (4, 1, 1)), atol=1e-12
    )
    np.testing.assert_allclose(np.einsum("vrck,vk->vrc", rays, axes[:, 1]), 1.0)
    pixel = 2 * math.tan(fov / 2) / width
    np.testing.assert_allclose(np.linalg.norm(np.diff(rays, axis=1), axis=-1), pixel)
    np.testing.assert_allclose(np.linalg.norm(np.diff(rays, axis=2), axis=-1), pixel)
