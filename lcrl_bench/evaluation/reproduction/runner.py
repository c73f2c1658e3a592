"""Runs as jobs: a benchmark loaded once per process, then run after run."""

from __future__ import annotations

import shutil
import traceback
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.errors import LcrlError
from lcrl_bench.evaluation.finished_runs import is_done
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.run import RunSpec, run
from lcrl_bench.evaluation.session import Session, Workplace, resolve_device
from lcrl_bench.jobs.job import Job
from lcrl_bench.storage import write_bytes

FAILURE_FILE: Final = "failure.log"
"""Traceback of a run that failed by a bug, in the run's folder."""


class RunFailedError(LcrlError):
    """A run that failed by an unexpected error."""

    def __init__(self, error: Exception, log: Path) -> None:
        self.log = log
        text = f"{type(error).__name__}: {error}".splitlines()[0]
        super().__init__(f"{text} (see {log})")


@dataclass(frozen=True)
class Bench:
    """What runs share: the benchmark, and where and how they are computed."""

    benchmark: str
    """A shipped benchmark's name, or a folder."""
    fingerprint: str
    out: str
    device: str = "auto"
    renderer: str = "auto"
    fresh: bool = False

    def session(self) -> Session:
        """Read the benchmark; its houses are loaded on first use."""
        place = Workplace(
            Path(self.out),
            resolve_device(self.device),
            renderer=self.renderer,
            fresh=self.fresh,
        )
        return Session(read_benchmark(benchmark_folder(self.benchmark)), place)


def run_jobs_of(bench: Bench, specs: Mapping[str, RunSpec]) -> list[Job]:
    """Runs by name as jobs, each after its training. They are kept in their own folders.

    Runs of one image size follow each other, as a session keeps the views of one size.
    """
    function = f"{__name__}:run_job"
    ordered = sorted(specs.items(), key=lambda item: item[1].image_size or (0, 0))
    return [
        Job(
            name,
            function,
            {"bench": asdict(bench), "spec": spec_document(spec)},
            after=tuple({spec.training.key} & specs.keys() - {name}),
            kept=False,
        )
        for name, spec in ordered
    ]


def run_job(arguments: Mapping[str, Any], tell: Callable[[float], None]) -> None:
    """The function of the jobs of `run_jobs_of`."""
    make_run(spec_of(arguments["spec"]), _session(Bench(**arguments["bench"])), tell)


@lru_cache(maxsize=1)
def _session(bench: Bench) -> Session:
    """The session that the jobs of this process share."""
    return bench.session()


def spec_document(spec: RunSpec) -> dict[str, Any]:
    """A spec as a JSON value; its method is found again by name."""
    return {
        "method": spec.method,
        "seed": spec.seed,
        "preset": spec.preset,
        "settings": dict(spec.settings),
        "image_size": spec.image_size and list(spec.image_size),
        "optimizer": spec.optimizer.value,
        "budget": spec.budget,
        "dqn_tasks": spec.dqn_tasks,
        "control": spec.control,
    }


def spec_of(document: Mapping[str, Any]) -> RunSpec:
    """The spec of a `spec_document`."""
    size = document["image_size"]
    return RunSpec.of(
        document["method"],
        document["settings"],
        seed=document["seed"],
        preset=document["preset"],
        image_size=None if size is None else (size[0], size[1]),
        optimizer=Optimizer(document["optimizer"]),
        budget=document["budget"],
        dqn_tasks=document["dqn_tasks"],
        control=document["control"],
    )


def make_run(spec: RunSpec, session: Session, tell: Callable[[float], None]) -> None:
    """Do a run; afterwards `finished_runs.is_done` is true for it.

    Args:
        spec: The run.
        session: The benchmark and the output folder. Torch's threads are set to one: a process
            per core fills the machine.
        tell: Called with the fraction done.

    Raises:
        LcrlError: If it can't be done.
    """
    torch.set_num_threads(1)
    out, benchmark = session.place.out, session.benchmark
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
        if not spec.control and not session.place.fresh:
            # Before houses are loaded, so that a mistyped name fails at once.
            folder.check(spec.training.identity(benchmark, session.place))
        run(spec, session, log=log_row, tell=tell)
        # A replay memory takes hundreds of megabytes, and a finished run needs none.
        shutil.rmtree(folder.checkpoint, ignore_errors=True)
    except (LcrlError, BrokenPipeError, ConnectionResetError):
        raise
    except Exception as error:
        write_bytes(log, "".join(traceback.format_exception(error)).encode("utf-8", "replace"))
        raise RunFailedError(error, log) from error
