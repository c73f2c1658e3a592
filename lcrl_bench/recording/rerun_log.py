"""Episodes as a Rerun recording that opens ready to look at.

Only the modules `rerun_*` know Rerun; none is imported until something is recorded.

One recording holds one or several episodes. On the timeline `step` they follow each other, each
beginning at a round number; each has a timeline of its own beside it (`episode_1`, ...), on which
it runs from 0 and nothing else is shown. A recording is a view: the record is the episode's `.npz`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.houses.house import RoomType
from lcrl_bench.recording.bird import heading_yaw, object_pose
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import (
    HEADING_NAMES,
    about,
    action_word,
    now,
    object_phrase,
    plain,
    room_name,
)
from lcrl_bench.recording.palette import (
    AGENT,
    BLACK,
    GOAL,
    PATH,
    TAKE,
    WHITE,
    Color,
)
from lcrl_bench.recording.rerun_layout import STEP, layout, timeline
from lcrl_bench.recording.rerun_scene import (
    PAINTED,
    PIXELS_A_METRE,
    lift,
    log_house,
    log_maps,
    log_marks,
    pixels,
    pose,
)
from lcrl_bench.recording.reward_plan import HEADING_STEP
from lcrl_bench.storage import atomic_path

APPLICATION: Final = "lcrl_bench"
CURVES: Final = (
    ("along/reward/learned", "learned", (67, 147, 195)),
    ("along/reward/true", "true", (170, 170, 170)),
    ("along/value/learned", "value", (67, 147, 195)),
    ("along/visits/here", "policy", (67, 147, 195)),
    ("along/expert_visits/here", "expert", (170, 170, 170)),
)
"""Path, name and colour of each curve."""
LANES: Final[dict[str, dict[str, Color]]] = {
    "action": {
        "forward": (86, 180, 233),
        "turn left": (0, 114, 178),
        "turn right": (0, 90, 140),
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


def record_episodes(path: Path, episodes: Sequence[Episode]) -> None:
    """Write episodes as one recording, `path`, atomically.

    Args:
        path: Ends in `.rrd`.
        episodes: At least one, in the order they are shown in.

    Raises:
        ValueError: If there is no episode.
    """
    if not episodes:
        raise ValueError("a recording needs at least one episode")
    first = episodes[0]
    name = f"{first.method}-{first.benchmark}-{first.fingerprint[:12]}-seed{first.seed}"
    title = f"{first.method} on {first.benchmark}, seed {first.seed}"
    batches = rr.ChunkBatcherConfig.NEVER()
    with atomic_path(path) as temporary, _strict():
        recording_id = f"{name}-{'+'.join(episode.task.id for episode in episodes)}"
        with rr.RecordingStream(
            APPLICATION, recording_id=recording_id, batcher_config=batches
        ) as rec:
            rec.set_log_time_enabled(False)
            rec.set_log_tick_enabled(False)
            rec.save(temporary, default_blueprint=layout(episodes))
            rec.send_recording_name(plain(title))
            _log_frame(rec)
            for clock, episode in zip(clocks(rec, episodes), episodes, strict=True):
                _log_episode(clock, episode)


@contextmanager
def _strict() -> Iterator[None]:
    """Rerun's mistakes are errors in here; otherwise it would warn and leave things out."""
    before = rr.strict_mode()
    rr.set_strict_mode(True)
    try:
        yield
    finally:
        rr.set_strict_mode(before)


@dataclass(frozen=True)
class Clock:
    """Where an episode lies on the timelines of a recording."""

    rec: rr.RecordingStream
    start: int
    """Its step 0 on `STEP`."""
    own: str | None
    """The timeline of its own; None where it is the only one."""
    place: str
    """Where it stands among the episodes, as a sentence; empty where it is the only one."""

    def at(self, step: int) -> None:
        """What is logged next happens at a step."""
        self.rec.set_time(STEP, sequence=self.start + step)
        if self.own is not None:
            self.rec.set_time(self.own, sequence=step)

    def columns(self, steps: int) -> list[rr.TimeColumn]:
        """The times of the steps 0 .. steps - 1."""
        times = [rr.TimeColumn(STEP, sequence=self.start + np.arange(steps))]
        if self.own is not None:
            times.append(rr.TimeColumn(self.own, sequence=np.arange(steps)))
        return times


