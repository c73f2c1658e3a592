"""Maps over a house: tiles coloured by a number, the marks of a task and the agent's path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.patches import Rectangle
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import Halo
from lcrl_bench.recording.maps import TileMap, episode_floor, rings
from lcrl_bench.recording.palette import (
    AGENT,
    GOAL,
    INK,
    SIGN,
    TAKE,
    Color,
    hex_color,
)
from lcrl_bench.recording.plan import PlanStyle, draw_plan

HEADING_STEP: Final = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))
"""(east, north) of a step in each heading."""
_MARKER_TURN: Final = (0.0, -90.0, 180.0, 90.0)
OPACITY: Final = 0.88
"""Of the tiles, so that furniture shows through."""
PLAIN: Final = PlanStyle(fills=False, room_names=True, object_names=False)


def draw_map(
    axes: Axes,
    episode: Episode,
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
        episode: The house, the task, and where the agent went.
        tile_map: The colours of the tiles.
        layer: Object state.
        path: Where the agent went: not at all, while the object is in this state, or always.
        style: Style of the plan underneath.
    """
    grid, task, house = episode.scene.grid, episode.task, episode.scene.house
    draw_plan(axes, house, style, _marked(episode))
    floor = episode_floor(episode)
    borders = [rings(shape) for shape in floor.shapes]
    shades = np.repeat(tile_map.colors(layer) / 255, [len(lines) for lines in borders], axis=0)
    patches = [PolygonPatch(ring) for lines in borders for ring in lines]
    axes.add_collection(
        PatchCollection(
            patches, facecolor=shades, edgecolor="white", linewidth=0.5, alpha=OPACITY, zorder=3
        )
    )
    _draw_signs(axes, floor.centers, tile_map, layer)
    _outline(axes, floor.take, TAKE, dashed=True)
    _outline(axes, floor.goal, GOAL)
    if task.kind == Kind.PICK and task.placement is not None and task.moved is not None:
        state = layer if len(tile_map.layers) > 1 else None
        found = house.object(task.moved)
        _letter(axes, found.position[:2], "A", TAKE, present=state == ObjectState.AT_A)
        _letter(axes, task.placement.position[:2], "B", GOAL, present=state == ObjectState.AT_B)
    x, y = floor.centers[task.start_tile]
    side = grid.tile * 0.8
    square = Rectangle((x - side / 2, y - side / 2), side, side, fill=False, linewidth=1.6)
    square.set(edgecolor=INK, zorder=7)
    axes.add_patch(square)
    _triangle(axes, (x, y), task.start_heading, "white", size=6)
    if path != "none":
        _draw_path(axes, episode, layer if path == "layer" else None)


def _marked(episode: Episode) -> BaseGeometry:
    """Where marks are that no name may cover: the path, its start, the places A and B."""
    task, house = episode.task, episode.scene.house
    points = episode.scene.grid.points[episode.tiles]
    places = [house.object(task.moved)] if task.moved is not None else []
    places += [task.placement] if task.placement is not None else []
    marks = [shapely.Point(place.position[:2]) for place in places]
    return shapely.union_all([shapely.LineString(points), *marks]).buffer(0.45)


def _draw_signs(axes: Axes, centers: NDArray[np.float64], tile_map: TileMap, layer: int) -> None:
    """Mark tiles near the top of the scale with a plus, near the bottom with a minus: for print."""
    for sign, tiles in tile_map.signs(layer).items():
        axes.scatter(
            *centers[tiles].T,
            s=16,
            marker="+" if sign == "+" else "_",
            color=hex_color(SIGN),
            linewidths=0.9,
            zorder=3.5,
        )


def _draw_path(axes: Axes, episode: Episode, layer: int | None) -> None:
    """Draw where the agent went, with an arrow at its end; only in one object state if given."""
    points = episode.scene.grid.points[episode.tiles]
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


def legend_handles(episode: Episode, *, agent: bool = True) -> list[Line2D]:
    """The legend of the marks, with the agent if it is drawn."""
    task = episode.task
    square = {"linestyle": "none", "markersize": 9, "markerfacecolor": "none"}
    triangle = {"color": "none", "marker": "^", "markersize": 9, "markeredgecolor": INK}
    handles = [Line2D([], [], marker="s", markeredgecolor=INK, label="start", **square)]
    if agent:
        yellow = hex_color(AGENT)
        handles.append(
            Line2D([], [], markerfacecolor=yellow, label="agent, at the end", **triangle)
        )
    if not episode.goal_known:
        return handles
    if task.kind == Kind.PICK and task.moved is not None:
        name = episode.scene.house.object(task.moved).label.replace("_", " ")
        take = {"color": hex_color(TAKE), "linestyle": (0, (2, 1)), "linewidth": 2.2}
        handles.append(Line2D([], [], label=f"A: {name} within reach", **take))
        meaning = "B: where it is to go, within reach"
    else:
        meaning = f"goal: at the {task.target.replace('_', ' ')}"
        if task.target_room is not None:
            meaning = f"goal: in the {task.target}"
    handles.append(Line2D([], [], label=meaning, color=hex_color(GOAL), linewidth=2.2))
    return handles


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
