"""A house seen from above, on matplotlib axes in metres: rooms, walls, openings, furniture.

Names on it avoid each other: each goes to the first free spot near its place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection, PathCollection
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon as PolygonPatch
from matplotlib.path import Path
from matplotlib.patheffects import AbstractPathEffect
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.classes import task_objects
from lcrl_bench.houses.house import OpeningKind, PlacedObject, RoomType
from lcrl_bench.recording.figures import Halo
from lcrl_bench.recording.floor import HousePlan
from lcrl_bench.recording.palette import INK, WALL, hex_color, light, named_class_colors
from lcrl_bench.scenes.grid import Grid

ROOM_TINTS: Final[dict[RoomType, str]] = {
    RoomType.BEDROOM: "#dfe6f3",
    RoomType.BATHROOM: "#d6eeee",
    RoomType.KITCHEN: "#f7e7d0",
    RoomType.LIVING_ROOM: "#e6efd9",
    RoomType.DINING_ROOM: "#f4dfdc",
    RoomType.OFFICE: "#e9e0f0",
    RoomType.HALLWAY: "#ececea",
    RoomType.OTHER: "#f2f0e6",
}
"""Fills of rooms; rooms are also named, so that nothing depends on telling colours apart."""

GLAZING: Final = "#8cc4e0"
LEAF: Final = "#96613a"
UNNAMED: Final = "small_object"
"""Clutter: plentiful, and no command names it."""
MARGIN: Final = 0.35
"""Metres of margin around the house."""
_ROOM_FOR_A_NAME: Final = 0.5
"""Square metres that a room's name needs."""
_POINT: Final = 1 / 72
"""Inches per typographic point."""
_WIDTH: Final = {"normal": 0.56, "bold": 0.66}
"""Mean width of a letter relative to its size, by weight."""
_LINE: Final = 1.15
"""Height of a line relative to the size of its letters."""
_FAR: Final = (0.0, 0.9, 1.6, 2.4)
"""Distances tried, in line heights."""
_TRIED: Final = 8
"""Directions tried at each distance."""


@dataclass(frozen=True)
class PlanStyle:
    """What a plan shows."""

    fills: bool = True
    """Whether to fill rooms and furniture with colours; otherwise furniture is outlined in grey."""
    room_names: bool = True
    object_names: bool = True
    room_size: float = 9.0
    """Font size of room names, in points."""


def draw_plan(
    axes: Axes,
    plan: HousePlan,
    style: PlanStyle | None = None,
    clear: BaseGeometry | None = None,
) -> None:
    """Draw a house from above.

    Args:
        axes: Set to the house's extent with equal scales, without ticks and frame.
        plan: The house; see `house_plan`.
        style: What to draw; None means everything.
        clear: Area in metres that names of rooms avoid if possible.
    """
    style = style or PlanStyle()
    low, high = plan.extent
    axes.set_xlim(low[0] - MARGIN, high[0] + MARGIN)
    axes.set_ylim(low[1] - MARGIN, high[1] + MARGIN)
    axes.set_aspect("equal")
    axes.set_axis_off()
    for room in plan.house.rooms:
        tint = ROOM_TINTS[room.type] if style.fills else "#fbfbfa"
        axes.add_patch(PolygonPatch(room.polygon, facecolor=tint, edgecolor="none", zorder=0))
    _draw_objects(axes, plan, filled=style.fills)
    _draw_walls(axes, plan)
    labels = LabelLayout(axes)
    if style.room_names:
        _name_rooms(labels, plan, style.room_size, clear)
    if style.object_names:
        _name_objects(labels, plan)


def draw_grid(axes: Axes, grid: Grid) -> None:
    """Mark where the agent can stand and which tiles are connected."""
    pairs = [
        (grid.points[tile], grid.points[other])
        for tile in range(grid.tiles)
        for other in grid.neighbours[tile]
        if other > tile
    ]
    lines = LineCollection(pairs, colors=INK, linewidths=0.5, alpha=0.35, zorder=5)
    axes.add_collection(lines)
    axes.scatter(*grid.points.T, s=5, color=INK, alpha=0.6, linewidths=0, zorder=6)


