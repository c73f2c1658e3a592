"""The four views joined into one picture."""

from __future__ import annotations

import numpy as np
import pytest

from lcrl_bench.houses.classes import class_id, semantic_classes
from lcrl_bench.play.panorama import (
    class_letters,
    classes_in_sight,
    join_views,
    lettered,
    resized,
)

WALL, FLOOR, CUP, BED = map(class_id, ("wall", "floor", "cup", "bed"))


@pytest.mark.parametrize("heading", range(4))
def test_the_view_ahead_is_in_the_middle_and_its_neighbours_join_it(heading):
    # Each column of the circle of views has a number of its own, from west of north on.
    views = np.arange(4 * 8, dtype=np.uint8).reshape(4, 1, 8)
    (row,) = join_views(views, heading)
    assert row[12:20].tolist() == views[heading, 0].tolist()
    # Going right through the picture is going right round the circle, without a jump.
    assert (np.diff(row.astype(int)) % 32 == 1).all()


def test_the_same_size_is_the_same_picture():
    picture = np.random.default_rng(0).integers(0, 61, (24, 128)).astype(np.uint8)
    assert np.array_equal(resized(picture, 24, 128), picture)


@pytest.mark.parametrize("size", [(16, 80), (12, 64), (8, 30), (5, 7)])
def test_a_cup_is_never_lost_however_small_the_picture(size):
    for row in range(24):
        picture = np.full((24, 128), WALL, np.uint8)
        picture[12:] = FLOOR
        picture[:, 40:90] = BED
        picture[row, 5 * row] = CUP
        assert CUP in resized(picture, *size)


def test_a_larger_picture_repeats_pixels():
    picture = np.array([[WALL, BED], [FLOOR, CUP]], np.uint8)
    assert np.array_equal(resized(picture, 4, 4), picture.repeat(2, 0).repeat(2, 1))


def test_every_class_has_a_letter_of_its_own_but_what_is_everywhere():
    letters = class_letters()
    named = [
        letter
        for letter, entry in zip(letters, semantic_classes(), strict=True)
        if entry.name not in {"void", "wall", "ceiling", "floor"}
    ]
    assert len(set(named)) == len(named) == 57
    assert all(len(letter) == 1 and letter.isascii() and letter.isalnum() for letter in named)
    assert letters[CUP].isupper()
    assert lettered(np.array([[WALL, FLOOR, CUP]], np.uint8)) == [f" .{letters[CUP]}"]


def test_things_are_named_before_the_building_and_the_largest_first():
    views = np.full((4, 4, 4), WALL, np.uint8)
    views[0, 0, :3], views[1, 0, 0] = BED, CUP
    assert classes_in_sight(views) == [(BED, 3 / 64), (CUP, 1 / 64), (WALL, 60 / 64)]