def clocks(rec: rr.RecordingStream, episodes: Sequence[Episode]) -> list[Clock]:
    """One clock an episode; each begins at a multiple of ten, with a gap before it."""
    starts = [0]
    for episode in episodes:
        starts.append(10 * -(-(starts[-1] + episode.horizon + 2) // 10))
    alone = len(episodes) == 1
    return [
        Clock(rec, start, None, "")
        if alone
        else Clock(rec, start, timeline(number), _place(number, len(episodes)))
        for number, start in enumerate(starts[:-1], 1)
    ]


def _place(number: int, count: int) -> str:
    names = [timeline(other) for other in range(1, count + 1) if other != number]
    others = f"{', '.join(names)}, or {STEP} for all in a row"
    return f"Episode {number} of {count}; choose {others} in the menu of timelines below."


def _log_frame(rec: rr.RecordingStream) -> None:
    """What holds for every episode: axes, names and colours of classes, styles of curves."""
    rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    classes = [(entry.id, entry.words, entry.color) for entry in semantic_classes()]
    rec.log("views", rr.AnnotationContext(classes), static=True)
    for path, name, color in CURVES:
        rec.log(path, rr.SeriesLines(colors=color, names=name, widths=2), static=True)
    for lane, colors in LANES.items():
        shown = rr.StateConfiguration(
            values=[str(state) for state in colors], colors=list(colors.values())
        )
        rec.log(["happens", lane], shown, static=True)


def _log_episode(clock: Clock, episode: Episode) -> None:
    rec = clock.rec
    if clock.start:
        # Another house: nothing of the one before may stay, on the timeline they share.
        rec.reset_time()
        rec.set_time(STEP, sequence=clock.start - 1)
        for root in ("world", "map", "views", "along", "policy", "happens", "now", "about"):
            rec.log(root, rr.Clear(recursive=True))
        rec.reset_time()
    clock.at(0)
    rec.log("about", _markdown(about(episode, clock.place)))
    log_house(rec, episode)
    log_marks(rec, episode)
    for step in range(episode.horizon + 1):
        clock.at(step)
        _log_step(rec, episode, step)
    _log_numbers(clock, episode)
    rec.reset_time()


def _log_step(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    grid, heading = episode.compiled.grid, int(episode.headings[step])
    place = grid.points[episode.tiles[step]]
    rec.log("world/agent", pose(np.array([*place, 0.0]), heading_yaw(episode, step)))
    if episode.task.moved is not None:
        rec.log("world/object", pose(*object_pose(episode, step)))
    layer = int(episode.object_states[step])
    if step == 0 or layer != episode.object_states[step - 1]:
        log_maps(rec, episode, layer)
    way = grid.points[episode.tiles[: step + 1]]
    rec.log("world/path", rr.LineStrips3D([lift(way, PAINTED + 0.02)], colors=PATH, radii=0.03))
    over = pixels(episode, way)
    casing = rr.LineStrips2D(
        [over, over],
        colors=[WHITE, PATH],
        radii=[PIXELS_A_METRE * 0.07, PIXELS_A_METRE * 0.035],
        draw_order=20,
    )
    rec.log("map/over/path", casing)
    arrow = np.array(HEADING_STEP[heading]) * (1, -1) * PIXELS_A_METRE * 0.42
    rec.log(
        "map/over/agent",
        rr.Points2D(over[-1:], colors=[AGENT], radii=PIXELS_A_METRE * 0.2, draw_order=30),
    )
    rec.log(
        "map/over/heading",
        rr.Arrows2D(
            origins=over[-1:],
            vectors=[arrow],
            colors=[BLACK],
            radii=PIXELS_A_METRE * 0.05,
            draw_order=31,
        ),
    )
    panorama = episode.panorama(int(episode.cells[step]))
    for number, (name, view) in enumerate(zip(HEADING_NAMES, panorama, strict=True)):
        rec.log(f"views/{name}", rr.SegmentationImage(view))
        if step == 0 or heading != episode.headings[step - 1]:
            facing = _frame(view) if number == heading else rr.Clear(recursive=False)
            rec.log(f"views/{name}/facing", facing)
    rec.log("now", _markdown(now(episode, step)))
    if step < episode.horizon:
        rec.log("policy/actions", rr.BarChart(episode.action_probabilities[step]))
    _log_happenings(rec, episode, step)


def _frame(view: NDArray[np.uint8]) -> rr.LineStrips2D:
    """A frame round the view the agent faces."""
    rows, columns = view.shape
    corners = [(0, 0), (columns, 0), (columns, rows), (0, rows), (0, 0)]
    return rr.LineStrips2D([corners], colors=AGENT, radii=0.4)


def _log_happenings(rec: rr.RecordingStream, episode: Episode, step: int) -> None:
    """Lanes of a timeline, each logged where it changes."""
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


def _markdown(text: str) -> rr.TextDocument:
    return rr.TextDocument(plain(text), media_type=rr.MediaType.MARKDOWN)


def _log_numbers(clock: Clock, episode: Episode) -> None:
    """Curves along the way, every step exact."""
    times = clock.columns(episode.horizon + 1)
    curves = {"along/reward/true": episode.true_reward[episode.cells]}
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
        clock.rec.send_columns(path, indexes=times, columns=rr.Scalars.columns(scalars=numbers))
