"""A row's recording and pictures.

They are never submitted: whoever verifies a row makes them, from the checkpoint whose figures are
compared.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lcrl_bench.evaluation.run import Run
from lcrl_bench.evaluation.session import Session
from lcrl_bench.recording.index import (
    EPISODES,
    RECORDING_FILE,
    RecordedEpisode,
    read_index,
)
from lcrl_bench.recording.run_recording import record_showcase
from lcrl_bench.storage import write_bytes

PICTURE: Final = "showcase.png"
DIGEST: Final = "submission.sha256"
"""Holds the SHA-256 of the submission's file that was recorded: another content is another row."""


@dataclass(frozen=True)
class Exhibits:
    """A row's recording and pictures."""

    folder: Path
    recording: Path | None
    picture: Path | None
    """The house, the agent's views, and the learned reward."""
    episodes: tuple[RecordedEpisode, ...]

    def maps(self) -> tuple[tuple[RecordedEpisode, Path], ...]:
        """The reward map of each episode that has one."""
        home = self.folder / EPISODES
        return tuple(
            (episode, home / episode.files["map"].path)
            for episode in self.episodes
            if "map" in episode.files and _inside(home, episode.files["map"].path)
        )


def record_exhibits(run: Run, session: Session, folder: Path, *, submission: str) -> None:
    """Record the showcase of a run: `recording.rrd`, `showcase.png` and a map per episode.

    Args:
        run: The run.
        session: The benchmark that it is on.
        folder: Where to write; an older recording is replaced.
        submission: SHA-256 of the submission's file.
    """
    if folder.exists():
        shutil.rmtree(folder)
    record_showcase(run, session, folder)
    write_bytes(folder / DIGEST, submission.encode())


def read_exhibits(folder: Path, *, submission: str) -> Exhibits | None:
    """The recording and pictures of a submission in a folder; None if there are none of this one.

    Args:
        folder: The folder.
        submission: SHA-256 of the submission's file.

    Raises:
        InvalidFileError: If its index is damaged.
    """
    recording, picture = folder / RECORDING_FILE, folder / PICTURE
    digest = folder / DIGEST
    if not digest.is_file() or digest.read_text("utf-8") != submission:
        return None
    return Exhibits(
        folder,
        recording if recording.is_file() else None,
        picture if picture.is_file() else None,
        read_index(folder / EPISODES).episodes,
    )


def _inside(home: Path, name: str) -> bool:
    return Path(name).name == name and (home / name).is_file()
