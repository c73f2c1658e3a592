"""Laws of the objects' meshes: solid, exactly as large as asked, each part named once."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.scenes.shapes import Part, object_parts, shape_count, shaped_labels

NOT_PLACED = {"void", "wall", "floor", "ceiling", "door_frame", "window"}
"""What belongs to the building itself."""
SIDES = st.floats(0.01, 5.0)
SIZES = st.tuples(SIDES, SIDES, SIDES)
SHAPES = [(label, shape) for label in shaped_labels() for shape in range(shape_count(label))]


def bounds(parts: tuple[Part, ...]) -> np.ndarray:
    """[2, 3]: lowest and highest corner of all parts together."""
    vertices = np.concatenate([part.vertices for part in parts])
    return np.stack([vertices.min(axis=0), vertices.max(axis=0)])


def test_every_class_that_can_be_placed_has_a_shape():
    placed = {entry.name for entry in semantic_classes()} - NOT_PLACED
    assert set(shaped_labels()) == placed


@pytest.mark.parametrize("label", shaped_labels())
def test_every_class_has_more_than_one_shape(label: str):
    # Upright books, and mirrors and televisions without depth, all look alike.
    size = (1.0, 0.6, 0.5) if label == "book" else (1.0, 0.12, 0.8)
    seen = {
        b"".join(part.vertices.tobytes() for part in object_parts(label, size, shape))
        for shape in range(shape_count(label))
    }
    assert len(seen) == shape_count(label) >= 2


@settings(max_examples=60)
@given(st.sampled_from(SHAPES), SIZES)
def test_the_parts_fill_their_box_exactly(named: tuple[str, int], size: tuple[float, float, float]):
    half = np.array(size) / 2
    found = bounds(object_parts(named[0], size, named[1]))
    np.testing.assert_allclose(found, [-half, half], rtol=0, atol=1e-6)


@settings(max_examples=60)
@given(st.sampled_from(SHAPES), SIZES)
def test_every_part_is_watertight_and_faces_outward(
    named: tuple[str, int], size: tuple[float, float, float]
):
    for part in object_parts(named[0], size, named[1]):
        mesh = trimesh.Trimesh(part.vertices, part.faces, process=False)
        assert mesh.is_watertight, part.name
        assert mesh.is_winding_consistent, part.name
        assert mesh.volume > 0, part.name


@pytest.mark.parametrize(("label", "shape"), SHAPES)
@pytest.mark.parametrize("size", [(0.7, 0.6, 0.5), (0.3, 0.3, 1.7)])
def test_a_part_called_convex_is_its_own_hull(
    label: str, shape: int, size: tuple[float, float, float]
):
    for part in object_parts(label, size, shape):
        mesh = trimesh.Trimesh(part.vertices, part.faces, process=False)
        hull = mesh.convex_hull.volume
        assert (mesh.volume > 0.999 * hull) == part.convex, part.name


@pytest.mark.parametrize(("label", "shape"), SHAPES)
def test_parts_are_named_once_and_keep_their_colours_in_range(label: str, shape: int):
    parts = object_parts(label, (0.9, 0.6, 0.8), shape)
    assert len({part.name for part in parts}) == len(parts)
    assert all(0 <= value <= 1 for part in parts for value in part.tint)


def test_an_object_is_the_same_each_time_and_its_arrays_are_read_only():
    size = (0.51, 0.52, 0.93)
    first = object_parts("chair", size, 0)
    object_parts.cache_clear()
    again = object_parts("chair", size, 0)
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one.vertices, other.vertices)
        np.testing.assert_array_equal(one.faces, other.faces)
    with pytest.raises(ValueError, match="read-only"):
        first[0].vertices[0, 0] = 1.0


def test_the_shape_is_taken_modulo_the_number_of_shapes():
    size = (0.5, 0.5, 0.9)
    for shape in range(shape_count("chair")):
        wrapped = object_parts("chair", size, shape + 7 * shape_count("chair"))
        assert [part.name for part in wrapped] == [
            part.name for part in object_parts("chair", size, shape)
        ]


def test_legs_are_as_thick_on_a_wide_table_as_on_a_wider_one():
    narrow, wide = (
        {part.name: part for part in object_parts("dining_table", (width, 1.0, 0.75), 0)}
        for width in (1.2, 2.4)
    )
    thickness = [np.ptp(parts["leg-1"].vertices[:, 0]) for parts in (narrow, wide)]
    assert thickness[0] == pytest.approx(thickness[1])


def test_a_chair_faces_front_with_its_back_behind():
    for shape in range(shape_count("chair")):
        parts = object_parts("chair", (0.5, 0.55, 0.9), shape)
        highest = max(parts, key=lambda part: part.vertices[:, 2].max())
        assert highest.vertices[:, 1].mean() < -0.15


def test_a_wall_is_no_object():
    with pytest.raises(UnknownNameError, match="shaped class 'wall'"):
        object_parts("wall", (1.0, 1.0, 1.0))


@pytest.mark.parametrize("side", [0.0, -1.0, float("nan"), float("inf")])
def test_a_box_without_volume_is_refused(side: float):
    with pytest.raises(UsageError, match="all sides must be above 0"):
        object_parts("chair", (0.5, side, 0.9))


def test_triangles_are_few():
    counts = {named: 0 for named in SHAPES}
    for label, shape in SHAPES:
        counts[label, shape] = sum(
            len(part.faces) for part in object_parts(label, (0.8, 0.7, 0.75), shape)
        )
    assert max(counts.values()) <= 300
    assert np.mean(list(counts.values())) <= 150
