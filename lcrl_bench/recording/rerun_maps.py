"""The maps of an episode in a recording: sheets with the agent over them, and the painted floor."""

from __future__ import annotations

from typing import Final

import numpy as np
import rerun as rr
import shapely
from numpy.typing import NDArray

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import (
    every_map,
    tile_centers,
    tile_maps,
    tile_shapes,
    whole_visits,
)
from lcrl_bench.recording.narration import plain
from lcrl_bench.recording.palette import AGENT, BLACK, PATH, SIGN, WHITE
from lcrl_bench.recording.reward_plan import HEADING_STEP, OPACITY
from lcrl_bench.recording.sheet import POINT, Panel, Sheet, draw_sheet

PAINTED: Final = 0.045
"""Metres above the floor of what is painted on it: over rugs."""
MAPS: Final = "map/meaning"
"""The sheet that explains an episode: its reward and value, before and after."""
VISITS: Final = "map/visits"
"""The sheet of where the policy and the expert go."""
SHEET_INCHES: Final = {MAPS: (8.6, 5.0), VISITS: (4.3, 2.3)}
"""A sheet is drawn as large as the layout shows it, so that its letters are legible there."""


def log_sheets(rec: rr.RecordingStream, episode: Episode) -> dict[str, Sheet]:
    """Draw and log the sheets of an episode, which stay while it lasts.

    Returns:
        Path → sheet, for `log_on_sheets`. A policy's maps are those of its visits already.
    """
    sheets = {MAPS: draw_sheet(episode, tile_maps(episode), SHEET_INCHES[MAPS], legend=True)}
    if episode.reward is not None:
        sheets[VISITS] = draw_sheet(episode, whole_visits(episode), SHEET_INCHES[VISITS])
    centers = tile_centers(episode.scene.grid)
    for path, sheet in sheets.items():
        rec.log(f"{path}/sheet", rr.EncodedImage(contents=sheet.png, media_type="image/png"))
        # Hovered over, a tile tells its number.
        tiles = rr.Points2D(
            np.concatenate([panel.pixels(centers) for panel in sheet.panels]),
            radii=0.3 * POINT,
            colors=np.concatenate([_paint(panel) for panel in sheet.panels]),
            labels=[plain(text) for panel in sheet.panels for text in panel.texts()],
            show_labels=False,
            draw_order=10,
        )
        rec.log(f"{path}/tiles", tiles)
    return sheets


def _paint(panel: Panel) -> NDArray[np.uint8]:
    """The colours of the middles of a panel's tiles on the sheet: dots of them do not show."""
    shades = panel.tile_map.colors(panel.layer) * OPACITY + 255 * (1 - OPACITY)
    for tiles in panel.tile_map.signs(panel.layer).values():
        shades[tiles] = SIGN
    return shades.round().astype(np.uint8)


def log_on_sheets(
    rec: rr.RecordingStream, episode: Episode, sheets: dict[str, Sheet], step: int
) -> None:
    """Log the agent and its way so far, on the panels of where the object is."""
    for path, sheet in sheets.items():
        state = int(episode.object_states[step])
        shown = [panel for panel in sheet.panels if panel.shows(state)]
        ways = [way for panel in sheet.panels for way in _ways(episode, panel, step)]
        # White around the way, under it.
        lines = rr.LineStrips2D(
            [*ways, *ways],
            colors=[WHITE] * len(ways) + [PATH] * len(ways),
            radii=[1.8 * POINT] * len(ways) + [0.9 * POINT] * len(ways),
            draw_order=20,
        )
        rec.log(f"{path}/way", lines)
        place = episode.scene.grid.points[episode.tiles[step : step + 1]]
        spots = np.concatenate([panel.pixels(place) for panel in shown])
        north_east = np.array(HEADING_STEP[int(episode.headings[step])])
        arrow = north_east * (1, -1) * shown[0].scale * 0.5
        # The yellow is as light as a pale tile: it needs an edge.
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


def _ways(episode: Episode, panel: Panel, step: int) -> list[NDArray[np.float64]]:
    """Where the agent has been on a panel until a step, a line for each stay: [point, 2] pixels.

    It takes and puts without leaving its place: its way goes on where it ended, on another panel.
    """
    here = [panel.shows(int(state)) for state in episode.object_states[: step + 1]]
    borders = np.flatnonzero(np.diff(here)) + 1
    points = panel.pixels(episode.scene.grid.points[episode.tiles[: step + 1]])
    stays = zip(np.split(points, borders), np.split(here, borders), strict=True)
    return [stay for stay, within in stays if within[0] and len(stay) > 1]


def paint_floor(rec: rr.RecordingStream, episode: Episode, layer: int) -> None:
    """Log the maps for one place of the object as tiles painted on the floor."""
    shapes = tile_shapes(episode.scene.house, episode.scene.grid)
    # A seam shows where one tile ends.
    inner = [shape.buffer(-0.02, join_style="mitre") for shape in shapes]
    parts = [shapely.get_parts(shapely.constrained_delaunay_triangles(shape)) for shape in inner]
    corners = [part.exterior.coords[:3] for triangles in parts for part in triangles]
    flat = np.array(corners, np.float64).reshape(-1, 2)
    vertices = [3 * len(triangles) for triangles in parts]
    for tile_map in every_map(episode):
        tiles = rr.Mesh3D(
            vertex_positions=lift(flat, PAINTED),
            triangle_indices=np.arange(len(flat)).reshape(-1, 3),
            vertex_colors=np.repeat(tile_map.colors(layer), vertices, axis=0),
        )
        rec.log(["world", "tiles", tile_map.key], tiles)


def lift(points: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Points of the floor, [point, 2] metres, at a height: [point, 3]."""
    return np.column_stack([points, np.full(len(points), height)])
