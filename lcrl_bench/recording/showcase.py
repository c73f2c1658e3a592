"""The recording of a run: a few telling episodes as one `.rrd`, each with its `.npz` twin."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.outcome import Outcome
from lcrl_bench.evaluation.run import RunRequest, SeedResult
from lcrl_bench.names import slug
from lcrl_bench.recording.episode import Episode, write_episode
from lcrl_bench.recording.index import episode_file
from lcrl_bench.recording.pictures import reward_map_picture, showcase_picture
from lcrl_bench.recording.rerun_log import record_episodes
from lcrl_bench.recording.rollout import choose_showcase, episodes_of
from lcrl_bench.recording.strip import strip_picture


def record_showcase(
    request: RunRequest,
    sets: Sequence[TaskSet],
    result: SeedResult,
    outcomes: Sequence[Outcome],
    path: Path,
) -> tuple[Episode, ...]:
    """Record a NAV success, a PICK success and a failure of a run, as far as they occurred.

    Writes the recording to `path`, and beside it `episodes/<task>.npz` (the record the recording is
    a view of), `episodes/<task>.png` (its reward map), `episodes/<task>-strip.png` (what it saw and
    did) and `showcase.png`.

    Returns:
        The episodes, in the order of `choose_showcase`.
    """
    episodes = episodes_of(
        result.learned,
        sets,
        choose_showcase(outcomes),
        benchmark=request.benchmark,
        method=request.method,
        seed=result.seed,
    )
    folder = path.parent / "episodes"
    for episode in episodes:
        record = write_episode(folder, slug(episode.task.id), episode)
        reward_map_picture(record.with_suffix(".png"), episode)
        strip_picture(episode_file(folder, episode.task.id, "strip"), episode)
    shown = next((e for e in episodes if e.success and e.task.kind == Kind.PICK), episodes[0])
    showcase_picture(path.with_name("showcase.png"), shown)
    record_episodes(path, episodes)
    return episodes
