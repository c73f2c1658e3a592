"""Letters, colours and half blocks."""

from __future__ import annotations

import re

import numpy as np
import pytest

from lcrl_bench.play.canvas import HALF, Canvas, Style, text_width
from lcrl_bench.play.colors import Colors, colors_wanted, nearest_index

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
    """The colours as xterm defines them, written another way."""
    if number >= 232:
        grey = 8 + 10 * (number - 232)
        return grey, grey, grey
    cube = [0, 95, 135, 175, 215, 255]
    number -= 16
    return cube[number // 36], cube[number // 6 % 6], cube[number % 6]


@pytest.mark.parametrize("number", range(16, 256))
def test_a_colour_of_xterm_is_its_own_nearest(number):
    assert xterm(nearest_index(xterm(number))) == xterm(number)


def test_no_colour_of_xterm_is_much_nearer_than_the_one_chosen():
    generator = np.random.default_rng(0)
    table = np.array([xterm(number) for number in range(16, 256)])
    for color in generator.integers(0, 256, (200, 3)):
        away = np.linalg.norm(table - color, axis=1)
        chosen = away[nearest_index(tuple(color.tolist())) - 16]
        assert chosen <= away.min() + 1e-9


def test_what_does_not_fit_is_cut_off_at_every_edge():
    canvas = Canvas(2, 4)
    assert canvas.write(0, 2, "abcdef") == 8
    canvas.write(-1, 0, "x")
    canvas.write(5, 0, "x")
    canvas.write(1, -2, "yyy")
    assert canvas.lines(Colors.PLAIN) == ["  ab", "y"]


def test_wide_letters_take_two_columns_and_accents_none():
    assert text_width("卧室") == 4
    assert text_width("e\u0301te") == 3
    canvas = Canvas(1, 5)
    canvas.write(0, 0, "卧室卧")
    assert canvas.lines(Colors.PLAIN) == ["卧室"]
    canvas = Canvas(1, 5)
    canvas.write(0, 0, "e\u0301te")
    assert canvas.lines(Colors.PLAIN) == ["e\u0301te"]


def test_two_pixels_share_a_letter_the_upper_is_its_ink_the_lower_its_paper():
    canvas = Canvas(1, 2)
    canvas.picture(0, 0, np.array([[[255, 0, 0], [9, 9, 9]], [[0, 0, 255], [9, 9, 9]]], np.uint8))
    (line,) = canvas.lines(Colors.FULL)
    assert line == f"\x1b[0;38;2;255;0;0;48;2;0;0;255m{HALF}\x1b[0;48;2;9;9;9m \x1b[0m"
    (line,) = canvas.lines(Colors.INDEXED)
    assert re.fullmatch(r"\x1b\[0;38;5;196;48;5;21m.\x1b\[0;48;5;\d+m \x1b\[0m", line)


def test_a_style_is_said_once_and_ends_with_the_line():
    canvas = Canvas(2, 6)
    canvas.write(0, 0, "abc", Style(bold=True, underline=True))
    assert canvas.lines(Colors.FULL) == ["\x1b[0;1;4mabc\x1b[0m", ""]
    assert canvas.lines(Colors.PLAIN) == ["abc", ""]


def test_rows_of_one_page_are_laid_onto_another():
    sheet, canvas = Canvas(3, 2), Canvas(3, 4)
    for row, text in enumerate(("aa", "bb", "cc")):
        sheet.write(row, 0, text)
    canvas.paste(sheet, 1, 3, first=1, rows=2)
    assert canvas.lines(Colors.PLAIN) == ["", "   b", "   c"]
