"""Which training made a model: `model.json` beside a run's `model/`.

It names the run by the SHA-256 of its `config.json`, and every file of the model by its own. So a
model that was copied here from another run, or changed, is noticed wherever the run is read. It
guards against mix-ups, not against forgery.
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
    """Write a model into a run's folder, and what says whose it is.

    Args:
        run: The folder.
        save: Writes the model's files into the folder it is given, which it makes: `Reward.save`.
        config: The run's configuration.
    """
    unfinished = run / _UNFINISHED
    shutil.rmtree(unfinished, ignore_errors=True)
    save(unfinished)
    unfinished.mkdir(parents=True, exist_ok=True)  # of a method that has nothing to save
    identity = ModelIdentity(training=_digest(config), files=file_digests(unfinished))
    write_json(run / MODEL_FILE, identity.model_dump(mode="json"))
    # Last: a folder called `model` is complete and has its identity, whenever a kill comes.
    unfinished.rename(run / MODEL)


def model_digest(run: Path) -> str | None:
    """One digest of a run's model, after `check_model`; None if the run has none.

    Raises:
        InvalidFileError: As `check_model`.
    """
    if not (run / MODEL).exists():
        return None
    return sha256_of(canonical_json(check_model(run).files))


def check_model(run: Path) -> ModelIdentity:
    """Refuse a model that the run's own training did not make.

    Raises:
        InvalidFileError: If there is none; if nothing says which training made it; if it is of
            another training; or if one of its files was changed.
    """
    file = run / MODEL_FILE
    if not file.exists():
        reason = f"no such file, so nothing says which training made {run / MODEL}"
        raise InvalidFileError(file, reason, fix=TRAIN_AGAIN)
    identity = parse_document(
        ModelIdentity, read_json(file), path=file, kind="the identity of a model", fix=TRAIN_AGAIN
    )
    if identity.training != _digest(read_json(run / "config.json")):
        reason = "the model of another training than the one that config.json describes"
        raise InvalidFileError(file, reason, fix=TRAIN_AGAIN)
    found = file_digests(run / MODEL)
    if found != identity.files:
        names = {name for name, _ in found.items() ^ identity.files.items()}
        reason = f"not the model that this run trained ({', '.join(sorted(names))})"
        fix = f"Put back what the run wrote there. {TRAIN_AGAIN}"
        raise InvalidFileError(run / MODEL, reason, fix=fix)
    return identity


def file_digests(folder: Path) -> dict[str, str]:
    """Path inside a folder -> SHA-256, of every file in it and below."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            with path.open("rb") as file:
                name = path.relative_to(folder).as_posix()
                found[name] = hashlib.file_digest(file, "sha256").hexdigest()
    return found


def _digest(config: object) -> str:
    return sha256_of(canonical_json(config))
