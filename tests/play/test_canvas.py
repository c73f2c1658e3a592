"""Letters, colours and half blocks."""

from __future__ import annotations

import re

import numpy as np
import pytest

from lcrl_bench.play.canvas import HALF, Canvas, Style
from lcrl_bench.play.colors import Colors, colors_wanted
from lcrl_bench.recording.palette import class_colors

UTF8 = {"terminal": True, "encoding": "utf-8"}


@pytest.mark.parametrize(
    ("environment", "colors"),
    [
        ({"TERM": "xterm-256color", "COLORTERM": "truecolor"}, Colors.FULL),
        ({"TERM": "xterm", "TERM_PROGRAM": "WezTerm"}, Colors.FULL),
        ({"TERM": "xterm-direct"}, Colors.FULL),
        ({"TERM": "xterm-256color"}, Colors.INDEXED),
        ({"TERM": "screen"}, Colors.INDEXED),
        ({"TERM": "dumb", "COLORTERM": "truecolor"}, Colors.PLAIN),
        ({}, Colors.PLAIN),
        ({"TERM": "xterm", "COLORTERM": "truecolor", "NO_COLOR": "1"}, Colors.PLAIN),
        ({"TERM": "xterm", "COLORTERM": "truecolor", "NO_COLOR": ""}, Colors.FULL),
    ],
)
def test_a_terminal_is_drawn_on_with_the_colours_it_has(environment, colors):
    assert colors_wanted(environment, **UTF8) == colors


def test_a_file_and_an_alphabet_without_blocks_get_letters():
    environment = {"TERM": "xterm", "COLORTERM": "truecolor"}
    assert colors_wanted(environment, terminal=False, encoding="utf-8") == Colors.PLAIN
    assert colors_wanted(environment, terminal=True, encoding="ascii") == Colors.PLAIN


def xterm(number: int) -> tuple[int, int, int]:
    """The colours as xterm defines them: a cube of 6 x 6 x 6, and 24 greys."""
    if number >= 232:
        grey = 8 + 10 * (number - 232)
        return grey, grey, grey
    cube = [0, 95, 135, 175, 215, 255]
    number -= 16
    return cube[number // 36], cube[number // 6 % 6], cube[number % 6]


def test_with_256_colours_all_is_drawn_in_one_near_its_own():
    # The first 16 are left out: people choose those.
    generator = np.random.default_rng(0)
    for color in (*class_colors(), *generator.integers(0, 256, (200, 3)).astype(np.uint8)):
        canvas = Canvas(1, 1)
        canvas.picture(0, 0, np.stack([color, color])[:, None])
        (line,) = canvas.lines(Colors.INDEXED)
        found = re.fullmatch(r"\x1b\[48;5;(\d+)m \x1b\[0m", line)
        assert found is not None
        assert int(found[1]) >= 16
        assert np.abs(np.subtract(xterm(int(found[1])), color.astype(int))).max() <= 48


def test_what_does_not_fit_is_cut_off_at_every_edge():
    canvas = Canvas(2, 4)
    assert canvas.write(0, 2, "abcdef") == 8
    canvas.write(-1, 0, "x")
    canvas.write(5, 0, "x")
    canvas.write(1, -2, "yyy")
    assert canvas.lines(Colors.PLAIN) == ["  ab", "y"]


def test_wide_letters_take_two_columns_and_accents_none():
    canvas = Canvas(1, 5)
    assert canvas.write(0, 0, "卧室卧") == 6
    assert canvas.lines(Colors.PLAIN) == ["卧室"]
    canvas = Canvas(1, 5)
    assert canvas.write(0, 0, "e\u0301te") == 3
    assert canvas.lines(Colors.PLAIN) == ["e\u0301te"]


def test_two_pixels_share_a_letter_the_upper_is_its_ink_the_lower_its_paper():
    canvas = Canvas(1, 2)
    canvas.picture(0, 0, np.array([[[255, 0, 0], [9, 9, 9]], [[0, 0, 255], [9, 9, 9]]], np.uint8))
    (line,) = canvas.lines(Colors.FULL)
    assert line == f"\x1b[38;2;255;0;0;48;2;0;0;255m{HALF}\x1b[0m\x1b[48;2;9;9;9m \x1b[0m"
    (line,) = canvas.lines(Colors.INDEXED)
    assert re.fullmatch(r"\x1b\[38;5;196;48;5;21m.\x1b\[0m\x1b\[48;5;\d+m \x1b\[0m", line)


def test_a_style_is_said_once_and_ends_with_the_line():
    canvas = Canvas(2, 6)
    canvas.write(0, 0, "abc", Style(bold=True, underline=True))
    assert canvas.lines(Colors.FULL) == ["\x1b[1;4mabc\x1b[0m", ""]
    assert canvas.lines(Colors.PLAIN) == ["abc", ""]


def test_rows_of_one_page_are_laid_onto_another():
    sheet, canvas = Canvas(3, 2), Canvas(3, 4)
    for row, text in enumerate(("aa", "bb", "cc")):
        sheet.write(row, 0, text)
    canvas.paste(sheet, 1, 3, first=1, rows=2)
    assert canvas.lines(Colors.PLAIN) == ["", "   b", "   c"]
