"""The blueprint of a recording: the views it opens with, and where the camera stands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import rerun.blueprint as rrb

from lcrl_bench.mdp.task_batch import ACTIONS
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.maps import every_map
from lcrl_bench.recording.narration import HEADING_NAMES
from lcrl_bench.recording.palette import WHITE, Color
from lcrl_bench.recording.plan import extent
from lcrl_bench.recording.rerun.panels import BACKGROUND, CHANCES, ROW, WIDE
from lcrl_bench.recording.rerun.sheets import DOTS_PER_INCH, MAPS, SHEET_INCHES, VISITS

STEP: Final = "step"
"""The timeline on which all episodes follow one another."""
STEPS_A_SECOND: Final = 3.0
PAPER: Final[Color] = (238, 238, 234)
"""Background of the house."""


def timeline(number: int) -> str:
    """The timeline of an episode among several, counted from 1."""
    return f"episode_{number}"


def layout(episodes: Sequence[Episode]) -> rrb.Blueprint:
    """The views a recording opens with; it starts playing at once.

    On the left: the house, the four views and what happens. On the right: words, maps before and
    after the object moves, where the agent goes, curves and action probabilities.
    """
    first = STEP if len(episodes) == 1 else timeline(1)
    rewarded = episodes[0].reward is not None
    left = rrb.Vertical(
        _house(episodes),
        _views(episodes[0]),
        rrb.StateTimelineView(origin="happens", name="what happens"),
        row_shares=[3.3, 1.1, 1.45],
    )
    words = rrb.Horizontal(
        rrb.TextDocumentView(origin="now", name="now"),
        rrb.TextDocumentView(origin="about", name="about this episode"),
    )
    name = "learned reward and value" if rewarded else "where it goes, and where the expert does"
    right = rrb.Vertical(words, _sheet(MAPS, name), _below(rewarded), row_shares=[1.5, 4.0, 1.75])
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[1, 1.12]),
        rrb.TimePanel(state="collapsed", timeline=first, fps=STEPS_A_SECOND, play_state="playing"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_views=False,
    )


def _house(episodes: Sequence[Episode]) -> rrb.Spatial3DView:
    """The doll's house; only the first of the maps on its floor is visible."""
    hidden = rrb.EntityBehavior(visible=False)
    maps = every_map(episodes[0])
    return rrb.Spatial3DView(
        origin="world",
        name="house",
        background=PAPER,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=_eye(episodes),
        overrides={f"world/tiles/{tile_map.key}": hidden for tile_map in maps[1:]},
    )


def _eye(episodes: Sequence[Episode]) -> rrb.EyeControls3D:
    """A camera above and south of the houses that sees all of them."""
    corners = np.array([extent(episode.scene.house) for episode in episodes])
    low, high = corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)
    middle, size = (low + high) / 2, high - low
    away = max(0.55 * float(size[0]), 0.62 * float(size[1])) + 2.0
    east, north = middle + np.array([0.2, -0.8]) * away
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=(east, north, 1.35 * away),
        look_target=(middle[0], middle[1] - 0.08 * size[1], 0.0),
        eye_up=(0, 0, 1),
    )


def _views(episode: Episode) -> rrb.Horizontal:
    rows, columns = episode.panorama(0).shape[1:]
    frame = _bounds(columns, rows)
    return rrb.Horizontal(
        *(
            rrb.Spatial2DView(origin=f"views/{name}", name=name, visual_bounds=frame)
            for name in HEADING_NAMES
        )
    )


def _sheet(path: str, name: str) -> rrb.Spatial2DView:
    columns, rows = (inches * DOTS_PER_INCH for inches in SHEET_INCHES[path])
    return rrb.Spatial2DView(
        origin=path, name=name, background=WHITE, visual_bounds=_bounds(columns, rows)
    )


def _bounds(columns: float, rows: float) -> rrb.VisualBounds2D:
    """The whole picture: otherwise the viewer shifts it whenever a label sticks out."""
    return rrb.VisualBounds2D(x_range=(0, columns), y_range=(0, rows))


def _below(rewarded: bool) -> rrb.Horizontal:
    """Where the agent goes beside where the expert goes, curves, and action probabilities."""
    curves = [_curve("along/reward", "reward")]
    curves += [_curve("along/value", "value")] if rewarded else [_curve("along", "visits")]
    chances = rrb.Spatial2DView(
        origin=CHANCES,
        name="policy",
        background=BACKGROUND,
        visual_bounds=_bounds(WIDE, ROW * ACTIONS),
    )
    numbers = rrb.Vertical(*curves)
    if not rewarded:
        return rrb.Horizontal(numbers, chances, column_shares=[2, 1])
    visits = _sheet(VISITS, "where it goes, and where the expert does")
    return rrb.Horizontal(visits, numbers, chances, column_shares=[2.0, 1.3, 0.9])


def _curve(origin: str, name: str) -> rrb.TimeSeriesView:
    """A curve named by its legend: a title would take half the space."""
    visits = ["/along/visits/**", "/along/expert_visits/**"] if name == "visits" else "$origin/**"
    return rrb.TimeSeriesView(
        origin=origin,
        contents=visits,
        name=name,
        titlebar=False,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.LeftTop),
    )
