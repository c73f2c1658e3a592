"""The maps of an episode on one sheet, for a viewer that draws the agent over them.

A row (or, where the object has one place only, a column) for each map, a panel for each place of
the object, as in the paper's appendix. A sheet knows where each panel lies, in pixels.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from lcrl_bench.houses.house import House
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import TileMap, layer_titles
from lcrl_bench.recording.palette import INK
from lcrl_bench.recording.plan import MARGIN, PlanStyle, extent
from lcrl_bench.recording.reward_plan import draw_map, draw_marks, legend_handles

DOTS_PER_INCH: Final = 144
POINT: Final = DOTS_PER_INCH / 72
"""Pixels of a typographic point."""
_NAME: Final = 0.26
"""Inches of the line with the name and the scale of a map."""
_TITLE: Final = 0.19
"""Inches of the line that says where the object is."""
_LEGEND: Final = 0.3
"""Inches of the line that says what the marks mean."""
_GAP: Final = 0.12
"""Inches between panels."""
_BAR: Final = 0.9
"""Inches of a scale, where there is room."""
_LETTER: Final = 0.067
"""Inches of a letter."""
_PLAN: Final = PlanStyle(fills=False, object_names=False, room_size=6.5)


@dataclass(frozen=True, eq=False)
class Panel:
    """One layer of a map on a sheet."""

    tile_map: TileMap
    layer: int
    title: str
    """Where the object is; empty where the map has one layer."""
    corner: tuple[float, float]
    """Pixel of the north-west corner of the plan, with its margin."""
    scale: float
    """Pixels a metre."""
    origin: tuple[float, float]
    """Metres: what lies at `corner`."""

    def shows(self, object_state: int) -> bool:
        """Whether the agent is on this panel while the object is in a state."""
        return len(self.tile_map.layers) == 1 or self.layer == object_state

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Metres to pixels of the sheet: [point, 2] to [point, 2]."""
        return self.corner + (points - self.origin) * (self.scale, -self.scale)

    def texts(self) -> list[str]:
        """What is to be said of each tile."""
        place = f", {self.title}" if self.title else ""
        numbers = self.tile_map.layers[self.layer]
        return [
            f"tile {tile}\n{self.tile_map.name}{place}: {number:.3f}"
            for tile, number in enumerate(numbers)
        ]


@dataclass(frozen=True, eq=False)
class Sheet:
    """A drawn sheet."""

    png: bytes
    panels: tuple[Panel, ...]


def draw_sheet(
    episode: Episode,
    maps: Sequence[TileMap],
    inches: tuple[float, float],
    *,
    legend: bool = False,
) -> Sheet:
    """Draw maps with the marks of the task and their scales, without the agent and its way.

    Args:
        episode: Gives the house and the task.
        maps: At least one; all have as many layers.
        inches: Width and height of the sheet, with the maps in its middle.
        legend: Whether it says what the marks mean.
    """
    house, layers = episode.scene.house, len(maps[0].layers)
    shape = _Shape.of(house, len(maps), layers, inches, legend=legend)
    figure = Figure(figsize=shape.inches, dpi=DOTS_PER_INCH)
    titles = layer_titles(episode) if layers > 1 else ("",)
    panels = []
    for number, tile_map in enumerate(maps):
        west, top = shape.group(number)
        _draw_name(figure, shape, tile_map, (west, top))
        for layer, title in enumerate(titles):
            left, upper = west + layer * (shape.wide + _GAP), top + shape.head
            axes = figure.add_axes(shape.fractions(left, upper, shape.wide, shape.high))
            draw_map(axes, episode, tile_map, layer, _PLAN)
            draw_marks(axes, episode, layer if layers > 1 else None)
            if title:
                _write(figure, shape, (left + shape.wide / 2, upper - _TITLE / 2), title, "center")
            (x0, _), (_, y1) = extent(house)
            panels.append(
                Panel(
                    tile_map,
                    layer,
                    title,
                    (left * DOTS_PER_INCH, upper * DOTS_PER_INCH),
                    shape.scale * DOTS_PER_INCH,
                    (x0 - MARGIN, y1 + MARGIN),
                )
            )
    if legend:
        figure.legend(
            handles=legend_handles(episode, agent=False),
            loc="lower center",
            ncols=4,
            fontsize=7.5,
            frameon=False,
            borderpad=0.2,
        )
    return Sheet(_png(figure), tuple(panels))


