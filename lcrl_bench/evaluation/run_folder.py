"""The folder of one training run: its configuration, progress and results.

    runs/<benchmark>/<method>/seed<k>/
        config.json       its identity: spec and `made_with`
        environment.json  versions, device, machine
        metrics.jsonl     one row per training step
        checkpoint/       state of an unfinished training
        training.json     whether the training used its random generator
        model/            the learned reward or policy, as it saved itself
        model.json        the training it is from, and the SHA-256 of every file
        episodes.parquet  one row per task
        controls/         the same of each control of the benchmark
        summary.json      success and the other measures, by split and kind
        recording.rrd, episodes/  the recording to view, and its data
        DONE              time of completion; written last

All files are written atomically, so a run killed at any point resumes from its last checkpoint.
While a process writes it, there is a lock next to it: `seed<k>.lock`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator, Mapping
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
CONTROLS_FOLDER = "controls"
TRAINING_FILE = "training.json"
_SET_ASIDE: Final = re.compile(r".+\.old\d+")


@dataclass
class RunFolder:
    """One run on disk."""

    path: Path
    aside: Path | None = None
    """Where `begin` moved an existing run, if it set one aside."""
    _rows: list[str] = field(default_factory=list)
    _opened: bool = False
    _held: bool = False

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other processes from writing the run; a no-op if we already hold the lock.

        Raises:
            FolderInUseError: If another process is writing it.
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
        """Raise the errors of `begin` before any work, without writing the run.

        Raises:
            FolderInUseError: If another process is writing it.
            UsageError: As in `begin`.
            InvalidFileError: As in `begin`.
        """
        if self.path.parent.is_dir():
            with self.locked():
                pass
        if not fresh:
            self._refuse_another(config)

    def begin(self, config: dict[str, Any], *, device: torch.device, fresh: bool = False) -> bool:
        """Write the run's identity; refuse to mix it with another run in the same folder.

        Args:
            config: Its identity, as JSON.
            device: The device it computes on.
            fresh: Set another run aside instead of raising.

        Returns:
            Whether the same run is already there and done.

        Raises:
            UsageError: If the folder has a run of another identity; says what differs.
            InvalidFileError: If its model or its results are not those of its training.
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
                reason = "no such file, so the training of the model and results here is unknown"
                raise InvalidFileError(file, reason, fix=TRAIN_AGAIN)
            return
        if different := differences(read_json(file), config):
            when = f", finished {self.finished:%Y-%m-%d %H:%M}" if self.done else ""
            raise UsageError(
                f"{self.path} holds another run{when}. It differs in {'; '.join(different)}. "
                "Use --fresh (in Python fresh=True) to set it aside and start over, or name "
                "another folder (--out)."
            )
        # A control has neither; a finished run whose model was removed has one of them.
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
        """Whether the run of this identity is there, finished and intact."""
        try:
            self._refuse_another(config)
        except (UsageError, InvalidFileError):
            return False
        return self.done

    def _set_aside(self) -> Path:
        # Renamed in one step, so that it is always complete under one name or the other.
        names = (self.path.with_name(f"{self.path.name}.old{number}") for number in count(1))
        free = next(path for path in names if not path.exists())
        self.path.rename(free)
        return free

    @property
    def done(self) -> bool:
        """Whether the run is finished."""
        return (self.path / "DONE").exists()

    @property
    def finished(self) -> datetime:
        """When the run was finished, in local time."""
        file = self.path / "DONE"
        try:
            return datetime.fromisoformat(file.read_text("ascii")).astimezone()
        except ValueError:  # empty, as an older version wrote it
            return datetime.fromtimestamp(file.stat().st_mtime).astimezone()

    @property
    def checkpoint(self) -> Path:
        """Folder for the state of an unfinished training."""
        return self.path / "checkpoint"

    @property
    def model(self) -> Path:
        """Folder of the fitted model."""
        return self.path / MODEL

    def log(self, row: dict[str, Any]) -> None:
        """Append a row to `metrics.jsonl`; a resumed training replaces its later rows."""
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
        """Record whether the training drew random numbers: if not, its seed has no effect."""
        write_json(self.path / TRAINING_FILE, {"drew": drew})

    @property
    def deterministic(self) -> bool:
        """Whether the training is known not to have drawn random numbers."""
        file = self.path / TRAINING_FILE
        return file.exists() and read_json(file) == {"drew": False}

    def write_episodes(self, results: Results, *, file: str = EPISODES_FILE) -> None:
        """Write `episodes.parquet`: one row per task, with success under each language control.

        Args:
            results: The results of this run alone.
            file: The file's name, for the results of another optimizer.
        """
        with atomic_path(self.path / file) as temporary:
            results.write(temporary)

    def write_controls(self, controls: Mapping[str, Results]) -> None:
        """Write `controls/<name>.parquet`: the results of each control of the benchmark."""
        for name, results in controls.items():
            with atomic_path(self.control_file(name)) as temporary:
                results.write(temporary)

    def control_file(self, name: str) -> Path:
        """The file of a control's results."""
        return self.path / CONTROLS_FOLDER / f"{name}.parquet"

    def finish(self, summary: dict[str, Any]) -> None:
        """Write `summary.json`, then mark the run as done.

        The summary is tied to its model and episodes by their digests.
        """
        write_json(self.path / "summary.json", {**summary, **self._of()})
        now = datetime.now().astimezone().isoformat(timespec="seconds")
        write_bytes(self.path / "DONE", now.encode())

    def summary(self) -> dict[str, Any]:
        """The summary of a finished run.

        Raises:
            InvalidFileError: If the model or the episodes are not those it was made from.
        """
        found = read_json(self.path / "summary.json")
        for name, digest in self._of().items():
            if found.get(name) != digest:
                reason = f"does not match the {name} next to it, which changed after it was written"
                raise InvalidFileError(self.path / "summary.json", reason, fix=TRAIN_AGAIN)
        return found

    def _of(self) -> dict[str, str]:
        """Digests of the model and the episodes, where present, that a summary is tied to."""
        model, episodes = model_digest(self.path), self.path / EPISODES_FILE
        return {
            **({} if model is None else {"model": model}),
            **({"episodes": sha256_of(episodes.read_bytes())} if episodes.exists() else {}),
        }


def is_set_aside(folder: Path) -> bool:
    """Whether a run was set aside for a fresh one, and so no longer counts."""
    return _SET_ASIDE.fullmatch(folder.name) is not None


def finished_between(folders: Collection[RunFolder]) -> str:
    """When some runs were finished, as text: `3 runs, finished 2026-11-26 09:00 to ...`."""
    times = sorted({f"{folder.finished:%Y-%m-%d %H:%M}" for folder in folders})
    runs = "1 run" if len(folders) == 1 else f"{len(folders)} runs"
    return f"{runs}, finished {' to '.join(dict.fromkeys([times[0], times[-1]]))}"
