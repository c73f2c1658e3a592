"""Colours of pictures and recordings, safe for the colour-blind.

Low is red and high is blue, as in the paper (appendix "Learned Rewards and Qualitative Results"),
with light grey in the middle: people with any common colour deficiency can tell red from blue.
Marks use the palette of Okabe and Ito (2008), and each has its own line style and letter, so that
none is identified by colour alone.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.classes import semantic_classes

Color = tuple[int, int, int]
"""RGB, each 0..255."""

LOW_TO_HIGH: Final[tuple[Color, ...]] = (
    (178, 24, 43),
    (205, 75, 70),
    (229, 131, 104),
    (246, 183, 150),
    (243, 236, 230),
    (160, 205, 227),
    (94, 166, 206),
    (48, 122, 184),
    (16, 74, 138),
)
"""Evenly spaced anchors of the diverging map.

Source: ColorBrewer RdBu, without its darkest ends.
"""

FEW_TO_MANY: Final[tuple[Color, ...]] = (
    (250, 250, 247),
    (203, 222, 240),
    (140, 187, 220),
    (72, 142, 196),
    (28, 98, 166),
    (8, 48, 107),
)
"""Evenly spaced anchors of the map of counts: paper for zero.

Source: ColorBrewer Blues, starting at paper.
"""

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


def unit_interval(values: NDArray[np.float64], limits: tuple[float, float]) -> NDArray[np.float64]:
    """Position of values between two limits, 0..1; 0.5 if the limits coincide."""
    low, high = limits
    if high <= low:
        return np.full(np.shape(values), 0.5)
    return np.clip((np.asarray(values, np.float64) - low) / (high - low), 0.0, 1.0)


def diverging(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    """The colours of shares 0 (red) .. 1 (blue).

    Returns:
        uint8 [..., 3].
    """
    return _between(LOW_TO_HIGH, shares)


def rising(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    """The colours of shares 0 (paper) .. 1 (dark blue).

    Returns:
        uint8 [..., 3].
    """
    return _between(FEW_TO_MANY, shares)


def _between(colors: tuple[Color, ...], shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    anchors = np.array(colors, np.float64)
    positions = np.linspace(0.0, 1.0, len(anchors))
    channels = [np.interp(shares, positions, anchors[:, channel]) for channel in range(3)]
    return np.stack(channels, axis=-1).round().astype(np.uint8)


def light(color: Color) -> Color:
    """A colour halfway to white: legible on black."""
    red, green, blue = ((channel + 255) // 2 for channel in color)
    return red, green, blue


def class_colors() -> NDArray[np.uint8]:
    """The colour of every semantic class: uint8 [class, 3]."""
    return np.array([entry.color for entry in semantic_classes()], np.uint8)


def hex_color(color: Color) -> str:
    """`(255, 0, 0)` as `"#ff0000"`."""
    return "#{:02x}{:02x}{:02x}".format(*color)
