"""What happens along the way in a recording: lanes of words, and curves of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import rerun as rr

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.houses.house import RoomType
from lcrl_bench.mdp.task_batch import Action
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import action_word, object_phrase, plain, room_name
from lcrl_bench.recording.palette import ACTION_COLORS, AGENT, GOAL, TAKE, Color

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
"""Lanes of the timeline of what happens, and the colour of each state."""
SHORT: Final = {"turn left": "left", "turn right": "right", "forward (blocked)": "blocked"}
"""Words short enough for a step's width."""


def log_styles(rec: rr.RecordingStream) -> None:
    """Log names and colours of curves and lanes, for all times."""
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


def log_happenings(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    """Log the lanes that change at a step."""
    lanes = {
        "room": [room_name(episode, at) for at in (step - 1, step)],
        "action": [action_word(episode, at) for at in (step - 1, step)],
    }
    if episode.goal_known:
        lanes["goal"] = ["reached" if episode.done[at] else "not yet" for at in (step - 1, step)]
    if episode.task.kind == Kind.PICK:
        lanes["object"] = [object_phrase(episode, at) for at in (step - 1, step)]
    for lane, (before, after) in lanes.items():
        if step == 0 or before != after:
            rec.log(["happens", lane], rr.StateChange(state=plain(after)))


def log_curves(rec: rr.RecordingStream, episode: Episode, times: Sequence[rr.TimeColumn]) -> None:
    """Log the numbers along the way, every step exact: those of a reward, or visits without one.

    Where it is open what fulfils the command, there is no true reward either.
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
