"""`episodes/index.json`: which episodes of a run are recorded, what came of each, and its files."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Final, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.names import slug
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.failure import failure_of
from lcrl_bench.storage import read_json, write_json

RECORDING_FILE: Final = "recording.rrd"
"""The showcase of a run."""
EPISODES: Final = "episodes"
"""The folder of a run's episodes."""
INDEX_FILE: Final = "index.json"
FILES: Final = {
    "record": ".npz",
    "recording": ".rrd",
    "map": ".png",
    "strip": "-strip.png",
}
"""What is kept of an episode → how its file's name ends, after the task's."""


class Document(BaseModel):
    """Base of what is written: no field besides the declared ones."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class RecordedFile(Document):
    """A file of an episode."""

    path: str
    """Relative to the index."""
    bytes: int


class RecordedEpisode(Document):
    """One episode."""

    task: str
    command: str
    split: str
    kind: str
    house: str
    success: float
    """The task's: the probability that the goal is reached, over ties between actions too."""
    reached: bool
    """Whether this episode, of the likeliest actions, reaches it."""
    failure: Failure | None
    """How this episode fails; None if it does not, and for NAV."""
    files: dict[str, RecordedFile]
    """`"record"`, and as far as they are there `"recording"`, `"map"`, `"strip"`; an episode
    without a recording of its own is part of the run's."""


class EpisodeIndex(Document):
    """All recorded episodes of a run."""

    format: Literal["lcrl-episodes"] = "lcrl-episodes"
    version: Literal[1] = 1
    selections: tuple[str, ...] = ()
    """Which selections are recorded in full."""
    episodes: tuple[RecordedEpisode, ...] = ()
    """By task."""


def is_recorded(folder: Path, selection: str) -> bool:
    """Whether a run's folder holds its showcase and all episodes of a selection."""
    found = read_index(folder / EPISODES).selections
    return (folder / RECORDING_FILE).exists() and {"showcase", selection} <= set(found)


def read_index(folder: Path) -> EpisodeIndex:
    """The index of a folder of episodes; an empty one where there is none.

    Raises:
        InvalidFileError: If the file is damaged.
    """
    path = folder / INDEX_FILE
    if not path.exists():
        return EpisodeIndex()
    try:
        return EpisodeIndex.model_validate(read_json(path))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        fix = "Delete it: the next recording writes it again."
        raise InvalidFileError(path, first["msg"], where=where, fix=fix) from error


def add_to_index(folder: Path, selection: str, entries: Iterable[RecordedEpisode]) -> None:
    """Write into the index of a folder that a selection is recorded, and its episodes."""
    before = read_index(folder)
    episodes = {entry.task: entry for entry in (*before.episodes, *entries)}
    after = EpisodeIndex(
        selections=tuple(dict.fromkeys([*before.selections, selection])),
        episodes=tuple(episodes[task] for task in sorted(episodes)),
    )
    write_json(folder / INDEX_FILE, after.model_dump(mode="json"))


def index_entry(folder: Path, episode: Episode, outcome: Outcome) -> RecordedEpisode:
    """What the index says of an episode whose files are written.

    Args:
        folder: Where they are.
        episode: What happened.
        outcome: What came of its task.
    """
    task = episode.task
    paths = {role: episode_file(folder, task.id, role) for role in FILES}
    return RecordedEpisode(
        task=task.id,
        command=task.command,
        split=task.split.value,
        kind=task.kind.value,
        house=task.house,
        success=outcome.success,
        reached=episode.success,
        failure=failure_of(episode),
        files={
            role: RecordedFile(path=path.name, bytes=path.stat().st_size)
            for role, path in paths.items()
            if path.exists()
        },
    )


def episode_file(folder: Path, task: str, role: str) -> Path:
    """Where a file of a task's episode is: `role` is a key of `FILES`."""
    return folder / f"{slug(task)}{FILES[role]}"
