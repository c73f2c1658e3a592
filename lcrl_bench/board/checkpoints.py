"""The files of a checkpoint: listed with their hashes, and compared before they are loaded."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

from lcrl_bench.board.document import SeedDocument, Submission
from lcrl_bench.errors import InvalidFileError


def listed_files(folder: Path) -> list[dict[str, Any]]:
    """Every file in a checkpoint's folder: path, size in bytes and SHA-256.

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
            found.append({"path": name, "bytes": path.stat().st_size, "sha256": digest})
    if not found:
        fix = "Name the folder of seed<k>/model with --runs."
        raise InvalidFileError(folder, "no checkpoint there", fix=fix)
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
        fix = "Name the folder of seed<k>/model with --runs."
        raise InvalidFileError(models[-1], "no checkpoint there", fix=fix)
    return found
