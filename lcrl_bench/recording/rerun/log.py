"""Episodes as one Rerun recording that opens ready to watch.

A recording holds one or more episodes. On the timeline `step` they follow one another, each
starting at a multiple of ten. Each of several also has a timeline of its own (`episode_1`, ...), on
which it runs from 0 and nothing else is shown. A recording is only a view: the record of an episode
is its `.npz`.
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
from lcrl_bench.recording.narration import about, plain
from lcrl_bench.recording.rerun.house import log_house, log_moves
from lcrl_bench.recording.rerun.layout import STEP, layout, timeline
from lcrl_bench.recording.rerun.panels import log_curves, log_panels, log_styles, markdown
from lcrl_bench.recording.rerun.sheets import log_on_sheets, log_sheets
from lcrl_bench.storage import write_bytes

APPLICATION: Final = "lcrl_bench"
ROOTS: Final = ("world", "map", "views", "along", "policy", "happens", "now", "about")
"""Top-level paths that belong to an episode."""


def record_episodes(path: Path, episodes: Sequence[Episode]) -> None:
    """Write episodes as one recording, `path`, atomically.

    Args:
        path: Ends in `.rrd`.
        episodes: At least one, in the order they are shown.

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
            # Into memory: Rerun's own file writer hangs on a full disk.
            memory = rec.memory_recording()
            rec.send_blueprint(layout(episodes), make_active=False, make_default=True)
            rec.send_recording_name(plain(title))
            rec.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
            log_styles(rec)
            for clock, episode in zip(_clocks(rec, episodes), episodes, strict=True):
                _log_episode(clock, episode)
        write_bytes(path, memory.drain_as_bytes())


@contextmanager
def _strict() -> Iterator[None]:
    """Make Rerun's mistakes errors inside the block; by default it warns and drops data."""
    before = rr.strict_mode()
    rr.set_strict_mode(True)
    try:
        yield
    finally:
        rr.set_strict_mode(before)


@dataclass(frozen=True)
class _Clock:
    """Where an episode lies on the timelines of a recording."""

    rec: rr.RecordingStream
    start: int
    """Its step 0 on `STEP`."""
    own: str | None
    """Its own timeline; None if it is the only episode."""
    place: str
    """Its position among the episodes, as a sentence; empty if it is the only one."""

    def at(self, step: int) -> None:
        """Set the time of what is logged next."""
        self.rec.set_time(STEP, sequence=self.start + step)
        if self.own is not None:
            self.rec.set_time(self.own, sequence=step)

    def columns(self, steps: int) -> list[rr.TimeColumn]:
        """The times of the steps 0 .. steps - 1."""
        times = [rr.TimeColumn(STEP, sequence=self.start + np.arange(steps))]
        if self.own is not None:
            times.append(rr.TimeColumn(self.own, sequence=np.arange(steps)))
        return times


def _clocks(rec: rr.RecordingStream, episodes: Sequence[Episode]) -> list[_Clock]:
    """One clock per episode; each starts at a multiple of ten, after a gap."""
    starts = [0]
    for episode in episodes:
        starts.append(10 * -(-(starts[-1] + episode.horizon + 2) // 10))
    count = len(episodes)
    if count == 1:
        return [_Clock(rec, 0, None, "")]
    others = "the other is" if count == 2 else "the others are"
    place = f"of {count}; {others} in the menu of timelines."
    return [
        _Clock(rec, start, timeline(number), f"Episode {number} {place}")
        for number, start in enumerate(starts[:-1], 1)
    ]


def _log_episode(clock: _Clock, episode: Episode) -> None:
    rec = clock.rec
    if clock.start:
        # On the timeline they share, nothing of the previous episode may remain.
        rec.reset_time()
        rec.set_time(STEP, sequence=clock.start - 1)
        for root in ROOTS:
            rec.log(root, rr.Clear(recursive=True))
        rec.reset_time()
    clock.at(0)
    rec.log("about", markdown(about(episode, clock.place)))
    log_house(rec, episode)
    sheets = log_sheets(rec, episode)
    for step in range(episode.horizon + 1):
        clock.at(step)
        log_moves(rec, episode, step)
        log_on_sheets(rec, episode, sheets, step)
        log_panels(rec, episode, step)
    log_curves(rec, episode, clock.columns(episode.horizon + 1))
    rec.reset_time()
