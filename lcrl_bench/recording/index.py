"""What is recorded of a run: `episodes/index.json`, and the recordings that a path stands for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from pydantic import ValidationError

from lcrl_bench.documents import Document
from lcrl_bench.errors import InvalidFileError, UnknownNameError
from lcrl_bench.evaluation.finished_runs import find_run
from lcrl_bench.evaluation.model_identity import MODEL_FILE, check_model
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.names import slug
from lcrl_bench.recording.episode import Episode
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
"""Role of an episode's file → suffix of its name, after the task's."""
_MAGIC: Final = b"RRF"
"""First bytes of a Rerun recording."""


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
    """The task's success probability, over ties between actions."""
    reached: bool
    """Whether this episode, which takes the likeliest actions, reaches the goal."""
    failure: Failure | None
    """How this episode fails; None if it succeeds, and for NAV."""
    files: dict[str, RecordedFile]
    """`"record"`, and where they exist `"recording"`, `"map"`, `"strip"`; an episode without a
    recording of its own is part of the run's."""


class EpisodeIndex(Document):
    """All recorded episodes of a run."""

    format: Literal["lcrl-episodes"] = "lcrl-episodes"
    version: Literal[1] = 1
    selections: tuple[str, ...] = ()
    """Selections that are recorded in full."""
    episodes: tuple[RecordedEpisode, ...] = ()
    """Sorted by task."""


def is_recorded(folder: Path, selection: str) -> bool:
    """Whether a run's folder holds its showcase and every episode of a selection."""
    found = read_index(folder / EPISODES).selections
    return (folder / RECORDING_FILE).exists() and {"showcase", selection} <= set(found)


def read_index(folder: Path) -> EpisodeIndex:
    """The index of a folder of episodes; empty if there is none.

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


def add_to_index(folder: Path, selection: str, recorded: Iterable[tuple[Episode, Outcome]]) -> None:
    """Add a selection to the index of a folder: its episodes, and the results of their tasks.

    Each is taken from the iterable once its files are written.
    """
    entries = [_entry(folder, episode, outcome) for episode, outcome in recorded]
    before = read_index(folder)
    episodes = {entry.task: entry for entry in (*before.episodes, *entries)}
    after = EpisodeIndex(
        selections=tuple(dict.fromkeys([*before.selections, selection])),
        episodes=tuple(episodes[task] for task in sorted(episodes)),
    )
    write_json(folder / INDEX_FILE, after.model_dump(mode="json"))


def _entry(folder: Path, episode: Episode, outcome: Outcome) -> RecordedEpisode:
    """The index entry of an episode whose files are in `folder`."""
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
        failure=episode.failure,
        files={
            role: RecordedFile(path=path.name, bytes=path.stat().st_size)
            for role, path in paths.items()
            if path.exists()
        },
    )


def episode_file(folder: Path, task: str, role: str) -> Path:
    """Path of a file of a task's episode; `role` is a key of `FILES`."""
    return folder / f"{slug(task)}{FILES[role]}"


@dataclass(frozen=True)
class Recordings:
    """Recordings that can be opened."""

    main: Path
    """Opened by default."""
    episodes: tuple[RecordedEpisode, ...]
    """All recorded episodes of a run, sorted by task; empty for a file."""

    def episode(self, name: str) -> Path:
        """The recording of an episode.

        Args:
            name: Name of its task, or a part of it that is unique.

        Raises:
            UnknownNameError: If no episode matches, or more than one.
        """
        alike = [each for each in self.episodes if name in each.task]
        found = [each for each in alike if each.task == name] or alike
        if len(found) != 1:
            raise UnknownNameError("episode", name, [each.task for each in found or self.episodes])
        return self.file_of(found[0])

    def file_of(self, episode: RecordedEpisode) -> Path:
        """The episode's own recording, or the run's, which contains it."""
        own = episode.files.get("recording")
        return self.main if own is None else self.main.parent / EPISODES / own.path


def find_recordings(target: Path) -> Recordings:
    """Find the recordings of a file, a run or a folder.

    Args:
        target: A .rrd file; a run's folder, or one above it, which stands for the run finished
            last; or a folder with one recording, as `ask` writes it.

    Raises:
        InvalidFileError: If it is not a recording, or the run has none, or its model has changed.
        UsageError: If there is no such folder.
        NothingSelectedError: If there is no finished run below the folder.
    """
    if target.suffix == ".rrd" or target.is_file():
        return Recordings(check_recording(target), ())
    loose = sorted(target.glob("*.rrd"))
    if len(loose) == 1 and loose[0].name != RECORDING_FILE:
        return Recordings(check_recording(loose[0]), ())
    run = find_run(target)
    if not (run / RECORDING_FILE).is_file():
        fix = "Repeat its command with --record showcase; it is not trained again."
        raise InvalidFileError(run, "this run has no recording", fix=fix)
    # The recording must show the model that is there; older runs don't identify it.
    if (run / MODEL_FILE).exists():
        check_model(run)
    return Recordings(check_recording(run / RECORDING_FILE), read_index(run / EPISODES).episodes)


def check_recording(path: Path) -> Path:
    """Return the path of a recording; refuse any other file.

    Raises:
        InvalidFileError: If there is no such file, or it is not a Rerun recording.
    """
    if not path.is_file():
        raise InvalidFileError(path, "no such file", fix="Name a .rrd file or the folder of a run.")
    with path.open("rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise InvalidFileError(path, "not a Rerun recording", fix="Name a .rrd file.")
    return path
