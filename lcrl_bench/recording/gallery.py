"""A gallery of houses: each from above, and as an agent in it sees it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lcrl_bench.houses.house import House
from lcrl_bench.recording.bird import draw
from lcrl_bench.recording.figure_file import save_figure
from lcrl_bench.recording.meshes import house_meshes
from lcrl_bench.recording.palette import INK
from lcrl_bench.recording.pictures import panorama_picture
from lcrl_bench.recording.theme import Theme, theme_of

COLUMNS = 3
"""Houses side by side."""
SIZE = (760, 640)
"""Columns and rows of a house's picture."""


@dataclass(frozen=True, eq=False)
class Exhibit:
    """A house and a panorama from inside it."""

    house: House
    panorama: NDArray[np.uint8]
    """[4, height, width] class ids."""


def most_telling(panoramas: NDArray[np.uint8]) -> int:
    """Index of the panorama that shows the most classes, the first of equals.

    Args:
        panoramas: [panorama, 4, height, width] class ids.
    """
    shown = [len(np.unique(panorama)) for panorama in panoramas]
    return int(np.argmax(shown))


def gallery_picture(path: Path, exhibits: Sequence[Exhibit], theme: Theme | None = None) -> None:
    """Write a sheet of houses: PNG, SVG or PDF by suffix.

    Args:
        path: Where to write.
        exhibits: In reading order, three a row.
        theme: The page it is for; None lets an SVG follow its reader, and is light otherwise.

    Raises:
        UsageError: If the suffix of `path` is not that of a picture.
    """
    rows = -(-len(exhibits) // COLUMNS)
    figure = Figure(figsize=(3.25 * COLUMNS, 3.4 * rows), layout="constrained")
    grid = figure.add_gridspec(2 * rows, COLUMNS, height_ratios=[5, 1] * rows)
    for index, exhibit in enumerate(exhibits):
        row, column = divmod(index, COLUMNS)
        house = exhibit.house
        above = figure.add_subplot(grid[2 * row, column])
        above.imshow(draw(house_meshes(house), SIZE), interpolation="antialiased")
        rooms = f"{len(house.rooms)} rooms, {len(house.objects)} objects"
        above.set_title(f"{house.id}: {rooms}", fontsize=7, color=INK)
        below = figure.add_subplot(grid[2 * row + 1, column])
        below.imshow(panorama_picture(exhibit.panorama), interpolation="nearest", aspect="auto")
        for axes in (above, below):
            axes.set_axis_off()
    save_figure(path, figure, theme_of(path, theme))
