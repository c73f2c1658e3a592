"""How many colours a terminal shows, and the codes that choose one.

Source: ECMA-48, "Select Graphic Rendition"; xterm's 256 colours, a cube of 6 x 6 x 6 and 24 greys;
no-color.org.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from functools import lru_cache
from typing import Final

from lcrl_bench.recording.palette import Color


class Colors(StrEnum):
    """What a terminal can show."""

    FULL = "full"
    """24-bit colours."""
    INDEXED = "256"
    """The 256 colours of xterm."""
    PLAIN = "none"
    """No colours: letters stand for what is seen."""


FULL_PROGRAMS: Final = frozenset({"iTerm.app", "WezTerm", "vscode", "ghostty", "Hyper", "rio"})
"""Values of TERM_PROGRAM of terminals with 24-bit colours."""
_CUBE: Final = (0, 95, 135, 175, 215, 255)
"""Brightness of the steps of the cube's sides."""
_GREYS: Final = tuple(range(8, 248, 10))
_FIRST_OF_CUBE, _FIRST_GREY = 16, 232


def colors_wanted(environment: Mapping[str, str], *, terminal: bool, encoding: str) -> Colors:
    """What to draw with.

    Args:
        environment: `NO_COLOR`, `COLORTERM`, `TERM` and `TERM_PROGRAM` are looked at.
        terminal: Whether the output is a terminal.
        encoding: Of the output; half blocks need Unicode.
    """
    term = environment.get("TERM", "")
    unicode = encoding.lower().replace("-", "") in {"utf8", "utf16", "utf32"}
    if environment.get("NO_COLOR") or not terminal or not unicode or term in {"", "dumb"}:
        return Colors.PLAIN
    if environment.get("COLORTERM", "").lower() in {"truecolor", "24bit"}:
        return Colors.FULL
    if environment.get("TERM_PROGRAM") in FULL_PROGRAMS or term.endswith("-direct"):
        return Colors.FULL
    return Colors.INDEXED


def ink_code(color: Color | None, colors: Colors) -> str:
    """The parameters that choose the colour of letters; None is the terminal's own."""
    return _code(3, color, colors)


def paper_code(color: Color | None, colors: Colors) -> str:
    """The parameters that choose the colour behind letters; None is the terminal's own."""
    return _code(4, color, colors)


def _code(layer: int, color: Color | None, colors: Colors) -> str:
    if color is None:
        return f"{layer}9"
    if colors == Colors.FULL:
        return f"{layer}8;2;{color[0]};{color[1]};{color[2]}"
    return f"{layer}8;5;{nearest_index(color)}"


@lru_cache(maxsize=4096)
def nearest_index(color: Color) -> int:
    """The number of the nearest of xterm's 256 colours that every terminal shows alike.

    The first 16 are left out: people choose those.
    """
    steps = [min(range(6), key=lambda k: abs(_CUBE[k] - channel)) for channel in color]
    cube = (_CUBE[steps[0]], _CUBE[steps[1]], _CUBE[steps[2]])
    grey = min(range(len(_GREYS)), key=lambda k: abs(_GREYS[k] - sum(color) / 3))
    level = _GREYS[grey]
    if _distance(color, (level, level, level)) < _distance(color, cube):
        return _FIRST_GREY + grey
    return _FIRST_OF_CUBE + 36 * steps[0] + 6 * steps[1] + steps[2]


def mix(color: Color, other: Color, share: float) -> Color:
    """A colour with a share of another one in it, 0..1."""
    red, green, blue = (
        round(a * (1 - share) + b * share) for a, b in zip(color, other, strict=True)
    )
    return red, green, blue


def _distance(a: Color, b: Color) -> int:
    return sum((x - y) ** 2 for x, y in zip(a, b, strict=True))
