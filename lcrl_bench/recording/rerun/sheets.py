"""Map sheets of a recording: an episode's maps as one picture, the agent drawn over them.

Each map has one panel per place of the object, as in the paper's appendix. Where the object has
several places, a map is a row of panels; otherwise the maps stand side by side. A sheet knows where
each panel lies in pixels, so that the viewer can draw the agent and its path on top.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import rerun as rr
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from lcrl_bench.houses.house import Point
from lcrl_bench.recording.maps import TileMap
from lcrl_bench.recording.palette import AGENT, BLACK, INK, PATH, SIGN, WHITE
from lcrl_bench.recording.plan import MARGIN, PlanStyle
from lcrl_bench.recording.reward_plan import (
    HEADING_STEP,
    OPACITY,
    draw_map,
    legend_handles,
)
from lcrl_bench.recording.storyboard import Storyboard

MAPS: Final = "map/meaning"
"""Path of the sheet that explains an episode: its reward and value, before and after."""
VISITS: Final = "map/visits"
"""Path of the sheet that shows where the policy and the expert go."""
SHEET_INCHES: Final = {MAPS: (8.6, 5.0), VISITS: (4.3, 2.3)}
"""Size of each sheet: that of its view in the layout, so that letters stay legible."""
DOTS_PER_INCH: Final = 144
POINT: Final = DOTS_PER_INCH / 72
"""Pixels per typographic point."""
_NAME: Final = 0.26
"""Inches of the line with a map's name and scale."""
_TITLE: Final = 0.19
"""Inches of the line that says where the object is."""
_LEGEND: Final = 0.3
"""Inches of the legend."""
_GAP: Final = 0.12
"""Inches between panels."""
_BAR: Final = 0.9
"""Inches of a scale, space permitting."""
_LETTER: Final = 0.067
"""Inches per letter."""
_PLAN: Final = PlanStyle(fills=False, object_names=False, room_size=6.5)


@dataclass(frozen=True, eq=False)
class Panel:
    """One layer of a map on a sheet."""

    tile_map: TileMap
    layer: int
    corner: tuple[float, float]
    """Pixel of the north-west corner of the plan, with its margin."""
    scale: float
    """Pixels per metre."""
    origin: tuple[float, float]
    """The point in metres that lies at `corner`."""

    def shows(self, object_state: int) -> bool:
        """Whether the agent is drawn on this panel while the object is in a state."""
        return len(self.tile_map.layers) == 1 or self.layer == object_state

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert metres to pixels of the sheet: [point, 2] to [point, 2]."""
        return self.corner + (points - self.origin) * (self.scale, -self.scale)

    def texts(self) -> list[str]:
        """The hover text of each tile."""
        title, numbers = self.tile_map.captions[self.layer], self.tile_map.layers[self.layer]
        return [f"tile {tile}\n{title}: {number:.3f}" for tile, number in enumerate(numbers)]


@dataclass(frozen=True, eq=False)
class Sheet:
    """A drawn sheet."""

    png: bytes
    panels: tuple[Panel, ...]


def draw_sheets(board: Storyboard) -> dict[str, Sheet]:
    """Draw the sheets of an episode.

    Returns:
        Path → sheet. A policy has one: its maps are its visits.
    """
    sheets = {MAPS: draw_sheet(board, board.maps, SHEET_INCHES[MAPS], legend=True)}
    if board.visits:
        sheets[VISITS] = draw_sheet(board, board.visits, SHEET_INCHES[VISITS])
    return sheets


def log_sheets(
    rec: rr.RecordingStream, board: Storyboard, sheets: dict[str, Sheet], step: int
) -> None:
    """Log the sheets at the first step; then the agent and its path on each."""
    for path, sheet in sheets.items():
        if step == 0:
            _log_still(rec, path, sheet, board.floor.centers)
        _log_agent(rec, path, sheet, board, step)


def _log_still(
    rec: rr.RecordingStream, path: str, sheet: Sheet, centers: NDArray[np.float64]
) -> None:
    rec.log(f"{path}/sheet", rr.EncodedImage(contents=sheet.png, media_type="image/png"))
    # Hovering over a tile shows its number.
    tiles = rr.Points2D(
        np.concatenate([panel.pixels(centers) for panel in sheet.panels]),
        radii=0.3 * POINT,
        colors=np.concatenate([_paint(panel) for panel in sheet.panels]),
        labels=[text for panel in sheet.panels for text in panel.texts()],
        show_labels=False,
        draw_order=10,
    )
    rec.log(f"{path}/tiles", tiles)


def _paint(panel: Panel) -> NDArray[np.uint8]:
    """The colours of a panel's tile centres as drawn, so that dots there stay invisible."""
    shades = panel.tile_map.colors[panel.layer] * OPACITY + 255 * (1 - OPACITY)
    for tiles in panel.tile_map.signs.values():
        shades[tiles[panel.layer]] = SIGN
    return shades.round().astype(np.uint8)


