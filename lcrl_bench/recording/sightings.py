"""What can be named in a view: the largest things in sight, each with a place for its name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from lcrl_bench.houses.classes import class_id, semantic_classes

UNNAMED: Final = ("void", "wall", "floor", "ceiling", "door_frame")
"""Classes that are nearly everywhere."""
MOST: Final = 3
"""Names a view has room for."""
LEAST_PIXELS: Final = 9
"""Of a region worth a name."""
ROWS_APART: Final = 5.0
"""Rows a name needs, so that two do not lie on each other."""
LETTER: Final = 1.25
"""Columns that a letter of a name takes."""


@dataclass(frozen=True)
class Sighting:
    """A thing in a view."""

    words: str
    """Its class."""
    pixels: int
    """Of the largest connected region of the class."""
    row: float
    """Of the middle of its name; 0 is the upper edge of the view."""
    column: float


def sightings(view: NDArray[np.uint8]) -> list[Sighting]:
    """The largest regions in sight, the largest first, one a class.

    A name stands over the middle of its region, moved only to stay within the view. A region whose
    name would lie on that of a larger one is left out.

    Args:
        view: uint8 [row, column] class ids.

    Returns:
        At most `MOST`.
    """
    skipped = {class_id(name) for name in UNNAMED}
    found = [
        sighting
        for number in np.unique(view).tolist()
        if number not in skipped and (sighting := _largest(view, number)).pixels >= LEAST_PIXELS
    ]
    chosen: list[Sighting] = []
    for sighting in sorted(found, key=lambda each: (-each.pixels, each.words)):
        if all(abs(sighting.row - other.row) >= ROWS_APART for other in chosen):
            chosen.append(sighting)
    return chosen[:MOST]


def _largest(view: NDArray[np.uint8], number: int) -> Sighting:
    """The largest connected region of a class that is in sight."""
    regions = np.zeros(view.shape, np.int64)
    ndimage.label(view == number, output=regions)
    sizes = np.bincount(regions.reshape(-1))
    sizes[0] = 0
    row, column = np.argwhere(regions == sizes.argmax()).mean(axis=0) + 0.5
    words, rows, columns = semantic_classes()[number].words, *view.shape
    half = LETTER * len(words) / 2
    return Sighting(
        words,
        int(sizes.max()),
        float(np.clip(row, ROWS_APART / 2, rows - ROWS_APART / 2)),
        float(np.clip(column, half, columns - half)) if 2 * half < columns else columns / 2,
    )
