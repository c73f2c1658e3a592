"""Names in a view: of the largest things, over them, not on each other, not cut off."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lcrl_bench.houses.classes import class_id, semantic_classes
from lcrl_bench.recording.rerun.panels import LETTER, MOST, ROWS_APART, sightings

ROWS, COLUMNS = 24, 32


def view_of(*things: tuple[str, slice, slice]) -> np.ndarray:
    view = np.full((ROWS, COLUMNS), class_id("wall"), np.uint8)
    for name, rows, columns in things:
        view[rows, columns] = class_id(name)
    return view


def test_a_thing_is_named_over_the_middle_of_its_largest_part():
    view = view_of(
        ("bed", slice(10, 20), slice(10, 20)),
        ("bed", slice(0, 4), slice(0, 4)),
    )
    (bed,) = sightings(view)
    assert (bed.words, bed.pixels, bed.row, bed.column) == ("bed", 100, 15.0, 15.0)


def test_walls_and_specks_have_no_name():
    assert sightings(view_of(("cup", slice(0, 2), slice(0, 4)))) == []


def test_of_two_names_on_one_line_the_larger_thing_has_its_own():
    view = view_of(
        ("sofa", slice(8, 14), slice(0, 8)),
        ("lamp", slice(9, 13), slice(20, 24)),
        ("rug", slice(20, 24), slice(0, 6)),
    )
    assert [seen.words for seen in sightings(view)] == ["sofa", "rug"]


@st.composite
def views(draw: st.DrawFn) -> np.ndarray:
    names = [entry.name for entry in semantic_classes()]
    view = view_of()
    for name in draw(st.lists(st.sampled_from(names), max_size=8)):
        row, column = draw(st.integers(0, ROWS - 1)), draw(st.integers(0, COLUMNS - 1))
        view[row : row + draw(st.integers(1, 12)), column : column + 9] = class_id(name)
    return view


@given(views())
def test_names_are_few_and_stay_in_the_view_and_off_each_other(view: np.ndarray):
    found = sightings(view)
    assert len(found) <= MOST
    for number, seen in enumerate(found):
        assert ROWS_APART / 2 <= seen.row <= ROWS - ROWS_APART / 2
        half = LETTER * len(seen.words) / 2
        assert half <= seen.column <= COLUMNS - half
        assert all(abs(seen.row - other.row) >= ROWS_APART for other in found[:number])
    sizes = [seen.pixels for seen in found]
    assert sizes == sorted(sizes, reverse=True)
