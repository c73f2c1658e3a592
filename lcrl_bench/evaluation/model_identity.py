"""Ties a model to its training: `model.json` next to a run's `model/`.

It contains the SHA-256 of the run's configuration and of every file of the model. So a model that
was copied from another run, or modified, is detected whenever the run is read. It guards against
mix-ups, not against forgery.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field

from lcrl_bench.documents import Document, parse_document
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.storage import canonical_json, read_json, sha256_of, write_json

MODEL: Final = "model"
MODEL_FILE: Final = "model.json"
_UNFINISHED: Final = "model.part"
TRAIN_AGAIN: Final = "To train it again, repeat its lcrl-bench run command with --fresh."

Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class ModelIdentity(Document):
    """What `model.json` holds."""

    training: Digest
    """SHA-256 of the run's configuration as canonical JSON."""
    files: dict[str, Digest]
    """Path inside `model/` -> SHA-256."""


def save_model(run: Path, save: Callable[[Path], None], config: dict[str, Any]) -> None:
    """Write a model and its identity into a run's folder.

    Args:
        run: The folder.
        save: Creates the folder it is given and writes the model's files: `Reward.save`.
        config: The run's configuration.
    """
    unfinished = run / _UNFINISHED
    shutil.rmtree(unfinished, ignore_errors=True)
    save(unfinished)
    unfinished.mkdir(parents=True, exist_ok=True)  # for methods with nothing to save
    identity = ModelIdentity(training=_digest(config), files=file_digests(unfinished))
    write_json(run / MODEL_FILE, identity.model_dump(mode="json"))
    # Last, so that a folder named `model` is complete and has its identity even after a kill.
    unfinished.rename(run / MODEL)


def model_digest(run: Path) -> str | None:
    """One digest of a run's model, after `check_model`; None if the run has none.

    Raises:
        InvalidFileError: As in `check_model`.
    """
    if not (run / MODEL).exists():
        return None
    return sha256_of(canonical_json(check_model(run).files))


def check_model(run: Path) -> ModelIdentity:
    """Reject a model that is not from the run's own training.

    Raises:
        InvalidFileError: If there is none, its training is not recorded, it is from another
            training, or one of its files was changed.
    """
    file = run / MODEL_FILE
    if not file.exists():
        reason = f"no such file, so nothing says which training made {run / MODEL}"
        raise InvalidFileError(file, reason, fix=TRAIN_AGAIN)
    identity = parse_document(
        ModelIdentity, read_json(file), path=file, kind="the identity of a model", fix=TRAIN_AGAIN
    )
    if identity.training != _digest(read_json(run / "config.json")):
        reason = "the model is from another training than the one in config.json"
        raise InvalidFileError(file, reason, fix=TRAIN_AGAIN)
    found = file_digests(run / MODEL)
    if found != identity.files:
        names = {name for name, _ in found.items() ^ identity.files.items()}
        reason = f"not the model that this run trained ({', '.join(sorted(names))})"
        fix = f"Restore the files that the run wrote. {TRAIN_AGAIN}"
        raise InvalidFileError(run / MODEL, reason, fix=fix)
    return identity


def file_digests(folder: Path) -> dict[str, str]:
    """Path inside a folder -> SHA-256, for all files, recursively."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            with path.open("rb") as file:
                name = path.relative_to(folder).as_posix()
                found[name] = hashlib.file_digest(file, "sha256").hexdigest()
    return found


def _digest(config: object) -> str:
    return sha256_of(canonical_json(config))
