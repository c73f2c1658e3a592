"""The files of a checkpoint: listed with their hashes, compared before they are loaded, copied."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lcrl_bench.board.document import SeedDocument, Submission
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.storage import atomic_folder, write_bytes

MAX_PACKED: Final = 4 * 1024 * 1024
"""Bytes of checkpoints per row in the repository; LC-RL's 3 seeds have 0.9 MB."""

NO_CHECKPOINT: Final = (
    "Name the folder of seed<k>/model with --runs, or train it again with --retrain."
)


@dataclass(frozen=True)
class ListedFile:
    """A file of a checkpoint as it is on disk; `document.CheckpointFile` is what a row says."""

    path: str
    """Relative to the checkpoint's folder."""
    bytes: int
    sha256: str


def listed_files(folder: Path) -> list[ListedFile]:
    """Every file in a checkpoint's folder.

    Raises:
        InvalidFileError: If it holds none, or a symbolic link.
    """
    found = []
    for path in sorted(folder.rglob("*")):
        if path.is_symlink():
            fix = "Put the file itself there."
            raise InvalidFileError(path, "a symbolic link", fix=fix)
        if path.is_file():
            with path.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            name = path.relative_to(folder).as_posix()
            found.append(ListedFile(name, path.stat().st_size, digest))
    if not found:
        raise InvalidFileError(folder, "no checkpoint there", fix=NO_CHECKPOINT)
    return found


def checkpoint_folder(
    submission: Submission, seed: SeedDocument, *, file: Path, runs: Path | None
) -> Path:
    """Where a seed's checkpoint is.

    Args:
        submission: The submission.
        seed: One of its seeds.
        file: The submission's file.
        runs: Where to look instead of where the submission says: a folder of seed<k>, or of
            `<benchmark>/<run>/seed<k>`.

    Raises:
        InvalidFileError: If it is not there.
    """
    if runs is None:
        places = [file.parent / submission.checkpoints]
    else:
        places = [runs, runs / submission.benchmark / submission.run]
    models = [place / f"seed{seed.seed}" / "model" for place in places]
    found = next((model for model in models if model.is_dir()), None)
    if found is None:
        had = f" It can be had at {submission.weights!r}." if submission.weights else ""
        raise InvalidFileError(models[-1], "no checkpoint there", fix=NO_CHECKPOINT + had)
    return found


def check_packable(folders: Sequence[Path]) -> None:
    """Refuse checkpoints that are too large to go with a submission.

    Args:
        folders: The run folders, `seed<k>`.

    Raises:
        UsageError: If they are larger than a repository should hold.
    """
    listed = {folder: listed_files(folder / "model") for folder in folders}
    size = sum(file.bytes for files in listed.values() for file in files)
    if size > MAX_PACKED:
        raise UsageError(
            f"{size / 2**20:.1f} MB of checkpoints; a row brings at most {MAX_PACKED / 2**20:.0f} "
            "MB. Put them where they can be downloaded, and say --weights URL instead of --pack."
        )


def pack(folders: Sequence[Path], out: Path) -> Path:
    """Copy the checkpoints of runs to `out/seed<k>/model`, to go with a submission.

    What is there already is replaced; an error leaves it as it was.

    Args:
        folders: The run folders, `seed<k>`.
        out: The folder to write.

    Raises:
        UsageError: If `check_packable` refuses them.
        EnvironmentMissingError: If they can't be written.
    """
    check_packable(folders)
    with atomic_folder(out) as temporary:
        for folder in folders:
            for file in listed_files(folder / "model"):
                source = folder / "model" / file.path
                write_bytes(temporary / folder.name / "model" / file.path, source.read_bytes())
    return out
