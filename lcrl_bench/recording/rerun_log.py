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

from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.narration import about, now, plain
from lcrl_bench.recording.rerun_chances import log_chances
from lcrl_bench.recording.rerun_happenings import log_curves, log_happenings, log_styles
from lcrl_bench.recording.rerun_layout import STEP, layout, timeline
from lcrl_bench.recording.rerun_maps import log_on_sheets, log_sheets, paint_floor
from lcrl_bench.recording.rerun_scene import log_house, log_marks, log_moves
from lcrl_bench.recording.rerun_views import log_classes, log_views
from lcrl_bench.storage import write_bytes

APPLICATION: Final = "lcrl_bench"
ROOTS: Final = ("world", "map", "views", "along", "policy", "happens", "now", "about")
"""Of the paths that belong to an episode."""


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
    with _strict():
        recording_id = f"{name}-{'+'.join(episode.task.id for episode in episodes)}"
        with rr.RecordingStream(
            APPLICATION, recording_id=recording_id, batcher_config=batches
        ) as rec:
            rec.set_log_time_enabled(False)
            rec.set_log_tick_enabled(False)
            # Into memory: its own writer of files waits for ever where a disk is full.
            memory = rec.memory_recording()
            rec.send_blueprint(layout(episodes), make_active=False, make_default=True)
            rec.send_recording_name(plain(title))
            rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
            log_classes(rec)
            log_styles(rec)
            for clock, episode in zip(clocks(rec, episodes), episodes, strict=True):
                _log_episode(clock, episode)
        write_bytes(path, memory.drain_as_bytes())


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
    others = "the other is" if count == 2 else "the others are"
    return f"Episode {number} of {count}; {others} in the menu of timelines."


def _log_episode(clock: Clock, episode: Episode) -> None:
    rec = clock.rec
    if clock.start:
        # Another house: nothing of the one before may stay, on the timeline they share.
        rec.reset_time()
        rec.set_time(STEP, sequence=clock.start - 1)
        for root in ROOTS:
            rec.log(root, rr.Clear(recursive=True))
        rec.reset_time()
    clock.at(0)
    rec.log("about", _markdown(about(episode, clock.place)))
    log_house(rec, episode)
    log_marks(rec, episode)
    sheets = log_sheets(rec, episode)
    for step in range(episode.horizon + 1):
        clock.at(step)
        log_moves(rec, episode, step)
        if step == 0 or episode.object_states[step] != episode.object_states[step - 1]:
            paint_floor(rec, episode, int(episode.object_states[step]))
        log_on_sheets(rec, episode, sheets, step)
        log_views(rec, episode, step)
        rec.log("now", _markdown(now(episode, step)))
        if step < episode.horizon:
            log_chances(rec, episode.action_probabilities[step])
        log_happenings(rec, episode, step)
    log_curves(rec, episode, clock.columns(episode.horizon + 1))
    rec.reset_time()


def _markdown(text: str) -> rr.TextDocument:
    return rr.TextDocument(plain(text), media_type=rr.MediaType.MARKDOWN)