def _log_agent(
    rec: rr.RecordingStream, path: str, sheet: Sheet, board: Storyboard, step: int
) -> None:
    """Log the agent and its path so far, on the panels of where the object is."""
    states, points = board.episode.object_states[: step + 1], board.points[: step + 1]
    shown = [panel for panel in sheet.panels if panel.shows(int(states[-1]))]
    ways = [way for panel in sheet.panels for way in _ways(panel, states, points)]
    # A white outline, under the path.
    lines = rr.LineStrips2D(
        [*ways, *ways],
        colors=[WHITE] * len(ways) + [PATH] * len(ways),
        radii=[1.8 * POINT] * len(ways) + [0.9 * POINT] * len(ways),
        draw_order=20,
    )
    rec.log(f"{path}/way", lines)
    spots = np.concatenate([panel.pixels(points[-1:]) for panel in shown])
    north_east = np.array(HEADING_STEP[int(board.episode.headings[step])])
    arrow = north_east * (1, -1) * shown[0].scale * 0.5
    # The yellow is as light as a pale tile, so it needs an edge.
    rec.log(
        f"{path}/agent",
        rr.Points2D(
            [*spots, *spots],
            colors=[BLACK] * len(spots) + [AGENT] * len(spots),
            radii=[5.0 * POINT] * len(spots) + [4.0 * POINT] * len(spots),
            draw_order=30,
        ),
    )
    rec.log(
        f"{path}/heading",
        rr.Arrows2D(
            origins=spots,
            vectors=[arrow] * len(spots),
            colors=BLACK,
            radii=1.2 * POINT,
            draw_order=31,
        ),
    )


def _ways(
    panel: Panel, states: NDArray[np.int64], points: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """Where the agent has been on a panel, one line per stay: [point, 2] pixels.

    Taking and putting do not move the agent: its path continues there, on another panel.

    Args:
        panel: The panel.
        states: [step]: where the object was so far.
        points: [step, 2] metres: where the agent was.
    """
    here = [panel.shows(int(state)) for state in states]
    borders = np.flatnonzero(np.diff(here)) + 1
    stays = zip(np.split(panel.pixels(points), borders), np.split(here, borders), strict=True)
    return [stay for stay, within in stays if within[0] and len(stay) > 1]


def draw_sheet(
    board: Storyboard,
    maps: Sequence[TileMap],
    inches: tuple[float, float],
    *,
    legend: bool = False,
) -> Sheet:
    """Draw maps with the task's marks and their scales, without the agent and its path.

    Args:
        board: Gives the house and the task.
        maps: At least one; all with the same number of layers.
        inches: Width and height of the sheet; the maps are centred.
        legend: Whether to explain the marks.
    """
    (x0, _), (_, y1) = board.floor.plan.extent
    layers = len(maps[0].layers)
    shape = _Shape.of(board.floor.plan.extent, len(maps), layers, inches, legend=legend)
    figure = Figure(figsize=shape.inches, dpi=DOTS_PER_INCH)
    panels = []
    for number, tile_map in enumerate(maps):
        west, top = shape.group(number)
        _draw_name(figure, shape, tile_map, (west, top))
        for layer, title in enumerate(tile_map.titles):
            left, upper = west + layer * (shape.wide + _GAP), top + shape.head
            axes = figure.add_axes(shape.fractions(left, upper, shape.wide, shape.high))
            if title:
                _write(figure, shape, (left + shape.wide / 2, upper - _TITLE / 2), title, "center")
            draw_map(axes, board, tile_map, layer, style=_PLAN)
            panels.append(
                Panel(
                    tile_map,
                    layer,
                    (left * DOTS_PER_INCH, upper * DOTS_PER_INCH),
                    shape.scale * DOTS_PER_INCH,
                    (x0 - MARGIN, y1 + MARGIN),
                )
            )
    if legend:
        figure.legend(
            handles=legend_handles(board, agent=False),
            loc="lower center",
            ncols=4,
            fontsize=7.5,
            frameon=False,
            borderpad=0.2,
        )
    return Sheet(_png(figure), tuple(panels))


@dataclass(frozen=True)
class _Shape:
    """Layout of a sheet: inches from its north-west corner."""

    inches: tuple[float, float]
    """Width and height of the sheet."""
    corner: tuple[float, float]
    """North-west corner of the maps, which are centred."""
    wide: float
    """Width of a panel."""
    high: float
    scale: float
    """Inches per metre."""
    head: float
    """Between the top of a map and its panels."""
    layers: int

    @staticmethod
    def of(
        corners: tuple[Point, Point],
        maps: int,
        layers: int,
        inches: tuple[float, float],
        *,
        legend: bool,
    ) -> _Shape:
        (x0, y0), (x1, y1) = corners
        wide, high = x1 - x0 + 2 * MARGIN, y1 - y0 + 2 * MARGIN
        # One layer: the maps stand side by side. Several: one map above the other.
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
        """Width of all panels of a map."""
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
        """A rectangle as matplotlib expects it."""
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
    # A palette suffices for a map, at a third of the bytes.
    picture = Image.open(drawn).convert("RGB").quantize(256, kmeans=1)
    picture.save(file, format="PNG", optimize=True)
    return file.getvalue()
