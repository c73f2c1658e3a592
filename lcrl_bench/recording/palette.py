"""Colours of pictures and recordings, safe for the colour-blind.

Marks use the palette of Okabe and Ito (2008), and each has its own line style and letter, so that
none is identified by colour alone. The colours of numbers are in `recording.maps`.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.classes import semantic_classes

Color = tuple[int, int, int]
"""RGB, each 0..255."""

GREEN: Final[Color] = (0, 158, 115)
ORANGE: Final[Color] = (230, 159, 0)
SKY: Final[Color] = (86, 180, 233)
BLUE: Final[Color] = (0, 114, 178)
VERMILION: Final[Color] = (213, 94, 0)
YELLOW: Final[Color] = (240, 228, 66)
PINK: Final[Color] = (204, 121, 167)
BLACK: Final[Color] = (20, 20, 24)
WHITE: Final[Color] = (255, 255, 255)

SIGN: Final[Color] = (250, 250, 247)
"""Signs on dark tiles, on any paper."""
INK: Final = "#26262b"
"""Text, and lines of the same weight."""
GREY: Final = "#6b6b71"
"""Secondary text and lines."""
FAINT: Final = "#d8d8d4"
"""Lines behind the data."""
WALL: Final = "#4a4a50"

TAKE: Final = GREEN
"""Tiles from which the object can be taken, place A."""
GOAL: Final = ORANGE
"""Tiles of the goal of NAV, and those from which the object can be put at place B."""
AGENT: Final = YELLOW
PATH: Final = BLACK
ACTION_COLORS: Final[tuple[Color, ...]] = (SKY, BLUE, PINK, ORANGE)
"""Colours of forward, left, right, interact."""


def light(color: Color) -> Color:
    """A colour halfway to white: legible on black."""
    red, green, blue = ((channel + 255) // 2 for channel in color)
    return red, green, blue


def class_colors() -> NDArray[np.uint8]:
    """The colour of every semantic class: uint8 [class, 3]."""
    return np.array([entry.color for entry in semantic_classes()], np.uint8)


def named_class_colors() -> dict[str, Color]:
    """The colour of every semantic class by its name."""
    return {entry.name: entry.color for entry in semantic_classes()}


def hex_color(color: Color) -> str:
    """`(255, 0, 0)` as `"#ff0000"`."""
    return "#{:02x}{:02x}{:02x}".format(*color)
