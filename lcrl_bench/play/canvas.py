"""A page of a terminal: letters in a grid, each with its colours, and pictures of half blocks.

What does not fit is cut off, so nothing that is drawn can spoil a line.
"""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.play.colors import Colors, ink_code, paper_code
from lcrl_bench.recording.palette import Color

HALF: Final = "\N{UPPER HALF BLOCK}"
"""Two pixels, one above the other, in one letter: its ink and its paper."""
RESET: Final = "\x1b[0m"


@dataclass(frozen=True)
class Style:
    """How a letter is drawn."""

    ink: Color | None = None
    """None is the terminal's own."""
    paper: Color | None = None
    bold: bool = False
    underline: bool = False


@dataclass(frozen=True)
class Cell:
    """A place for a letter."""

    text: str = " "
    """One letter with what is written over it; empty behind a letter of double width."""
    style: Style = Style()


_EMPTY: Final = Cell()
PLAIN: Final = Style()
BOLD: Final = Style(bold=True)


class Canvas:
    """Rows of cells."""

    def __init__(self, rows: int, columns: int) -> None:
        """Begin with nothing drawn."""
        self.rows, self.columns = rows, columns
        self._cells = [[_EMPTY] * columns for _ in range(rows)]

    def write(self, row: int, column: int, text: str, style: Style = PLAIN) -> int:
        """Write a line of text, cut off at the edges.

        Returns:
            The column behind it.
        """
        for letter in text:
            width = letter_width(letter)
            if width == 0:
                self._pile(row, column - 1, letter)
                continue
            if 0 <= row < self.rows and 0 <= column <= self.columns - width:
                self._cells[row][column] = Cell(letter, style)
                if width == 2:
                    self._cells[row][column + 1] = Cell("", style)
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
        """Draw a picture of two pixels a letter: uint8 [row, column, 3], an even number of rows."""
        for k, (upper, lower) in enumerate(zip(pixels[::2], pixels[1::2], strict=True)):
            for j, (ink, paper) in enumerate(zip(upper.tolist(), lower.tolist(), strict=True)):
                same = ink == paper
                style = Style(None if same else tuple(ink), tuple(paper))
                self.write(row + k, column + j, " " if same else HALF, style)

    def lines(self, colors: Colors) -> list[str]:
        """The page as a terminal takes it: a line a row, each ending in no colour."""
        if colors == Colors.PLAIN:
            return ["".join(cell.text for cell in row).rstrip() for row in self._cells]
        return [_coded(row, colors) for row in self._cells]

    def _pile(self, row: int, column: int, letter: str) -> None:
        """Write over the letter that is there, as accents and joiners are."""
        if 0 <= row < self.rows and 0 <= column < self.columns:
            cell = self._cells[row][column]
            self._cells[row][column] = replace(cell, text=cell.text + letter)


def letter_width(letter: str) -> int:
    """How many columns a terminal gives a letter: 0 for what is written over another, 1 or 2."""
    if unicodedata.category(letter) in {"Mn", "Me", "Cf", "Cc"}:
        return 0
    return 2 if unicodedata.east_asian_width(letter) in "WF" else 1


def text_width(text: str) -> int:
    """How many columns a terminal gives a text."""
    return sum(map(letter_width, text))


def _coded(row: list[Cell], colors: Colors) -> str:
    end = max((k for k, cell in enumerate(row) if cell != _EMPTY), default=-1) + 1
    line, before = "", PLAIN
    for cell in row[:end]:
        if cell.style != before:
            line += _sgr(cell.style, colors)
            before = cell.style
        line += cell.text
    return line + (RESET if before != PLAIN else "")


def _sgr(style: Style, colors: Colors) -> str:
    words = ["0"]
    words += ["1"] if style.bold else []
    words += ["4"] if style.underline else []
    words += [ink_code(style.ink, colors)] if style.ink is not None else []
    words += [paper_code(style.paper, colors)] if style.paper is not None else []
    return f"\x1b[{';'.join(words)}m"
