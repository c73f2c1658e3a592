"""The folder of one training run: what it was asked, how it went, what came out.

    runs/<benchmark>/<method>/seed<k>/
        config.json       what was asked: method and its settings, benchmark, fingerprint, seed
        environment.json  versions, device, machine
        metrics.jsonl     a row a training step
        checkpoint/       state of an unfinished training
        training.json     whether the training drew from its generator
        model/            what `Method.save` wrote
        episodes.parquet  a row a task
        summary.json      success and what else is measured, by split and kind
        recording.rrd, episodes/  what people look at, and its record
        DONE              written last

Every file is written whole or not at all, so a run killed at any point goes on from its last
checkpoint.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import torch

from lcrl_bench import __version__
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.storage import append_text, atomic_path, read_json, write_bytes, write_json

EPISODES_FILE = "episodes.parquet"
TRAINING_FILE = "training.json"
PACKAGES = ("dm-control", "embreex", "mujoco", "numpy", "rerun-sdk", "safetensors", "torch")
"""Packages whose versions a result depends on."""


@dataclass
class RunFolder:
    """One run on disk."""

    path: Path
    _rows: list[str] = field(default_factory=list)
    _opened: bool = False

    def begin(self, config: dict[str, Any], *, device: torch.device) -> bool:
        """Say what the run is; refuse to mix it with another one in the same folder.

        Returns:
            Whether the very same run is there already, done.

        Raises:
            UsageError: If the folder holds a run of another configuration.
        """
        file = self.path / "config.json"
        if file.exists() and read_json(file) != config:
            raise UsageError(
                f"{self.path} holds another run (see its config.json). Choose another --out, or "
                "delete the folder."
            )
        write_json(file, config)
        if not self.done:
            write_json(self.path / "environment.json", environment(device))
        return self.done

    @property
    def done(self) -> bool:
        """Whether the run came to its end."""
        return (self.path / "DONE").exists()

    @property
    def checkpoint(self) -> Path:
        """Where an unfinished training keeps its state."""
        return self.path / "checkpoint"

    @property
    def model(self) -> Path:
        """Where the fitted method is saved."""
        return self.path / "model"

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

    def write_episodes(
        self,
        outcomes: Sequence[Outcome],
        *,
        language: Mapping[str, Sequence[Outcome]] | None = None,
        file: str = EPISODES_FILE,
    ) -> None:
        """Write `episodes.parquet`: a row a task.

        Args:
            outcomes: Of the tasks' own commands.
            language: Control → outcomes under its sentences; each becomes a column of successes,
                empty for the tasks that it leaves out.
            file: Another name, for what another optimizer made of the same run.
        """
        controls = {
            f"success_{name.replace('-', '_')}": {row.task.id: row.success for row in rows}
            for name, rows in (language or {}).items()
        }
        rows = [
            episode_row(outcome)
            | {column: found.get(outcome.task.id) for column, found in controls.items()}
            for outcome in outcomes
        ]
        table = pa.Table.from_pylist(rows)
        with atomic_path(self.path / file) as temporary:
            pq.write_table(table, temporary)

    def finish(self, summary: dict[str, Any]) -> None:
        """Write `summary.json`, then the mark that the run is done."""
        write_json(self.path / "summary.json", summary)
        write_bytes(self.path / "DONE", b"")

    def summary(self) -> dict[str, Any]:
        """The summary of a finished run."""
        return read_json(self.path / "summary.json")


def episode_row(outcome: Outcome) -> dict[str, Any]:
    """What came of one task, as a flat row."""
    task = outcome.task
    return {
        "task": task.id,
        "split": task.split.value,
        "kind": task.kind.value,
        "house": task.house,
        "command": task.command,
        "success": outcome.success,
        "final_success": outcome.final_success,
        "path_weighted": outcome.path_weighted,
        "regret": outcome.regret,
        **{f"failure_{failure}": outcome.failures.get(failure) for failure in Failure},
        "optimal_length": task.proof.optimal_length,
        "random_success": task.proof.random_success,
    }


def environment(device: torch.device) -> dict[str, Any]:
    """What a result may depend on besides its configuration."""
    return {
        "lcrl_bench": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "device": str(device),
        "cores": os.cpu_count(),
        "threads": torch.get_num_threads(),
        "versions": {name: metadata.version(name) for name in PACKAGES},
    }
