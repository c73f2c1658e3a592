"""Maps over a house: tiles coloured by a number, the marks of a task and the agent's path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, Literal

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.house import Point
from lcrl_bench.recording.figures import Halo
from lcrl_bench.recording.maps import NEAR_AN_END, TileMap
from lcrl_bench.recording.palette import (
    AGENT,
    GOAL,
    INK,
    SIGN,
    TAKE,
    Color,
    hex_color,
)
from lcrl_bench.recording.plan import MARGIN, PlanStyle, draw_plan
from lcrl_bench.recording.storyboard import Storyboard

HEADING_STEP: Final = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))
"""(east, north) of a step in each heading."""
_MARKER_TURN: Final = (0.0, -90.0, 180.0, 90.0)
OPACITY: Final = 0.88
"""Of the tiles, so that furniture shows through."""
PLAIN: Final = PlanStyle(fills=False, room_names=True, object_names=False)


def reward_map_figure(board: Storyboard, maps: Sequence[TileMap] | None = None) -> Figure:
    """A learned reward and its value over the house, as the paper's appendix draws them.

    The reward is above, the value below (of a learned policy: its visits above the expert's). A
    PICK task has one column per place of the object: the paper's "before" and "after the object is
    acquired", and a third for the object at its new place, where success is paid.

    Source: paper, appendix "Learned Rewards and Qualitative Results".

    Args:
        board: What happened.
        maps: What to draw; None means these two.
    """
    maps = board.maps if maps is None else maps
    layers = len(maps[0].layers)
    columns, rows = layers, len(maps)
    if columns == 1:
        columns, rows = rows, 1
    width, height = plan_inches(board.floor.plan.extent, 4.2 if layers > 1 else 5.0)
    size = (columns * (width + 0.35) + 0.8, rows * (height + 0.3) + 1.25)
    figure = Figure(figsize=size, layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns)).reshape(rows, columns)
    figure.suptitle(board.title, fontsize=11, color=INK, parse_math=False)
    for number, tile_map in enumerate(maps):
        for layer, caption in enumerate(tile_map.captions):
            at = axes[number, layer] if layers > 1 else axes[0, number]
            draw_map(at, board, tile_map, layer, path="layer")
            at.set_title(caption, fontsize=9, color=INK, pad=3)
        draw_scale(figure, list(axes[number]) if layers > 1 else axes[0, number], tile_map)
    handles = legend_handles(board)
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), fontsize=8, frameon=False
    )
    return figure


def plan_inches(corners: tuple[Point, Point], longest: float) -> tuple[float, float]:
    """Width and height of a plan: 1.2 inches per metre, its longer side at most `longest`."""
    (x0, y0), (x1, y1) = corners
    width, height = x1 - x0 + 2 * MARGIN, y1 - y0 + 2 * MARGIN
    scale = min(1.2, longest / max(width, height))
    return width * scale, height * scale


def draw_map(
    axes: Axes,
    board: Storyboard,
    tile_map: TileMap,
    layer: int,
    *,
    path: Literal["none", "layer", "all"] = "none",
    style: PlanStyle = PLAIN,
) -> None:
    """Draw one layer of a map over the plan of the house, with the marks of the task.

    Green dashes: where the object can be taken (place A). Orange line: where it can be put (place
    B), or the goal of NAV. Black square and triangle: start and its heading. The letter of the
    place where the object is in this layer is filled; neither is if the map has one layer for all.

    Args:
        axes: Where to draw.
        board: The house, the task, and where the agent went.
        tile_map: The colours of the tiles.
        layer: Object state.
        path: Where the agent went: not at all, while the object is in this state, or always.
        style: Style of the plan underneath.
    """
    episode, floor = board.episode, board.floor
    draw_plan(axes, floor.plan, style, _marked(board))
    repeats = [len(lines) for lines in floor.borders]
    shades = np.repeat(tile_map.colors[layer] / 255, repeats, axis=0)
    patches = [PolygonPatch(ring) for lines in floor.borders for ring in lines]
    axes.add_collection(
        PatchCollection(
            patches, facecolor=shades, edgecolor="white", linewidth=0.5, alpha=OPACITY, zorder=3
        )
    )
    _draw_signs(axes, floor.centers, tile_map, layer)
    _outline(axes, floor.take, TAKE, dashed=True)
    _outline(axes, floor.goal, GOAL)
    state = layer if len(tile_map.layers) > 1 else None
    for place, color in zip(floor.places, (TAKE, GOAL), strict=False):
        _letter(axes, place.at, place.letter, color, present=state == place.part)
    x, y = floor.centers[episode.task.start_tile]
    side = episode.scene.grid.tile * 0.8
    square = Rectangle((x - side / 2, y - side / 2), side, side, fill=False, linewidth=1.6)
    square.set(edgecolor=INK, zorder=7)
    axes.add_patch(square)
    _triangle(axes, (x, y), episode.task.start_heading, "white", size=6)
    if path != "none":
        _draw_path(axes, board, layer if path == "layer" else None)


def _marked(board: Storyboard) -> BaseGeometry:
    """Where marks are that no name may cover: the path, its start, the places A and B."""
    places = [shapely.Point(place.at) for place in board.floor.places]
    return shapely.union_all([shapely.LineString(board.points), *places]).buffer(0.45)


def _draw_signs(axes: Axes, centers: NDArray[np.float64], tile_map: TileMap, layer: int) -> None:
    """Mark tiles near the top of the scale with a plus, near the bottom with a minus: for print."""
    for sign, tiles in tile_map.signs.items():
        axes.scatter(
            *centers[tiles[layer]].T,
            s=16,
            marker="+" if sign == "+" else "_",
            color=hex_color(SIGN),
            linewidths=0.9,
            zorder=3.5,
        )


def _draw_path(axes: Axes, board: Storyboard, layer: int | None) -> None:
    """Draw where the agent went, with an arrow at its end; only in one object state if given."""
    episode, points = board.episode, board.points
    within = np.ones(len(points), bool) if layer is None else episode.object_states == layer
    borders = np.flatnonzero(np.diff(within)) + 1
    stays = zip(np.split(points, borders), np.split(within, borders), strict=True)
    ways = [stay for stay, inside in stays if inside[0] and len(stay) > 1]
    style = {"colors": INK, "linewidths": 1.8, "capstyle": "round", "joinstyle": "round"}
    lines = LineCollection(ways, zorder=7, **style)
    lines.set_path_effects([Halo(4)])
    axes.add_collection(lines)
    if within.any():
        last = int(np.flatnonzero(within)[-1])
        heading = int(episode.headings[last])
        _triangle(axes, points[last], heading, hex_color(AGENT), size=10)


def legend_handles(board: Storyboard, *, agent: bool = True) -> list[Line2D]:
    """The legend of the marks, with the agent if it is drawn."""
    square = {"linestyle": "none", "markersize": 9, "markerfacecolor": "none"}
    triangle = {"color": "none", "marker": "^", "markersize": 9, "markeredgecolor": INK}
    styles: dict[str, dict[str, Any]] = {
        "start": {"marker": "s", "markeredgecolor": INK, **square},
        "agent": {"markerfacecolor": hex_color(AGENT), **triangle},
        "take": {"color": hex_color(TAKE), "linestyle": (0, (2, 1)), "linewidth": 2.2},
        "goal": {"color": hex_color(GOAL), "linewidth": 2.2},
    }
    return [
        Line2D([], [], label=mark.words, **styles[mark.kind])
        for mark in board.marks
        if agent or mark.kind != "agent"
    ]


def draw_scale(figure: Any, axes: Any, tile_map: TileMap) -> None:  # noqa: ANN401
    """Draw the scale of a map beside its axes.

    Args:
        figure: A matplotlib figure or subfigure.
        axes: One or more axes of it.
        tile_map: The map.
    """
    anchors = tile_map.ramp(65) / 255
    colors = LinearSegmentedColormap.from_list("low-to-high", anchors)
    low, high = tile_map.limits
    high = high if high > low else low + 1e-9
    scale = Normalize(low, high)
    bar = figure.colorbar(ScalarMappable(scale, colors), ax=axes, fraction=0.04, pad=0.02)
    bar.ax.tick_params(labelsize=7)
    bar.outline.set_linewidth(0.5)
    if not tile_map.visits:
        # As on the tiles: printed in grey, both ends are dark.
        for share, sign in ((NEAR_AN_END / 2, "_"), (1 - NEAR_AN_END / 2, "+")):
            at = low + share * (high - low)
            bar.ax.plot([0.5], [at], marker=sign, color=hex_color(SIGN), markersize=4)


def _outline(
    axes: Axes, lines: Sequence[NDArray[np.float64]], color: Color, *, dashed: bool = False
) -> None:
    casing = LineCollection(lines, colors="white", linewidths=3.6, zorder=5.5)
    border = LineCollection(lines, colors=hex_color(color), linewidths=2.2, zorder=6)
    if dashed:
        border.set_linestyle((0, (2, 1)))
    axes.add_collection(casing)
    axes.add_collection(border)


def _letter(axes: Axes, at: tuple[float, ...], letter: str, color: Color, *, present: bool) -> None:
    """A round badge, filled if the object is there."""
    fill, ink = (hex_color(color), "white") if present else ("white", hex_color(color))
    badge = {"boxstyle": "circle,pad=0.22", "facecolor": fill, "edgecolor": hex_color(color)}
    axes.text(
        at[0],
        at[1],
        letter,
        fontsize=7.5,
        weight="bold",
        color=ink,
        ha="center",
        va="center",
        bbox={**badge, "linewidth": 1.4},
        zorder=10,
    )


def _triangle(
    axes: Axes, at: tuple[float, float] | NDArray, heading: int, fill: str, *, size: float
) -> None:
    turn = _MARKER_TURN[heading]
    marker = (3, 0, turn)
    (mark,) = axes.plot([at[0]], [at[1]], marker=marker, markersize=size, linestyle="none")
    mark.set(markerfacecolor=fill, markeredgecolor=INK, markeredgewidth=1.1, zorder=11)
    mark.set_path_effects([Halo(2.4)])
