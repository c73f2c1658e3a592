"""What a worker does: a benchmark compiled once, then job after job."""

from __future__ import annotations

import shutil
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.errors import LcrlError, UnknownNameError
from lcrl_bench.evaluation.problems import Problem, compile_problems
from lcrl_bench.evaluation.reproduction.experiments import ImageSize, Optimizer
from lcrl_bench.evaluation.reproduction.jobs import Job, is_done, request_of
from lcrl_bench.evaluation.reproduction.reoptimization import optimize_again
from lcrl_bench.evaluation.run import (
    control_evaluations,
    control_tables,
    resolve_device,
    run_seed,
)
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.summary import split_table
from lcrl_bench.storage import write_bytes

FAILURE_FILE = "failure.log"
"""In the folder of a run that failed by a bug: the traceback."""

Tell = Callable[[float], None]


@dataclass(frozen=True)
class Workplace:
    """What every job of a reproduction shares."""

    benchmark: str
    """A shipped benchmark's name, or a folder."""
    out: Path
    device: str = "auto"
    renderer: str = "auto"
    fresh: bool = False
    """Set aside runs of another identity that are in the way."""


class RunFailedError(LcrlError):
    """A job ended by an error that nobody raised on purpose."""

    def __init__(self, error: Exception, log: Path) -> None:
        self.log = log
        text = f"{type(error).__name__}: {error}".splitlines()[0]
        super().__init__(f"{text} (see {log})")


class Runner:
    """Does jobs on one benchmark, in one process."""

    def __init__(self, place: Workplace) -> None:
        """Read the benchmark; its houses are compiled when they are first needed."""
        # One thread a worker: as many workers as cores fill the machine.
        torch.set_num_threads(1)
        self._place = place
        self._device = resolve_device(place.device)
        self._benchmark = read_benchmark(benchmark_folder(place.benchmark))
        self._size: ImageSize | None = None
        self._problems: tuple[Problem, ...] | None = None
        self._controls: dict[str, Any] | None = None

    def __call__(self, job: Job, tell: Tell) -> None:
        """Do a job: afterwards `jobs.is_done` says so.

        Raises:
            LcrlError: If it can't be done.
        """
        folder = job.folder(self._place.out, self._benchmark)
        log = folder.path / FAILURE_FILE
        try:
            log.unlink(missing_ok=True)
            self._perform(job, folder, tell)
        except (LcrlError, BrokenPipeError, ConnectionResetError):
            raise
        except Exception as error:
            write_bytes(log, "".join(traceback.format_exception(error)).encode("utf-8", "replace"))
            raise RunFailedError(error, log) from error

    def _perform(self, job: Job, folder: RunFolder, tell: Tell) -> None:
        # What is done by another computer's kernel or device is done: see `is_done`.
        if is_done(job, self._place.out, self._benchmark):
            return
        if job.optimizer != Optimizer.Q_ITERATION:
            # Two optimizers may work beside one run: each locks its own file.
            self._optimize_again(job, folder, tell)
            return
        with folder.locked():
            if job.control:
                self._run_control(job, folder)
            else:
                self._train(job, folder, tell)

    def _train(self, job: Job, folder: RunFolder, tell: Tell) -> None:
        # The method is made before houses are compiled: a mistyped name should not take a minute.
        request = request_of(
            job,
            self._benchmark,
            self._place.out,
            device=self._device,
            renderer=self._place.renderer,
            fresh=self._place.fresh,
        )
        if not request.fresh:
            folder.check(request.config(job.seed))
        problems = self._compiled(job.image_size)

        def log(row: dict[str, Any]) -> None:
            if row.get("steps"):
                tell(row.get("step", 0) / row["steps"])

        result = run_seed(request, problems, job.seed, log=log, folder=folder)
        if not folder.done:
            if self._controls is None:
                self._controls = control_tables(self._benchmark, problems)
            folder.finish({**result.summary, "controls": self._controls})
        # A memory of transitions takes hundreds of megabytes, and a finished run needs none.
        shutil.rmtree(folder.checkpoint, ignore_errors=True)

    def _run_control(self, job: Job, folder: RunFolder) -> None:
        config = job.config(self._benchmark, {})
        if folder.begin(config, device=self._device, fresh=self._place.fresh):
            return
        controls = control_evaluations(self._benchmark, self._compiled(None))
        if job.method not in controls:
            raise UnknownNameError("control", job.method, controls)
        began = time.perf_counter()
        outcomes = controls[job.method]()
        folder.write_episodes(outcomes)
        folder.finish(
            {
                "benchmark": self._benchmark.name,
                "fingerprint": self._benchmark.fingerprint,
                "method": job.method,
                "splits": split_table(outcomes),
                "wall_s": round(time.perf_counter() - began, 3),
            }
        )

    def _optimize_again(self, job: Job, folder: RunFolder, tell: Tell) -> None:
        request = request_of(job, self._benchmark, self._place.out, device=self._device)
        learned = request.method_class.learns.load(folder.model)
        optimize_again(job, folder, learned, self._compiled(job.image_size), tell=tell)

    def _compiled(self, size: ImageSize | None) -> Sequence[Problem]:
        """The houses with views of a size; one size is kept, to bound memory."""
        if self._problems is None or self._size != size:
            self._problems = None
            more: dict[str, Any] = {} if size is None else {"image_size": size}
            self._problems = compile_problems(
                self._benchmark, device=self._device, renderer=self._place.renderer, **more
            )
            self._size = size
        return self._problems
