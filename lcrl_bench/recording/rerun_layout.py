"""The blueprint of a recording: which views it opens with, and where the eye stands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import rerun.blueprint as rrb

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import TileMap, every_map, tile_maps
from lcrl_bench.recording.narration import HEADING_NAMES
from lcrl_bench.recording.palette import WHITE, Color
from lcrl_bench.recording.plan import extent

STEP: Final = "step"
"""The timeline on which all episodes follow each other."""
STEPS_A_SECOND: Final = 3.0
PAPER: Final[Color] = (238, 238, 234)
"""Behind the house."""


def timeline(number: int) -> str:
    """The timeline of an episode among several, counted from 1."""
    return f"episode_{number}"


def layout(episodes: Sequence[Episode]) -> rrb.Blueprint:
    """The views a recording opens with: it plays at once, with no click.

    On the left the house over the four views of the panorama; on the right what is going on in
    words, maps, lanes and curves.
    """
    maps, every = tile_maps(episodes[0]), every_map(episodes[0])
    first = STEP if len(episodes) == 1 else timeline(1)
    left = rrb.Vertical(_house(episodes, every), _views(), row_shares=[3.5, 1])
    words = rrb.Horizontal(
        rrb.TextDocumentView(origin="now", name="now"),
        rrb.TextDocumentView(origin="about", name="about this episode"),
    )
    right = rrb.Vertical(
        words,
        _plans(maps, every[len(maps) :]),
        rrb.StateTimelineView(origin="happens", name="what happens"),
        _curves(maps),
        row_shares=[1.6, 2.9, 1.7, 1.2],
    )
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[1.1, 1]),
        rrb.TimePanel(state="collapsed", timeline=first, fps=STEPS_A_SECOND, play_state="playing"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
    )


def _house(episodes: Sequence[Episode], maps: Sequence[TileMap]) -> rrb.Spatial3DView:
    """The doll's house; of the maps on its floor the first is shown."""
    hidden = rrb.EntityBehavior(visible=False)
    return rrb.Spatial3DView(
        origin="world",
        name="house",
        background=PAPER,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=_eye(episodes),
        overrides={f"world/tiles/{tile_map.key}": hidden for tile_map in maps[1:]},
    )


def _eye(episodes: Sequence[Episode]) -> rrb.EyeControls3D:
    """An eye south of the houses and above, that has them all in view."""
    corners = np.array([extent(episode.compiled.house) for episode in episodes])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    middle, size = (low + high) / 2, high - low
    away = 0.58 * max(float(size[0]), float(size[1])) + 2.2
    east, north = middle + np.array([0.2, -0.8]) * away
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(east, north, 1.35 * away),
        look_target=(middle[0], middle[1] - 0.04 * size[1], 0.0),
        eye_up=(0, 0, 1),
    )


def _views() -> rrb.Horizontal:
    return rrb.Horizontal(
        *(rrb.Spatial2DView(origin=f"views/{name}", name=name) for name in HEADING_NAMES)
    )


def _plans(maps: Sequence[TileMap], more: Sequence[TileMap]) -> rrb.Container:
    """The maps that explain the episode, side by side; further ones on a tab behind them."""
    front = rrb.Horizontal(
        *(_plan(tile_map) for tile_map in maps),
        name=" and ".join(tile_map.name for tile_map in maps),
    )
    if not more:
        return front
    behind = rrb.Horizontal(*(_plan(tile_map) for tile_map in more), name="where it goes")
    return rrb.Tabs(front, behind, active_tab=0)


def _plan(tile_map: TileMap) -> rrb.Spatial2DView:
    return rrb.Spatial2DView(
        origin="map",
        contents=[f"/map/{tile_map.key}", "/map/over/**"],
        name=tile_map.name,
        background=WHITE,
    )


def _curves(maps: Sequence[TileMap]) -> rrb.Horizontal:
    corner = rrb.PlotLegend(rrb.Corner2D.LeftTop)
    return rrb.Horizontal(
        *(
            rrb.TimeSeriesView(
                origin=f"along/{tile_map.key}", name=tile_map.name, plot_legend=corner
            )
            for tile_map in maps
        ),
        rrb.BarChartView(
            origin="policy", name="policy: F L R I", plot_legend=rrb.PlotLegend(visible=False)
        ),
    )