def _draw_walls(axes: Axes, plan: HousePlan) -> None:
    solid, panes, leaves = [], [], []
    for corners, kind in plan.walls:
        middle = (corners[:2] + corners[:1:-1]) / 2
        if kind is None:
            solid.append(PolygonPatch(corners))
        elif kind is OpeningKind.WINDOW:
            panes.append(middle)
        elif kind is OpeningKind.CLOSED_DOOR:
            leaves.append(middle)
    axes.add_collection(
        PatchCollection(solid, facecolor=WALL, edgecolor=WALL, linewidth=0.8, zorder=4)
    )
    axes.add_collection(LineCollection(panes, colors=GLAZING, linewidths=2.5, zorder=4))
    axes.add_collection(LineCollection(leaves, colors=LEAF, linewidths=2.5, zorder=4))


def _draw_objects(axes: Axes, plan: HousePlan, *, filled: bool) -> None:
    edge = INK if filled else "#a8a8a8"
    tints = {name: hex_color(light(color)) for name, color in named_class_colors().items()}
    objects = zip(plan.house.objects, plan.footprints, strict=True)
    paths, fills, edges, widths = [], [], [], []
    # Things are drawn after what they stand on or hang over.
    for thing, corners in sorted(objects, key=_height):
        alpha = 0.55 if thing.label == "rug" else 1.0
        # A line just inside the front edge shows which way it faces.
        front = 0.86 * corners[2:] + 0.14 * corners[1::-1]
        paths += [Path([*corners, corners[0]], closed=True), Path(front)]
        fills += [to_rgba(tints[thing.label] if filled else "#ececec", alpha), (0, 0, 0, 0)]
        edges += [to_rgba(edge, alpha), to_rgba(edge)]
        widths += [0.6, 1.1]
    # One collection: an artist per thing and line takes several times as long.
    axes.add_collection(
        PathCollection(
            paths,
            facecolors=fills,
            edgecolors=edges,
            linewidths=widths,
            zorder=2,
            capstyle="butt",
            joinstyle="miter",
        )
    )


def _height(placed: tuple[PlacedObject, NDArray[np.float64]]) -> tuple[float, bool]:
    thing, _ = placed
    return thing.base, thing.support is not None


def _name_rooms(
    labels: LabelLayout, plan: HousePlan, size: float, clear: BaseGeometry | None
) -> None:
    halo = [Halo(size / 3)]
    objects = tuple(zip(plan.house.objects, plan.footprints, strict=True))
    for room in plan.house.rooms:
        inside = shapely.Polygon(room.polygon)
        furniture = [
            shapely.Polygon(corners)
            for thing, corners in objects
            if thing.room == room.id and thing.support is None and thing.label != "rug"
        ]
        free = inside.buffer(-0.3).difference(shapely.union_all(furniture))
        options: list[Any] = [free, inside]
        if clear is not None:
            options = [free.difference(clear), inside.difference(clear), *options]
        within = next(option for option in options if option.area > _ROOM_FOR_A_NAME)
        spot = shapely.maximum_inscribed_circle(within)
        x, y = spot.coords[0]
        labels.place(
            room.type.value, (x, y), size=size, weight="bold", color=INK, effects=halo, force=True
        )


def _name_objects(labels: LabelLayout, plan: HousePlan) -> None:
    halo = [Halo(2)]
    tasks = set(task_objects())
    objects = zip(plan.house.objects, plan.footprints, strict=True)
    # Task objects first, since commands name them; then by footprint, largest first.
    order = sorted(
        ((thing, corners) for thing, corners in objects if thing.label != UNNAMED),
        key=lambda placed: (placed[0].label not in tasks, -placed[0].size[0] * placed[0].size[1]),
    )
    for thing, corners in order:
        movable = thing.label in tasks
        labels.place(
            thing.label.replace("_", " "),
            thing.position[:2],
            size=6.5 if movable else 5.8,
            weight="bold" if movable else "normal",
            color="#8a1c5a" if movable else INK,
            effects=halo,
            force=movable,
            turn=_upright(corners),
        )


def _upright(corners: NDArray[np.float64]) -> bool:
    """Whether a footprint is so much taller than wide that its name should be upright."""
    width, height = corners.max(axis=0) - corners.min(axis=0)
    return bool(height > 1.8 * width and width < 0.8 and not math.isclose(height, 0))