@dataclass(frozen=True)
class _Shape:
    """Where things lie on a sheet: inches from its north-west corner."""

    inches: tuple[float, float]
    """Width and height of the sheet."""
    corner: tuple[float, float]
    """Where the maps begin: they are in the middle."""
    wide: float
    """Of a panel."""
    high: float
    scale: float
    """Inches a metre."""
    head: float
    """Between the top of a map and its panels."""
    layers: int

    @staticmethod
    def of(
        house: House, maps: int, layers: int, inches: tuple[float, float], *, legend: bool
    ) -> _Shape:
        (x0, y0), (x1, y1) = extent(house)
        wide, high = x1 - x0 + 2 * MARGIN, y1 - y0 + 2 * MARGIN
        # One layer: the maps stand side by side; several: one above the other.
        columns, rows = (layers, maps) if layers > 1 else (maps, 1)
        head = _NAME + (_TITLE if layers > 1 else 0.0)
        around = (columns + 1) * _GAP, rows * head + (_LEGEND if legend else _GAP)
        scale = min(
            (inches[0] - around[0]) / (columns * wide), (inches[1] - around[1]) / (rows * high)
        )
        whole = columns * wide * scale + around[0], rows * high * scale + around[1]
        corner = (inches[0] - whole[0]) / 2 + _GAP, (inches[1] - whole[1]) / 2
        return _Shape(inches, corner, wide * scale, high * scale, scale, head, layers)

    @property
    def group_width(self) -> float:
        """Of all panels of a map."""
        return self.layers * (self.wide + _GAP) - _GAP

    def group(self, number: int) -> tuple[float, float]:
        """The north-west corner of a map, above its name."""
        west, top = self.corner
        if self.layers > 1:
            return west, top + number * (self.head + self.high)
        return west + number * (self.wide + _GAP), top

    def fractions(
        self, west: float, top: float, wide: float, high: float
    ) -> tuple[float, float, float, float]:
        """A rectangle as matplotlib wants it."""
        width, height = self.inches
        return west / width, 1 - (top + high) / height, wide / width, high / height


def _draw_name(
    figure: Figure, shape: _Shape, tile_map: TileMap, corner: tuple[float, float]
) -> None:
    """The name of a map on the left, its scale on the right."""
    west, top = corner
    line, east = top + _NAME / 2, west + shape.group_width
    _write(figure, shape, (west + 0.04, line), tile_map.name, "left", weight="bold")
    low, high = (f"{number:.3g}" for number in tile_map.limits)
    _write(figure, shape, (east - 0.04, line), high, "right")
    right = east - 0.1 - _LETTER * len(high)
    taken = _LETTER * (len(tile_map.name) + len(low) + len(high)) + 0.35
    wide = float(np.clip(shape.group_width - taken, 0.1, _BAR))
    bar = figure.add_axes(shape.fractions(right - wide, top + 0.3 * _NAME, wide, 0.4 * _NAME))
    bar.imshow(tile_map.ramp(64)[None], aspect="auto")
    bar.set_axis_off()
    _write(figure, shape, (right - wide - 0.06, line), low, "right")


def _write(
    figure: Figure,
    shape: _Shape,
    at: tuple[float, float],
    text: str,
    side: str,
    weight: str = "normal",
) -> None:
    width, height = shape.inches
    x, y = at[0] / width, 1 - at[1] / height
    figure.text(x, y, text, fontsize=8, weight=weight, color=INK, ha=side, va="center_baseline")


def _png(figure: Figure) -> bytes:
    drawn, file = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png", facecolor="white")
    # A palette is enough for a map, at a third of the bytes.
    picture = Image.open(drawn).convert("RGB").quantize(256, kmeans=1)
    picture.save(file, format="PNG", optimize=True)
    return file.getvalue()
