"""The recording of a run: a few telling episodes as one `.rrd`, each with its `.npz` twin."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from lcrl_bench.evaluation.harness import Outcome
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.evaluation.run import RunRequest, SeedResult
from lcrl_bench.names import slug
from lcrl_bench.recording.episode import write_episode
from lcrl_bench.recording.pictures import showcase_picture
from lcrl_bench.recording.rerun_log import record_episodes
from lcrl_bench.recording.rollout import choose_showcase, episodes_of


def record_showcase(
    request: RunRequest,
    problems: Sequence[Problem],
    result: SeedResult,
    outcomes: Sequence[Outcome],
    path: Path,
) -> None:
    """Record a NAV success, a PICK success and a failure of a run, as far as they occurred.

    Writes the recording to `path`, and beside it `episodes/<task>.npz` (the record the recording is
    a view of) and `showcase.png`.
    """
    episodes = episodes_of(
        result.learned,
        problems,
        choose_showcase(outcomes),
        benchmark=request.benchmark,
        method=request.method,
        seed=result.seed,
    )
    for episode in episodes:
        write_episode(path.parent / "episodes", slug(episode.task.id), episode)
    showcase_picture(path.with_name("showcase.png"), episodes[0].compiled, episodes[0])
    record_episodes(path, episodes)
