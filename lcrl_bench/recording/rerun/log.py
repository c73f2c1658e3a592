"""Episodes as one Rerun recording that opens ready to watch, and the views it opens with.

A recording holds one or more episodes. On the timeline `step` they follow one another, each
starting at a multiple of ten. Each of several also has a timeline of its own (`episode_1`, ...), on
which it runs from 0 and nothing else is shown. A recording is only a view: the record of an episode
is its `.npz`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from lcrl_bench.mdp.task_batch import ACTIONS
from lcrl_bench.recording.narration import HEADING_NAMES
from lcrl_bench.recording.palette import WHITE, Color
from lcrl_bench.recording.rerun.house import log_house
from lcrl_bench.recording.rerun.panels import (
    BACKGROUND,
    CHANCES,
    ROW,
    WIDE,
    log_curves,
    log_panels,
    log_styles,
)
from lcrl_bench.recording.rerun.sheets import (
    DOTS_PER_INCH,
    MAPS,
    SHEET_INCHES,
    VISITS,
    draw_sheets,
    log_sheets,
)
from lcrl_bench.recording.storyboard import Storyboard
from lcrl_bench.storage import write_bytes

APPLICATION: Final = "lcrl_bench"
ROOTS: Final = ("world", "map", "views", "along", "policy", "happens", "now", "about")
"""Top-level paths that belong to an episode."""
STEP: Final = "step"
"""The timeline on which all episodes follow one another."""
STEPS_A_SECOND: Final = 3.0
PAPER: Final[Color] = (238, 238, 234)
"""Background of the house."""


def record_episodes(path: Path, boards: Sequence[Storyboard]) -> None:
    """Write episodes as one recording, `path`, atomically.

    Args:
        path: Ends in `.rrd`.
        boards: At least one, in the order they are shown.

    Raises:
        ValueError: If there is no episode.
    """
    write_bytes(path, recording_file(boards))


def recording_file(boards: Sequence[Storyboard]) -> bytes:
    """The content of a recording's file; arguments as for `record_episodes`."""
    if not boards:
        raise ValueError("a recording needs at least one episode")
    first = boards[0].episode
    name = f"{first.method}-{first.benchmark}-{first.fingerprint[:12]}-seed{first.seed}"
    tasks = "+".join(board.episode.task.id for board in boards)
    batches = rr.ChunkBatcherConfig.NEVER()
    with _strict():
        with rr.RecordingStream(
            APPLICATION, recording_id=f"{name}-{tasks}", batcher_config=batches
        ) as rec:
            rec.set_log_time_enabled(False)
            rec.set_log_tick_enabled(False)
            # Into memory: Rerun's own file writer hangs on a full disk.
            memory = rec.memory_recording()
            rec.send_blueprint(_layout(boards), make_active=False, make_default=True)
            rec.send_recording_name(boards[0].run)
            rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
            log_styles(rec)
            start = 0
            for number, board in enumerate(boards, 1):
                _log_episode(rec, board, start, number, len(boards))
                # The next multiple of ten, after a gap.
                start = 10 * -(-(start + board.episode.horizon + 2) // 10)
        return memory.drain_as_bytes()


@contextmanager
def _strict() -> Iterator[None]:
    """Make Rerun's mistakes errors inside the block; by default it warns and drops data."""
    before = rr.strict_mode()
    rr.set_strict_mode(True)
    try:
        yield
    finally:
        rr.set_strict_mode(before)


def _log_episode(
    rec: rr.RecordingStream, board: Storyboard, start: int, number: int, count: int
) -> None:
    """Log an episode.

    Args:
        rec: Where to.
        board: What to show.
        start: Its step 0 on `STEP`.
        number: Its position among the episodes, from 1.
        count: Number of episodes; each of several has a timeline of its own.
    """
    if start:
        # On the timeline they share, nothing of the previous episode may remain.
        rec.reset_time()
        rec.set_time(STEP, sequence=start - 1)
        for root in ROOTS:
            rec.log(root, rr.Clear(recursive=True))
        rec.reset_time()
    steps = np.arange(len(board.steps))
    times = {STEP: start + steps}
    about = board.about
    if count > 1:
        times[_timeline(number)] = steps
        others = "the other is" if count == 2 else "the others are"
        about = f"Episode {number} of {count}; {others} in the menu of timelines.\n\n{about}"
    sheets = draw_sheets(board)
    for step in range(len(steps)):
        for name, numbers in times.items():
            rec.set_time(name, sequence=int(numbers[step]))
        if step == 0:
            rec.log("about", rr.TextDocument(about, media_type=rr.MediaType.MARKDOWN))
        log_sheets(rec, board, sheets, step)
        log_house(rec, board, step)
        log_panels(rec, board, step)
    columns = [rr.TimeColumn(name, sequence=numbers) for name, numbers in times.items()]
    log_curves(rec, board.episode, columns)
    rec.reset_time()


def _timeline(number: int) -> str:
    """The timeline of an episode among several, counted from 1."""
    return f"episode_{number}"


def _layout(boards: Sequence[Storyboard]) -> rrb.Blueprint:
    """The views a recording opens with; it starts playing at once.

    On the left: the house, the four views and what happens. On the right: words, maps before and
    after the object moves, where the agent goes, curves and action probabilities.
    """
    first = STEP if len(boards) == 1 else _timeline(1)
    rewarded = boards[0].episode.reward is not None
    left = rrb.Vertical(
        _house(boards),
        _views(boards[0]),
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


def _house(boards: Sequence[Storyboard]) -> rrb.Spatial3DView:
    """The doll's house; only the first of the maps on its floor is visible."""
    hidden = rrb.EntityBehavior(visible=False)
    return rrb.Spatial3DView(
        origin="world",
        name="house",
        background=PAPER,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=_eye(boards),
        overrides={f"world/tiles/{tile_map.key}": hidden for tile_map in boards[0].painted[1:]},
    )


def _eye(boards: Sequence[Storyboard]) -> rrb.EyeControls3D:
    """A camera above and south of the houses that sees all of them."""
    corners = np.array([board.floor.plan.extent for board in boards])
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


def _views(board: Storyboard) -> rrb.Horizontal:
    rows, columns = board.episode.seen.shape[2:]
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
