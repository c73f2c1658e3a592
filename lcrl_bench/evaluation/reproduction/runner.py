"""The job of a worker: load a benchmark once, then do run after run."""

from __future__ import annotations

import shutil
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.errors import LcrlError
from lcrl_bench.evaluation.finished_runs import is_done
from lcrl_bench.evaluation.run import RunSpec, run
from lcrl_bench.evaluation.session import Session, Workplace, resolve_device
from lcrl_bench.storage import write_bytes

FAILURE_FILE = "failure.log"
"""Traceback of a run that failed by a bug, in the run's folder."""


class RunFailedError(LcrlError):
    """A run that failed by an unexpected error."""

    def __init__(self, error: Exception, log: Path) -> None:
        self.log = log
        text = f"{type(error).__name__}: {error}".splitlines()[0]
        super().__init__(f"{text} (see {log})")


@dataclass(frozen=True)
class Bench:
    """What all runs of a worker share; pickled for another process."""

    benchmark: str
    """A shipped benchmark's name, or a folder."""
    out: Path
    device: str = "auto"
    renderer: str = "auto"
    fresh: bool = False

    def session(self) -> Session:
        """Read the benchmark; its houses are loaded on first use."""
        place = Workplace(
            self.out,
            resolve_device(self.device),
            renderer=self.renderer,
            fresh=self.fresh,
        )
        return Session(read_benchmark(benchmark_folder(self.benchmark)), place)


class Runner:
    """Does runs on one benchmark in one process; `session` need not be the bench's."""

    def __init__(self, session: Callable[[], Session]) -> None:
        """Open the session.

        Args:
            session: Opens the session; called once: `Bench(...).session`.
        """
        # One thread per worker: one worker per core fills the machine.
        torch.set_num_threads(1)
        self._session = session()

    def __call__(self, spec: RunSpec, tell: Callable[[float], None]) -> None:
        """Do a run; afterwards `finished_runs.is_done` is true for it.

        Raises:
            LcrlError: If it can't be done.
        """
        out, benchmark = self._session.place.out, self._session.benchmark
        folder = spec.folder(out, benchmark)
        log = folder.path / FAILURE_FILE

        def log_row(row: dict[str, Any]) -> None:
            if row.get("steps"):
                tell(row.get("step", 0) / row["steps"])

        try:
            log.unlink(missing_ok=True)
            # Runs finished with another kernel or device count as done.
            if is_done(spec, out, benchmark):
                return
            if not spec.control and not self._session.place.fresh:
                # Before houses are loaded, so that a mistyped name fails at once.
                folder.check(spec.training.identity(benchmark, self._session.place))
            run(spec, self._session, log=log_row, tell=tell)
            # A replay memory takes hundreds of megabytes, and a finished run needs none.
            shutil.rmtree(folder.checkpoint, ignore_errors=True)
        except (LcrlError, BrokenPipeError, ConnectionResetError):
            raise
        except Exception as error:
            write_bytes(log, "".join(traceback.format_exception(error)).encode("utf-8", "replace"))
            raise RunFailedError(error, log) from error
