"""What is seen in a house: every panorama given back, no view kept twice, every pixel counted."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.panoramas import CLASSES, Panoramas

SOME = np.random.default_rng(0).integers(0, CLASSES, (20, 4, 24, 32)).astype(np.uint8)

few_panoramas = arrays.arrays(
    np.uint8,
    st.tuples(st.integers(1, 6), st.just(4), st.just(2), st.just(3)),
    elements=st.integers(0, 1),
)
any_panoramas = arrays.arrays(
    np.uint8,
    st.tuples(st.integers(1, 5), st.just(4), st.just(2), st.just(3)),
    elements=st.integers(0, CLASSES - 1),
)


@given(few_panoramas, st.integers(1, 6))
def test_every_panorama_is_given_back_and_no_view_is_kept_twice(pixels: np.ndarray, batch: int):
    panoramas = Panoramas.build(iter(pixels))
    assert len(panoramas) == len(pixels)
    for number, expected in enumerate(pixels):
        np.testing.assert_array_equal(panoramas.pixels(number), expected)
    assert len({view.tobytes() for view in panoramas.views.numpy()}) == len(panoramas.views)
    first_seen = np.unique(panoramas.panorama_views.numpy().ravel(), return_index=True)[1]
    assert (np.diff(first_seen) > 0).all()
    batches = [pixels[start : start + batch] for start in range(0, len(pixels), batch)]
    again = Panoramas.build(batches)
    assert torch.equal(again.views, panoramas.views)
    assert torch.equal(again.panorama_views, panoramas.panorama_views)
    assert (again.views.dtype, again.panorama_views.dtype) == (torch.uint8, torch.int64)


@given(few_panoramas, few_panoramas, st.data())
def test_joining_and_choosing_give_what_collecting_gives(
    one: np.ndarray, other: np.ndarray, data: st.DataObject
):
    both = np.concatenate([one, other])
    joined = Panoramas.joined([Panoramas.build([one]), Panoramas.build([other])])
    numbers = st.lists(st.integers(0, len(both) - 1), min_size=1, max_size=8)
    some = np.array(data.draw(numbers))
    for found, expected in ((joined, both), (joined.chosen(some), both[some])):
        collected = Panoramas.build([expected])
        assert torch.equal(found.views, collected.views)
        assert torch.equal(found.panorama_views, collected.panorama_views)


@pytest.mark.parametrize("batch", [SOME[:, :3], SOME.astype(np.int64), SOME[0, 0]])
def test_what_is_no_panorama_is_refused(batch: np.ndarray):
    with pytest.raises(ValueError, match="a panorama is uint8"):
        Panoramas.build([batch])


def test_nothing_seen_is_refused():
    with pytest.raises(ValueError, match="at least one"):
        Panoramas.build([])


def test_views_of_two_sizes_do_not_mix():
    with pytest.raises(ValueError, match="one size"):
        Panoramas.build([SOME, SOME[:, :, :12]])


@given(any_panoramas)
def test_class_counts_are_those_of_counting_and_shares_sum_to_one(pixels: np.ndarray):
    panoramas = Panoramas.build([pixels])
    counted = [np.bincount(each.ravel(), minlength=CLASSES) for each in pixels]
    np.testing.assert_array_equal(panoramas.class_counts().numpy(), counted)
    shares = panoramas.class_shares()
    assert (shares.dtype, shares.shape) == (torch.float32, (len(pixels), CLASSES))
    torch.testing.assert_close(shares.sum(1), torch.ones(len(pixels)))
    expected = np.array(counted, np.float32) / pixels[0].size
    np.testing.assert_allclose(shares.numpy(), expected, rtol=1e-6)


def test_there_are_as_many_classes_as_the_taxonomy_has():
    assert len(semantic_classes()) == CLASSES == Panoramas.build([SOME]).classes


def test_writing_in_the_pixels_of_a_panorama_changes_nothing_that_is_kept():
    panoramas = Panoramas.build([SOME])
    panoramas.pixels(3)[:] = 0
    np.testing.assert_array_equal(panoramas.pixels(3), SOME[3])


def test_arrays_are_taken_as_they_are():
    built = Panoramas.build([SOME])
    rows = built.panorama_views.numpy().astype(np.int32)
    taken = Panoramas.from_arrays(built.views.numpy(), rows, house="h")
    assert taken.house == "h"
    assert torch.equal(taken.views, built.views)
    assert torch.equal(taken.panorama_views, built.panorama_views)
    assert taken.panorama_views.dtype == torch.int64


def test_on_another_device_they_are_the_same_and_where_they_are_they_stay():
    panoramas = Panoramas.build([SOME], house="h")
    assert panoramas.to("cpu") is panoramas
    there = panoramas.to("meta")
    assert {there.views.device.type, there.panorama_views.device.type} == {"meta"}
    assert (there.house, there.views.shape) == ("h", panoramas.views.shape)


def test_what_a_method_is_shown_is_a_copy():
    observed = Panoramas.build([SOME]).observed
    shown = observed.show()
    shown.views.zero_()
    shown.panorama_views.zero_()
    again = observed.show()
    assert again.views.any()
    assert again.panorama_views.any()
    assert again.house == observed.views.house


def test_panoramas_need_neither_mujoco_nor_opengl():
    code = (
        "import sys, lcrl_bench.panoramas; "
        "print([name for name in ('mujoco', 'OpenGL', 'lcrl_bench.scenes') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