class LabelLayout:
    """Places non-overlapping names on axes whose limits and size are final."""

    def __init__(self, axes: Axes) -> None:
        """Start with nothing placed."""
        self._axes = axes
        self._boxes: list[tuple[float, float, float, float]] = []
        west, east = axes.get_xlim()
        south, north = axes.get_ylim()
        # Equal axes shrink to the tighter of the two.
        pixels = min(axes.bbox.width / (east - west), axes.bbox.height / (north - south))
        figure = axes.get_figure(root=True)
        assert figure is not None
        self._scale = pixels / figure.dpi
        """Inches per metre."""

    def place(
        self,
        text: str,
        at: Sequence[float],
        *,
        size: float,
        color: str,
        weight: str = "normal",
        effects: Sequence[AbstractPathEffect] = (),
        force: bool = False,
        turn: bool = False,
    ) -> bool:
        """Write a name at the first free spot near `at`, with a line to it if it had to move.

        Args:
            text: The name.
            at: (x, y) in metres of the named thing.
            size: Font size in points.
            color: Font colour.
            weight: `"normal"` or `"bold"`.
            effects: Path effects such as a halo.
            force: Whether to write it at `at` if no spot is free; otherwise it is left out.
            turn: Whether to also try it upright.

        Returns:
            Whether it was written.
        """
        unit = size * _POINT / self._scale
        wide, high = len(text) * _WIDTH[weight] * unit, _LINE * unit
        at = self._inside(at, wide / 2) if force else (at[0], at[1])
        for turned in (True, False) if turn else (False,):
            half = (high / 2, wide / 2) if turned else (wide / 2, high / 2)
            spots = self._spots(at, half, high) if not turned else [(at[0], at[1])]
            for spot in spots:
                if self._free(spot, half):
                    style = {"size": size, "color": color, "weight": weight, "turned": turned}
                    self._write(text, at, spot, half, effects, style)
                    return True
        if force:
            style = {"size": size, "color": color, "weight": weight, "turned": False}
            self._write(text, at, (at[0], at[1]), (wide / 2, high / 2), effects, style)
        return force

    def _inside(self, at: Sequence[float], half: float) -> tuple[float, float]:
        """The point nearest to `at` where a name of half-width `half` stays inside the axes."""
        west, east = self._axes.get_xlim()
        return float(np.clip(at[0], west + half, max(east - half, west + half))), at[1]

    def _spots(
        self, at: Sequence[float], half: tuple[float, float], line: float
    ) -> list[tuple[float, float]]:
        """Candidate spots of a name, nearest first."""
        spots = [(at[0], at[1])]
        for far in _FAR[1:]:
            for turn in np.arange(_TRIED) * 2 * np.pi / _TRIED + np.pi / 2:
                east = np.cos(turn) * (half[0] + far * line * 0.5)
                spots.append((at[0] + east, at[1] + np.sin(turn) * far * line))
        return spots

    def _free(self, spot: tuple[float, float], half: tuple[float, float]) -> bool:
        west, east = self._axes.get_xlim()
        south, north = self._axes.get_ylim()
        x0, x1 = spot[0] - half[0], spot[0] + half[0]
        y0, y1 = spot[1] - half[1], spot[1] + half[1]
        if x0 < west or x1 > east or y0 < south or y1 > north:
            return False
        return not any(
            x0 < right and left < x1 and y0 < top and bottom < y1
            for left, bottom, right, top in self._boxes
        )

    def _write(
        self,
        text: str,
        at: Sequence[float],
        spot: tuple[float, float],
        half: tuple[float, float],
        effects: Sequence[AbstractPathEffect],
        style: dict[str, Any],
    ) -> None:
        x, y = spot
        self._boxes.append((x - half[0], y - half[1], x + half[0], y + half[1]))
        if (x, y) != (at[0], at[1]):
            line = {"color": style["color"], "linewidth": 0.5, "zorder": 8}
            self._axes.plot([at[0], x], [at[1], y], **line)
        self._axes.text(
            x,
            y,
            text,
            fontsize=style["size"],
            color=style["color"],
            weight=style["weight"],
            rotation=90 if style["turned"] else 0,
            ha="center",
            va="center",
            path_effects=list(effects),
            zorder=9,
            clip_on=True,
        )
