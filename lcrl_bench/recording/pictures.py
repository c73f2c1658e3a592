"""Pictures for papers and pages: plans and galleries of houses, the showcase of a run.

The format follows the file's suffix: PNG, SVG or PDF. Every figure is made of `Figure` objects, so
nothing depends on a screen or on matplotlib's global state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lcrl_bench.houses.house import House
from lcrl_bench.recording.bird import bird_picture, draw
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import Theme, save_figure
from lcrl_bench.recording.floor import house_plan
from lcrl_bench.recording.meshes import house_meshes
from lcrl_bench.recording.palette import INK
from lcrl_bench.recording.plan import MARGIN, draw_grid, draw_plan
from lcrl_bench.recording.reward_plan import draw_map, draw_scale, legend_handles, plan_inches
from lcrl_bench.recording.storyboard import Storyboard
from lcrl_bench.recording.views import draw_panorama, panorama_picture
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.scene import Scene

GALLERY_COLUMNS: Final = 3
"""Houses side by side."""
GALLERY_SIZE: Final = (760, 640)
"""Columns and rows of a house's picture."""
_LONGEST: Final = 9.0
"""Inches of the longer side of a plan."""


def house_picture(path: Path, house: House, grid: Grid | None = None) -> None:
    """Draw `house_figure` into a file.

    Raises:
        UsageError: If the suffix of `path` is not `.png`, `.svg` or `.pdf`.
    """
    save_figure(path, house_figure(house, grid), "light")


def house_figure(house: House, grid: Grid | None = None) -> Figure:
    """The plan of a house: rooms, walls, openings and labelled furniture.

    Args:
        house: The house.
        grid: Where the agent can stand and go; None leaves it out.
    """
    plan = house_plan(house)
    width, height = plan_inches(plan.extent, _LONGEST)
    figure = Figure(figsize=(width, height + 0.35))
    axes = figure.add_axes((0.0, 0.0, 1.0, height / (height + 0.35)))
    draw_plan(axes, plan)
    note = f"{len(house.rooms)} rooms, {len(house.objects)} objects"
    if grid is not None:
        draw_grid(axes, grid)
        note += f", {grid.tiles} tiles of {grid.tile:g} m"
    title = (MARGIN / 2 / width, 1 - 0.2 / (height + 0.35))
    figure.text(*title, house.id, fontsize=11, weight="bold", color=INK, va="center")
    figure.text(1 - title[0], title[1], note, fontsize=8, color=INK, ha="right", va="center")
    _draw_metre(axes)
    return figure


def showcase_figure(board: Storyboard) -> Figure:
    """What the suite is about: a house, what the agent sees in it, and a learned reward.

    Args:
        board: What to show; a PICK success shows most.
    """
    episode, step = board.episode, _telling_step(board.episode)
    house = bird_picture(board, step)
    (x0, y0), (x1, y1) = board.floor.plan.extent
    deep = y1 - y0 > 0.8 * (x1 - x0)
    # Two maps side by side need more room than one above the other.
    shape, inches, share = ((1, 2), 16.0, 1.25) if deep else ((2, 1), 13.0, 0.72)
    figure = Figure(figsize=(inches, 6.8), layout="constrained")
    figure.suptitle(board.title, fontsize=14, color=INK, parse_math=False)
    halves: Any = figure.subfigures(1, 2, width_ratios=(1.0, share))
    left, right = halves
    house_axes, view_axes = left.subplots(2, 1, height_ratios=(3.4, 1.0))
    house_axes.imshow(house, interpolation="antialiased")
    house_axes.set_axis_off()
    draw_panorama(left, view_axes, episode.seen[step])
    # The reward where the episode ended, since it is paid there; the value at the step shown.
    layers = (int(episode.object_states[-1]), int(episode.object_states[step]))
    axes = np.atleast_1d(right.subplots(*shape)).reshape(-1)
    for at, tile_map, layer in zip(axes, board.maps, layers, strict=False):
        draw_map(at, board, tile_map, layer, path="all")
        at.set_title(tile_map.captions[layer], fontsize=10, color=INK)
        draw_scale(right, at, tile_map)
    handles = legend_handles(board)
    right.legend(
        handles=handles,
        loc="outside lower center",
        ncols=len(handles) if deep else 2,
        fontsize=8,
        frameon=False,
    )
    return figure


@dataclass(frozen=True, eq=False)
class Exhibit:
    """A house and a panorama from inside it."""

    house: House
    panorama: NDArray[np.uint8]
    """[4, height, width] class ids."""


def most_telling(panoramas: NDArray[np.uint8]) -> int:
    """Index of the panorama that shows the most classes; the first of several.

    Args:
        panoramas: [panorama, 4, height, width] class ids.
    """
    shown = [len(np.unique(panorama)) for panorama in panoramas]
    return int(np.argmax(shown))


def gallery_picture(path: Path, exhibits: Sequence[Exhibit], theme: Theme | None = None) -> None:
    """Write a sheet of houses: PNG, SVG or PDF by suffix.

    Args:
        path: Where to write.
        exhibits: In reading order, three per row.
        theme: The page it is for; None lets an SVG follow its reader, and is light otherwise.

    Raises:
        UsageError: If the suffix of `path` is not that of a picture.
    """
    rows = -(-len(exhibits) // GALLERY_COLUMNS)
    figure = Figure(figsize=(3.25 * GALLERY_COLUMNS, 3.4 * rows), layout="constrained")
    grid = figure.add_gridspec(2 * rows, GALLERY_COLUMNS, height_ratios=[5, 1] * rows)
    for index, exhibit in enumerate(exhibits):
        row, column = divmod(index, GALLERY_COLUMNS)
        house = exhibit.house
        above = figure.add_subplot(grid[2 * row, column])
        above.imshow(draw(house_meshes(Scene(house)), GALLERY_SIZE), interpolation="antialiased")
        rooms = f"{len(house.rooms)} rooms, {len(house.objects)} objects"
        above.set_title(f"{house.id}: {rooms}", fontsize=7, color=INK)
        below = figure.add_subplot(grid[2 * row + 1, column])
        below.imshow(panorama_picture(exhibit.panorama), interpolation="nearest", aspect="auto")
        for axes in (above, below):
            axes.set_axis_off()
    save_figure(path, figure, theme)


def _telling_step(episode: Episode) -> int:
    """A step worth showing: halfway with the object in hand, else halfway to the goal."""
    held = np.flatnonzero(episode.object_states == 1)
    if len(held):
        return int(held[len(held) // 2])
    done = np.flatnonzero(episode.done)
    return int(done[0] if len(done) else episode.horizon) // 2


def _draw_metre(axes: Axes) -> None:
    """A bar of one metre in the lower left corner."""
    x, y = axes.get_xlim()[0] + MARGIN, axes.get_ylim()[0] + MARGIN / 2.5
    axes.plot([x, x + 1], [y, y], color=INK, linewidth=2, solid_capstyle="butt")
    axes.text(x + 1.1, y, "1 m", fontsize=7, color=INK, va="center")
