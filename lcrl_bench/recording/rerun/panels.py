"""The panels beside house and maps: views, words, action probabilities, lanes and curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from scipy import ndimage

from lcrl_bench.houses.classes import class_id, semantic_classes
from lcrl_bench.houses.house import RoomType
from lcrl_bench.mdp.task_batch import ACTIONS, Action
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import ACTION_NAMES, HEADING_NAMES
from lcrl_bench.recording.palette import ACTION_COLORS, AGENT, GOAL, TAKE, WHITE, Color
from lcrl_bench.recording.storyboard import Storyboard

CURVES: Final = (
    ("along/reward/learned", "learned reward", (67, 147, 195)),
    ("along/reward/true", "true reward", (170, 170, 170)),
    ("along/value/learned", "value", (67, 147, 195)),
    ("along/visits/here", "visits", (67, 147, 195)),
    ("along/expert_visits/here", "expert's visits", (170, 170, 170)),
)
"""Path, name and colour of each curve."""
LANES: Final[dict[str, dict[str, Color]]] = {
    "action": {
        "forward": ACTION_COLORS[Action.FORWARD],
        "turn left": ACTION_COLORS[Action.LEFT],
        "turn right": ACTION_COLORS[Action.RIGHT],
        "forward (blocked)": (130, 130, 136),
        "stay": (96, 96, 102),
        "take": TAKE,
        "put": GOAL,
        "end": (60, 60, 66),
    },
    "object": {"at A": TAKE, "in hand": AGENT, "at B": GOAL},
    "goal": {"not yet": (96, 96, 102), "reached": GOAL},
    "room": {
        RoomType.BEDROOM: (92, 120, 186),
        RoomType.BATHROOM: (72, 160, 160),
        RoomType.KITCHEN: (205, 140, 60),
        RoomType.LIVING_ROOM: (110, 160, 80),
        RoomType.DINING_ROOM: (200, 100, 90),
        RoomType.OFFICE: (150, 110, 180),
        RoomType.HALLWAY: (140, 140, 136),
        RoomType.OTHER: (165, 158, 120),
    },
}
"""Lanes of the "what happens" timeline, and the colour of each state."""
SHORT: Final = {"turn left": "left", "turn right": "right", "forward (blocked)": "blocked"}
"""State → a label that fits the width of one step."""

CHANCES: Final = "policy"
"""Path of the action probabilities."""
WIDE: Final = 80
"""Columns of a bar for probability 1."""
ROW: Final = 20
"""Rows from one bar to the next."""
BACKGROUND: Final = (13, 13, 15)
"""Colour of the view: that of the viewer around it."""
_BAR: Final = 16
_TRACK: Final = (44, 44, 48)

UNNAMED: Final = ("void", "wall", "floor", "ceiling", "door_frame")
"""Classes that are nearly everywhere, and are not labelled."""
MOST: Final = 3
"""Labels per view."""
LEAST_PIXELS: Final = 9
"""Smallest region that gets a label."""
ROWS_APART: Final = 5.0
"""Rows between two labels, so that they do not overlap."""
LETTER: Final = 1.25
"""Columns per letter of a label."""
_VIEW_DROP, _BAR_DROP = 2.7, 6
"""Rows by which the viewer draws a label below its point, in a view and in the bars."""


@dataclass(frozen=True)
class Sighting:
    """A labelled thing in a view."""

    words: str
    """Its class."""
    pixels: int
    """Size of the largest connected region of the class."""
    row: float
    """Middle of the label; 0 is the upper edge of the view."""
    column: float


def log_styles(rec: rr.RecordingStream) -> None:
    """Log the names and colours of classes, curves and lanes, for all times."""
    classes = [(entry.id, entry.words, entry.color) for entry in semantic_classes()]
    rec.log("views", rr.AnnotationContext(classes), static=True)
    for path, name, color in CURVES:
        rec.log(path, rr.SeriesLines(colors=color, names=name, widths=2), static=True)
    for lane, colors in LANES.items():
        states = [str(state) for state in colors]
        shown = rr.StateConfiguration(
            values=states,
            labels=[SHORT.get(state, state) for state in states],
            colors=list(colors.values()),
        )
        rec.log(["happens", lane], shown, static=True)


def log_panels(rec: rr.RecordingStream, board: Storyboard, step: int) -> None:
    """Log what every panel but the curves shows from this step on."""
    episode, shown = board.episode, board.steps[step]
    _log_views(rec, episode, step)
    rec.log("now", rr.TextDocument(shown.now, media_type=rr.MediaType.MARKDOWN))
    if step < episode.horizon:
        _log_chances(rec, episode.action_probabilities[step])
    before = board.steps[step - 1].lanes if step else {}
    for lane, state in shown.lanes.items():
        if before.get(lane) != state:
            rec.log(["happens", lane], rr.StateChange(state=state))


def _log_views(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    """Log the four views with their labels, and frame the one ahead, where they have changed."""
    cell, heading = int(episode.cells[step]), int(episode.headings[step])
    moved = step == 0 or episode.panoramas[cell] != episode.panoramas[episode.cells[step - 1]]
    turned = step == 0 or heading != episode.headings[step - 1]
    for number, (name, view) in enumerate(zip(HEADING_NAMES, episode.seen[step], strict=True)):
        if moved:
            rec.log(f"views/{name}", rr.SegmentationImage(view))
            named = sightings(view)
            names = rr.Points2D(
                [(seen.column, seen.row - _VIEW_DROP) for seen in named],
                labels=[seen.words for seen in named],
                colors=WHITE,
                radii=0.0,
                show_labels=True,
                draw_order=10,
            )
            rec.log(f"views/{name}/names", names)
        if turned:
            rows, columns = view.shape
            corners = [(0, 0), (columns, 0), (columns, rows), (0, rows), (0, 0)]
            frame = rr.LineStrips2D([corners], colors=AGENT, radii=0.4)
            facing = frame if number == heading else rr.Clear(recursive=False)
            rec.log(f"views/{name}/facing", facing)


def sightings(view: NDArray[np.uint8]) -> list[Sighting]:
    """The largest regions in view, largest first, at most one per class.

    A label is centred on its region, moved only to stay inside the view. A region whose label would
    overlap that of a larger one is left out.

    Args:
        view: uint8 [row, column] class ids.

    Returns:
        At most `MOST`.
    """
    skipped = {class_id(name) for name in UNNAMED}
    found = [
        sighting
        for number in np.unique(view).tolist()
        if number not in skipped and (sighting := _largest(view, number)).pixels >= LEAST_PIXELS
    ]
    chosen: list[Sighting] = []
    for sighting in sorted(found, key=lambda each: (-each.pixels, each.words)):
        if all(abs(sighting.row - other.row) >= ROWS_APART for other in chosen):
            chosen.append(sighting)
    return chosen[:MOST]


def _largest(view: NDArray[np.uint8], number: int) -> Sighting:
    """The largest connected region of a class that is in view."""
    regions = np.zeros(view.shape, np.int64)
    ndimage.label(view == number, output=regions)
    sizes = np.bincount(regions.reshape(-1))
    sizes[0] = 0
    row, column = np.argwhere(regions == sizes.argmax()).mean(axis=0) + 0.5
    words, rows, columns = semantic_classes()[number].words, *view.shape
    half = LETTER * len(words) / 2
    return Sighting(
        words,
        int(sizes.max()),
        float(np.clip(row, ROWS_APART / 2, rows - ROWS_APART / 2)),
        float(np.clip(column, half, columns - half)) if 2 * half < columns else columns / 2,
    )


def _log_chances(rec: rr.RecordingStream, chances: NDArray[np.float64]) -> None:
    """Log the action probabilities, float64 [action], as labelled bars."""
    picture = np.empty((ACTIONS * ROW, WIDE, 3), np.uint8)
    picture[:] = BACKGROUND
    for action, chance in enumerate(chances):
        bar = picture[action * ROW : action * ROW + _BAR]
        bar[:] = _TRACK
        bar[:, : round(float(chance) * WIDE)] = ACTION_COLORS[action]
    rec.log(f"{CHANCES}/bars", rr.Image(picture))
    names = rr.Points2D(
        [(WIDE / 2, action * ROW + _BAR / 2 - _BAR_DROP) for action in range(ACTIONS)],
        labels=[f"{ACTION_NAMES[Action(a)]} {chances[a]:.2f}" for a in range(ACTIONS)],
        colors=(255, 255, 255),
        radii=0.0,
        show_labels=True,
        draw_order=10,
    )
    rec.log(f"{CHANCES}/names", names)


def log_curves(rec: rr.RecordingStream, episode: Episode, times: Sequence[rr.TimeColumn]) -> None:
    """Log reward and value at every step; of a learned policy its visits, and the expert's.

    There is no true reward where it is unknown what fulfils the command.
    """
    curves = {}
    if episode.goal_known:
        curves["along/reward/true"] = episode.true_reward[episode.cells]
    if episode.reward is not None and episode.value is not None:
        curves["along/reward/learned"] = episode.reward[episode.cells]
        curves["along/value/learned"] = episode.value[episode.states]
    else:
        for key, visits in (
            ("visits", episode.occupancy),
            ("expert_visits", episode.expert_occupancy),
        ):
            if visits is not None:
                curves[f"along/{key}/here"] = visits[episode.cells]
    for path, numbers in curves.items():
        rec.send_columns(path, indexes=times, columns=rr.Scalars.columns(scalars=numbers))
