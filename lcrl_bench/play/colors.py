"""How many colours a terminal shows.

Source: no-color.org.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Final

from rich.color import ColorSystem


class Colors(StrEnum):
    """What a terminal can show."""

    FULL = "full"
    """24-bit colours."""
    INDEXED = "256"
    """The 256 colours of xterm."""
    PLAIN = "none"
    """No colours: letters stand for what is seen."""

    @property
    def system(self) -> ColorSystem | None:
        """What rich calls it."""
        systems = {Colors.FULL: ColorSystem.TRUECOLOR, Colors.INDEXED: ColorSystem.EIGHT_BIT}
        return systems.get(self)


FULL_PROGRAMS: Final = frozenset({"iTerm.app", "WezTerm", "vscode", "ghostty", "Hyper", "rio"})
"""Values of TERM_PROGRAM of terminals with 24-bit colours."""


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
