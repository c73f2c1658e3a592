"""What people look at of a run: its showcase, further episodes a file each, its curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.outcome import Outcome
from lcrl_bench.evaluation.run import RunRequest, SeedResult
from lcrl_bench.names import slug
from lcrl_bench.recording.curves import curves_picture, read_metrics, series
from lcrl_bench.recording.episode import Episode, read_episode, write_episode
from lcrl_bench.recording.index import (
    EPISODES,
    RECORDING_FILE,
    RecordedEpisode,
    add_to_index,
    episode_file,
    index_entry,
    is_recorded,
)
from lcrl_bench.recording.pictures import reward_map_picture
from lcrl_bench.recording.rerun_log import record_episodes
from lcrl_bench.recording.rollout import episodes_of
from lcrl_bench.recording.selection import Selection, choose
from lcrl_bench.recording.showcase import record_showcase
from lcrl_bench.recording.strip import strip_picture

CURVES_FILE: Final = "curves.png"
_DRAWN: Final[dict[str, Callable[[Path, Episode], None]]] = {
    "map": reward_map_picture,
    "strip": strip_picture,
    "recording": lambda path, episode: record_episodes(path, [episode]),
}
"""What is drawn of each episode of a selection: its role in the index → how."""


def record_run(
    request: RunRequest,
    sets: Sequence[TaskSet],
    result: SeedResult,
    outcomes: Sequence[Outcome],
    selection: Selection,
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> Path:
    """Record the showcase of a run, its learning curves, and the episodes of a selection.

    Writes `recording.rrd`, `showcase.png` and `curves.png` into the run's folder, and into its
    `episodes` a `.rrd`, a `.npz`, a map and a strip of each further episode, with an index. What
    is there already is kept: a recording that was interrupted goes on.

    Args:
        request: What was run.
        sets: The tasks.
        result: The run.
        outcomes: Of all tasks, in order.
        selection: Which episodes; any but `"none"` begins with the showcase.
        progress: Told each episode of the selection as it is recorded.

    Returns:
        The recording of the showcase.
    """
    folder = result.folder.path
    path = folder / RECORDING_FILE
    if not is_recorded(folder, "showcase"):
        chosen = choose("showcase", outcomes)
        shown = record_showcase(request, sets, result, outcomes, path)
        pairs = zip(shown, chosen, strict=True)
        entries = [index_entry(folder / EPISODES, episode, row) for episode, row in pairs]
        add_to_index(folder / EPISODES, "showcase", entries)
        _draw_curves(request, result)
    if not is_recorded(folder, selection):
        entries = list(_record_each(request, sets, result, choose(selection, outcomes), progress))
        add_to_index(folder / EPISODES, selection, entries)
    return path


def _record_each(
    request: RunRequest,
    sets: Sequence[TaskSet],
    result: SeedResult,
    chosen: Sequence[Outcome],
    progress: Callable[[str], None],
) -> Iterator[RecordedEpisode]:
    """Record episodes one by one: each is a few megabytes while it is drawn."""
    folder = result.folder.path / EPISODES
    houses = {tasks.scene.house.id: tasks for tasks in sets}
    for outcome in chosen:
        task = outcome.task.id
        tasks = houses[outcome.task.house]
        record = episode_file(folder, task, "record")
        episode = _read_back(record, tasks)
        if episode is None:
            (episode,) = episodes_of(
                result.learned,
                sets,
                [outcome],
                benchmark=request.benchmark,
                method=request.method,
                seed=result.seed,
            )
            write_episode(folder, slug(task), episode)
        for role, draw in _DRAWN.items():
            path = episode_file(folder, task, role)
            if not path.exists():
                draw(path, episode)
        progress(task)
        yield index_entry(folder, episode, outcome)


def _read_back(record: Path, tasks: TaskSet) -> Episode | None:
    """An episode that is recorded already; None if it is not, or by another version."""
    if not record.exists():
        return None
    try:
        return read_episode(record, tasks)
    except InvalidFileError:
        return None


def _draw_curves(request: RunRequest, result: SeedResult) -> None:
    """Draw what the training logged, if it logged anything."""
    metrics = result.folder.path / "metrics.jsonl"
    rows = read_metrics(metrics) if metrics.exists() else []
    if not series(rows):
        return
    houses = len(request.benchmark.houses_of(Split.TRAIN))
    passes = request.config(result.seed)["resolved"].get("passes")
    # Methods that go in passes take a step a house.
    whole = passes is not None and rows[-1].get("steps", 0) % houses == 0
    curves_picture(
        result.folder.path / CURVES_FILE,
        rows,
        title=f"{request.method} on {request.benchmark.name}, seed {result.seed}",
        pass_steps=houses if whole else None,
    )
