"""A page of a terminal: letters in a grid, each with its colours, and pictures of half blocks.

What does not fit is cut off, so nothing that is drawn can spoil a line. Widths of letters and codes
of colours are rich's.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import groupby
from typing import Final, NamedTuple

import numpy as np
import rich.style
from numpy.typing import NDArray
from rich.cells import split_graphemes
from rich.color import Color as RichColor
from rich.color import ColorSystem

from lcrl_bench.play.colors import Colors
from lcrl_bench.recording.palette import Color

HALF: Final = "\N{UPPER HALF BLOCK}"
"""Two pixels, one above the other, in one letter: its ink and its paper."""


class Style(NamedTuple):
    """How a letter is drawn."""

    ink: Color | None = None
    """None is the terminal's own."""
    paper: Color | None = None
    bold: bool = False
    underline: bool = False


class Cell(NamedTuple):
    """A place for a letter."""

    text: str = " "
    """One letter with its accents; empty behind a letter of double width."""
    style: Style = Style()


PLAIN: Final = Style()
BOLD: Final = Style(bold=True)


class Canvas:
    """Rows of cells."""

    def __init__(self, rows: int, columns: int) -> None:
        """Begin with nothing drawn."""
        self.rows, self.columns = rows, columns
        self._cells = [[Cell()] * columns for _ in range(rows)]

    def write(self, row: int, column: int, text: str, style: Style = PLAIN) -> int:
        """Write a line of text, cut off at the edges.

        Returns:
            The column behind it.
        """
        for start, end, width in split_graphemes(text)[0]:
            self._put(row, column, text[start:end], width, style)
            column += width
        return column

    def style(self, row: int, column: int) -> Style:
        """How a letter is drawn; plainly outside of the page."""
        inside = 0 <= row < self.rows and 0 <= column < self.columns
        return self._cells[row][column].style if inside else PLAIN

    def paste(self, other: Canvas, top: int, left: int, *, first: int = 0, rows: int) -> None:
        """Lay rows of another page onto this one, from its row `first` on."""
        for k, line in enumerate(other._cells[first : first + rows]):
            for j, cell in enumerate(line):
                if 0 <= top + k < self.rows and 0 <= left + j < self.columns:
                    self._cells[top + k][left + j] = cell

    def picture(self, row: int, column: int, pixels: NDArray[np.uint8]) -> None:
        """Draw a picture, two pixels per letter: uint8 [row, column, 3], an even number of rows."""
        for k, (upper, lower) in enumerate(zip(pixels[::2], pixels[1::2], strict=True)):
            for j, (ink, paper) in enumerate(zip(upper.tolist(), lower.tolist(), strict=True)):
                same = ink == paper
                style = Style(None if same else tuple(ink), tuple(paper))
                self._put(row + k, column + j, " " if same else HALF, 1, style)

    def lines(self, colors: Colors) -> list[str]:
        """The page as a terminal takes it: one line per row, each ending in no colour."""
        return [_line(row, colors.system) for row in self._cells]

    def _put(self, row: int, column: int, letter: str, width: int, style: Style) -> None:
        if width and 0 <= row < self.rows and 0 <= column <= self.columns - width:
            behind = [Cell("", style)] * (width - 1)
            self._cells[row][column : column + width] = [Cell(letter, style), *behind]


def _line(row: list[Cell], system: ColorSystem | None) -> str:
    runs = (
        _rich_style(style, system).render("".join(cell.text for cell in run), color_system=system)
        for style, run in groupby(row, key=lambda cell: cell.style)
    )
    return "".join(runs).rstrip()


@lru_cache(maxsize=4096)
def _rich_style(style: Style, system: ColorSystem | None) -> rich.style.Style:
    """The style as rich has it, one per colour system: it keeps the codes of the first it meets."""
    ink, paper = (color and RichColor.from_rgb(*color) for color in (style.ink, style.paper))
    return rich.style.Style(color=ink, bgcolor=paper, bold=style.bold, underline=style.underline)
