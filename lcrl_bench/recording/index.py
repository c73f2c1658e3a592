"""What is recorded of a run: `episodes/index.json`, and the recordings that a path stands for."""

from __future__ import annotations

from collections.abc import Mapping
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
from lcrl_bench.storage import read_json, write_bytes, write_json

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
    return {"showcase", selection} <= set(Archive(folder).selections)


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


class Archive:
    """What is recorded of a run: its files, and the index of its episodes."""

    def __init__(self, folder: Path) -> None:
        """Read the index of a run's folder; errors as `read_index`."""
        self._folder = folder
        self._index = read_index(folder / EPISODES)

    @property
    def selections(self) -> tuple[str, ...]:
        """Selections that are recorded in full; none without the showcase, which is first."""
        return self._index.selections if (self._folder / RECORDING_FILE).exists() else ()

    @property
    def recorded(self) -> set[str]:
        """Tasks whose episode has all its files, a recording of its own included."""
        home = self._folder / EPISODES
        whole = [each for each in self._index.episodes if set(FILES) <= set(each.files)]
        return {
            each.task
            for each in whole
            if all((home / file.path).exists() for file in each.files.values())
        }

    def add(self, episode: Episode, outcome: Outcome, files: Mapping[str, bytes]) -> None:
        """Write the files of an episode and its entry in the index.

        Args:
            episode: What happened.
            outcome: The result of its task.
            files: Role → content; roles are the keys of `FILES`. Older files of other roles stay.
        """
        task, known = episode.task, {each.task: each for each in self._index.episodes}
        older = known[task.id].files if task.id in known else {}
        newer = {
            role: RecordedFile(path=f"{slug(task.id)}{FILES[role]}", bytes=len(content))
            for role, content in files.items()
        }
        listed = {**older, **newer}
        known[task.id] = RecordedEpisode(
            task=task.id,
            command=task.command,
            split=task.split.value,
            kind=task.kind.value,
            house=task.house,
            success=outcome.success,
            reached=episode.success,
            failure=episode.failure,
            files={role: listed[role] for role in FILES if role in listed},
        )
        episodes = tuple(known[name] for name in sorted(known))
        self._write(
            {f"{EPISODES}/{newer[role].path}": content for role, content in files.items()},
            EpisodeIndex(selections=self._index.selections, episodes=episodes),
        )

    def complete(self, selection: str, files: Mapping[str, bytes]) -> None:
        """Write the files of a run, name → content, and note that a selection is recorded."""
        selections = tuple(dict.fromkeys([*self._index.selections, selection]))
        self._write(files, EpisodeIndex(selections=selections, episodes=self._index.episodes))

    def _write(self, files: Mapping[str, bytes], index: EpisodeIndex) -> None:
        """Write files, then the index that lists them."""
        for name, content in files.items():
            write_bytes(self._folder / name, content)
        write_json(self._folder / EPISODES / INDEX_FILE, index.model_dump(mode="json"))
        self._index = index


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
