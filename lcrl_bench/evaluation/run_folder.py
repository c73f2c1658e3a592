"""The folder of one training run: what it was asked, how it went, what came out.

    runs/<benchmark>/<method>/seed<k>/
        config.json       its identity: what was asked, and what it is made with
        environment.json  versions, device, machine
        metrics.jsonl     a row a training step
        checkpoint/       state of an unfinished training
        training.json     whether the training drew from its generator
        model/            what the learned reward or policy saved
        model.json        which training that was, and the SHA-256 of every file
        episodes.parquet  a row a task
        summary.json      success and what else is measured, by split and kind
        recording.rrd, episodes/  what people look at, and its record
        DONE              when it was finished; written last

Every file is written whole or not at all, so a run killed at any point goes on from its last
checkpoint. While a process writes it, a lock stands beside it: `seed<k>.lock`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from datetime import datetime
from itertools import count
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.environment import environment
from lcrl_bench.evaluation.folder_lock import locked
from lcrl_bench.evaluation.identity import differences
from lcrl_bench.evaluation.model_identity import (
    MODEL,
    MODEL_FILE,
    TRAIN_AGAIN,
    check_model,
    model_digest,
)
from lcrl_bench.evaluation.results import Results
from lcrl_bench.storage import (
    append_text,
    atomic_path,
    read_json,
    sha256_of,
    write_bytes,
    write_json,
)

EPISODES_FILE = "episodes.parquet"
TRAINING_FILE = "training.json"
_SET_ASIDE: Final = re.compile(r".+\.old\d+")


@dataclass
class RunFolder:
    """One run on disk."""

    path: Path
    aside: Path | None = None
    """Where the run that was in the way is now, if `begin` set one aside."""
    _rows: list[str] = field(default_factory=list)
    _opened: bool = False
    _held: bool = False

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes from writing the run; nothing more if it is locked already.

        Raises:
            FolderInUseError: If another process writes it.
        """
        if self._held:
            yield
            return
        with locked(self.path):
            self._held = True
            try:
                yield
            finally:
                self._held = False

    def check(self, config: dict[str, Any], *, fresh: bool = False) -> None:
        """Say what `begin` would refuse, before any work and without writing the run.

        Raises:
            FolderInUseError: If another process writes it.
            UsageError: As `begin`.
            InvalidFileError: As `begin`.
        """
        if self.path.parent.is_dir():
            with self.locked():
                pass
        if not fresh:
            self._refuse_another(config)

    def begin(self, config: dict[str, Any], *, device: torch.device, fresh: bool = False) -> bool:
        """Say what the run is; refuse to mix it with another one in the same folder.

        Args:
            config: Its identity, as JSON.
            device: Where it computes.
            fresh: Set aside what would be refused, instead.

        Returns:
            Whether the very same run is there already, done.

        Raises:
            UsageError: If the folder holds a run of another identity: says what differs.
            InvalidFileError: If its model or its figures are not those of its training.
        """
        try:
            self._refuse_another(config)
        except (UsageError, InvalidFileError):
            if not fresh:
                raise
            self.aside = self._set_aside()
        if not (self.path / "config.json").exists():
            write_json(self.path / "config.json", config)
        if not self.done:
            write_json(self.path / "environment.json", asdict(environment(device)))
        return self.done

    def _refuse_another(self, config: dict[str, Any]) -> None:
        file = self.path / "config.json"
        if not file.exists():
            if self.done or self.model.exists():
                reason = "no such file, so nothing says what made the model or the results here"
                raise InvalidFileError(file, reason, fix=TRAIN_AGAIN)
            return
        if different := differences(read_json(file), config):
            when = f", finished {self.finished:%Y-%m-%d %H:%M}" if self.done else ""
            raise UsageError(
                f"{self.path} holds another run{when}. It differs in {'; '.join(different)}. "
                "Give --fresh (in Python fresh=True) to set it aside and start anew, or name "
                "another folder (--out)."
            )
        # A control has neither; a finished run whose model is gone has one of them.
        if self.model.exists() or (self.done and (self.path / MODEL_FILE).exists()):
            check_model(self.path)
        if self.done:
            self.summary()

    @property
    def config(self) -> dict[str, Any] | None:
        """The identity of the run, as JSON; None if there is none."""
        file = self.path / "config.json"
        return read_json(file) if file.exists() else None

    def holds(self, config: dict[str, Any]) -> bool:
        """Whether the run of this identity is there, done and undamaged."""
        try:
            self._refuse_another(config)
        except (UsageError, InvalidFileError):
            return False
        return self.done

    def _set_aside(self) -> Path:
        # Renamed at once, so that it is there whole, under one name or the other.
        names = (self.path.with_name(f"{self.path.name}.old{number}") for number in count(1))
        free = next(path for path in names if not path.exists())
        self.path.rename(free)
        return free

    @property
    def done(self) -> bool:
        """Whether the run came to its end."""
        return (self.path / "DONE").exists()

    @property
    def finished(self) -> datetime:
        """When the run came to its end, in local time."""
        file = self.path / "DONE"
        try:
            return datetime.fromisoformat(file.read_text("ascii")).astimezone()
        except ValueError:  # empty, as an older version wrote it
            return datetime.fromtimestamp(file.stat().st_mtime).astimezone()

    @property
    def checkpoint(self) -> Path:
        """Where an unfinished training keeps its state."""
        return self.path / "checkpoint"

    @property
    def model(self) -> Path:
        """Where the fitted method is saved."""
        return self.path / MODEL

    def log(self, row: dict[str, Any]) -> None:
        """Append a row to `metrics.jsonl`; rows of a training that was resumed are replaced."""
        if not self._opened:
            self._rows = self._rows_before(int(row.get("step", 0)))
            self._opened = True
            write_bytes(self.path / "metrics.jsonl", "".join(self._rows).encode())
        append_text(self.path / "metrics.jsonl", json.dumps(row, sort_keys=True) + "\n")

    def _rows_before(self, step: int) -> list[str]:
        file = self.path / "metrics.jsonl"
        if not file.exists():
            return []
        kept = []
        for line in file.read_text("utf-8").splitlines():
            try:
                if json.loads(line)["step"] < step:
                    kept.append(line + "\n")
            except (ValueError, KeyError):
                continue
        return kept

    def note_training(self, *, drew: bool) -> None:
        """Write whether the training drew anything: if not, its seed changes nothing."""
        write_json(self.path / TRAINING_FILE, {"drew": drew})

    @property
    def deterministic(self) -> bool:
        """Whether the training is known to have drawn nothing."""
        file = self.path / TRAINING_FILE
        return file.exists() and read_json(file) == {"drew": False}

    def write_episodes(self, results: Results, *, file: str = EPISODES_FILE) -> None:
        """Write `episodes.parquet`: one row per task, with success under each language control.

        Args:
            results: Of this run alone.
            file: Another name, for what another optimizer made of the same run.
        """
        with atomic_path(self.path / file) as temporary:
            results.write(temporary)

    def finish(self, summary: dict[str, Any]) -> None:
        """Write `summary.json`, then the mark that the run is done.

        The summary is bound to the model and the episodes that it is of, by their digests.
        """
        write_json(self.path / "summary.json", {**summary, **self._of()})
        now = datetime.now().astimezone().isoformat(timespec="seconds")
        write_bytes(self.path / "DONE", now.encode())

    def summary(self) -> dict[str, Any]:
        """The summary of a finished run.

        Raises:
            InvalidFileError: If the model or the episodes are others than those it was made of.
        """
        found = read_json(self.path / "summary.json")
        for name, digest in self._of().items():
            if found.get(name) != digest:
                reason = f"not of the {name} beside it, which changed after it was written"
                raise InvalidFileError(self.path / "summary.json", reason, fix=TRAIN_AGAIN)
        return found

    def _of(self) -> dict[str, str]:
        """What a summary is of: digests of the model and the episodes, as far as there are any."""
        model, episodes = model_digest(self.path), self.path / EPISODES_FILE
        return {
            **({} if model is None else {"model": model}),
            **({"episodes": sha256_of(episodes.read_bytes())} if episodes.exists() else {}),
        }


def is_set_aside(folder: Path) -> bool:
    """Whether a run was set aside for a fresh one: then it stands for nothing any more."""
    return _SET_ASIDE.fullmatch(folder.name) is not None


def finished_between(folders: Collection[RunFolder]) -> str:
    """When some runs were finished, for a person: `3 runs, finished 2026-11-26 09:00 to ...`."""
    times = sorted({f"{folder.finished:%Y-%m-%d %H:%M}" for folder in folders})
    runs = "1 run" if len(folders) == 1 else f"{len(folders)} runs"
    return f"{runs}, finished {' to '.join(dict.fromkeys([times[0], times[-1]]))}"
