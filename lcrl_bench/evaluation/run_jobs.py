"""Runs as jobs: a benchmark loaded once per process, then run after run."""

from __future__ import annotations

import shutil
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from functools import lru_cache
from itertools import count
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.errors import ExitCode, InvalidFileError, LcrlError
from lcrl_bench.evaluation.controls import CONTROLS
from lcrl_bench.evaluation.environment import other_versions
from lcrl_bench.evaluation.finished_runs import is_done
from lcrl_bench.evaluation.optimizers import Optimizer, optimizer_files
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run import Run, RunSpec, run
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.session import Session, Workplace, resolve_device
from lcrl_bench.jobs.job import Job, Tell
from lcrl_bench.storage import write_bytes

FAILURE_FILE: Final = "failure.log"
"""Traceback of a run that failed by a bug, in the run's folder."""


class RunFailedError(LcrlError):
    """A run that failed by an unexpected error."""

    exit_code = ExitCode.BUG

    def __init__(self, error: Exception, log: Path) -> None:
        self.log = log
        text = f"{type(error).__name__}: {error}".splitlines()[0]
        super().__init__(f"{text} (see {log})")


@dataclass(frozen=True)
class SessionSpec:
    """What runs share, as JSON values: the benchmark, and where and how they are computed."""

    benchmark: str
    """A shipped benchmark's name, or a folder."""
    out: str
    device: str = "auto"
    threads: int = 1
    renderer: str = "auto"
    fresh: bool = False
    fingerprint: str = ""
    """The benchmark's: one that was changed is opened again. Empty if it isn't known yet."""

    def place(self) -> Workplace:
        """Where runs are written and how they are computed, on this machine."""
        device = resolve_device(self.device)
        return Workplace(Path(self.out), device, self.threads, self.renderer, self.fresh)

    def open(self) -> Session:
        """Read the benchmark; its houses are loaded on first use."""
        return Session(read_benchmark(benchmark_folder(self.benchmark)), self.place())


@dataclass(frozen=True)
class FinishedRun:
    """A finished run, as its job answers it."""

    method: str
    seed: int
    optimizer: str
    folder: str
    """The folder of its training."""
    episodes: str
    """The file of its results."""
    read_back: str = ""
    """When it finished, in ISO format, if it was there before."""
    aside: str = ""
    """Where the run was moved that had been in its folder."""
    versions: tuple[str, ...] = ()
    """What it was made with, where that differs from what is installed here: `"torch 2.7.0"`."""


def joined_results(runs: Sequence[FinishedRun]) -> Results:
    """Results of finished runs of all seeds; errors as `Results.read`.

    Runs of other optimizers than exact planning are rows of their own, and the controls of the
    benchmark stand beside.
    """
    exact = [each for each in runs if each.optimizer == Optimizer.Q_ITERATION]
    others = [each for each in runs if each.optimizer != Optimizer.Q_ITERATION]
    rows: dict[str, list[FinishedRun]] = {}
    for each in others:
        rows.setdefault(f"{each.method}, {each.optimizer}", []).append(each)
    first = RunFolder(Path(exact[0].folder))
    return replace(
        _read(exact),
        optimized={name: _read(row) for name, row in rows.items()},
        beside={name: Results.read(name, {0: first.control_file(name)}) for name in CONTROLS},
    )


def _read(runs: Sequence[FinishedRun]) -> Results:
    return Results.read(runs[0].method, {each.seed: Path(each.episodes) for each in runs})


def check_job(session: SessionSpec, specs: Mapping[str, RunSpec]) -> Job:
    """Whether runs can be made, before any house is loaded; its function is `check_runs`."""
    documents = {name: spec_document(spec) for name, spec in specs.items()}
    arguments = {"session": asdict(session), "specs": documents}
    return Job("check", f"{__name__}:check_runs", arguments, kept=False)


def check_runs(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of a `check_job`.

    Returns:
        `"benchmark"` and `"fingerprint"`, and as `"missing"` the names of runs that aren't done.

    Raises:
        LcrlError: If a method or setting is invalid, or another run is in the way.
    """
    session = SessionSpec(**arguments["session"])
    benchmark, place = read_benchmark(benchmark_folder(session.benchmark)), session.place()
    specs = {name: spec_of(document) for name, document in arguments["specs"].items()}
    for number, spec in enumerate(specs.values()):
        identity = spec.training.identity(benchmark, place)
        spec.folder(place.out, benchmark).check(identity, fresh=place.fresh)
        tell((number + 1) / len(specs))
    missing = [name for name, spec in specs.items() if not is_done(spec, place.out, benchmark)]
    known = {"benchmark": benchmark.name, "fingerprint": benchmark.fingerprint}
    return {**known, "missing": missing}


def run_jobs_of(
    session: SessionSpec, specs: Mapping[str, RunSpec], *, any_computer: bool = False
) -> list[Job]:
    """Runs by name as jobs, each after its training. They are kept in their own folders.

    Runs of one image size follow each other, as a session keeps the views of one size.

    Args:
        session: What they share.
        specs: The runs.
        any_computer: Whether runs finished with another kernel or device count as done.
    """
    function = f"{__name__}:run_job"
    ordered = sorted(specs.items(), key=lambda item: item[1].image_size or (0, 0))
    common = {"session": asdict(session), "any_computer": any_computer}
    return [
        Job(
            name,
            function,
            {**common, "spec": spec_document(spec)},
            after=tuple({spec.training.key} & specs.keys() - {name}),
            kept=False,
        )
        for name, spec in ordered
    ]


def run_job(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of the jobs of `run_jobs_of`; answers with a `FinishedRun`."""
    session = shared_session(SessionSpec(**arguments["session"]))
    spec, any_computer = spec_of(arguments["spec"]), bool(arguments["any_computer"])
    return asdict(make_run(spec, session, tell, any_computer=any_computer))


@lru_cache(maxsize=1)
def shared_session(session: SessionSpec) -> Session:
    """The session that the jobs of this process share."""
    return session.open()


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


def make_run(
    spec: RunSpec, session: Session, tell: Tell, *, any_computer: bool = False
) -> FinishedRun:
    """Do a run; afterwards `finished_runs.is_done` is true for it.

    Args:
        spec: The run.
        session: The benchmark and the output folder.
        tell: Told how far it has got.
        any_computer: Whether a run finished with another kernel or device counts as done.

    Raises:
        LcrlError: If it can't be done.
    """
    place, benchmark = session.place, session.benchmark
    torch.set_num_threads(place.threads or torch.get_num_threads())
    folder = spec.folder(place.out, benchmark)
    log = folder.path / FAILURE_FILE

    def log_row(row: dict[str, Any]) -> None:
        if steps := row.get("steps"):
            tell(row.get("step", 0) / steps, _note_of(row))

    try:
        log.unlink(missing_ok=True)
        if any_computer and is_done(spec, place.out, benchmark):
            return _finished(spec, folder, folder.finished)
        identity = spec.training.identity(benchmark, place)
        if not spec.control and not place.fresh:
            # Before houses are loaded, so that a mistyped name fails at once.
            folder.check(identity)
        if not folder.holds(identity):
            session.task_sets(spec.image_size, progress=_houses(session, tell))
        began = time.time()
        found = run(spec, session, log=log_row, tell=tell)
        if found.read_back and not _has_controls(folder):
            folder.write_controls(session.controls())
        # A replay memory takes hundreds of megabytes, and a finished run needs none.
        shutil.rmtree(folder.checkpoint, ignore_errors=True)
        return _finished(spec, found.folder, _read_back(found, began))
    except (LcrlError, BrokenPipeError, ConnectionResetError):
        raise
    except Exception as error:
        write_bytes(log, "".join(traceback.format_exception(error)).encode("utf-8", "replace"))
        raise RunFailedError(error, log) from error


def _has_controls(folder: RunFolder) -> bool:
    """Whether the results of the controls are those of the summary; an older run has none."""
    try:
        expected = folder.summary()["controls"]
        found = {name: Results.read(name, {0: folder.control_file(name)}) for name in CONTROLS}
        return all(found[name].splits() == expected[name] for name in CONTROLS)
    except (InvalidFileError, KeyError):
        return False


def _finished(spec: RunSpec, folder: RunFolder, read_back: datetime | None) -> FinishedRun:
    _, episodes = optimizer_files(folder, spec.optimizer)
    return FinishedRun(
        spec.method,
        spec.seed,
        spec.optimizer.value,
        folder=str(folder.path),
        episodes=str(episodes),
        read_back="" if read_back is None else read_back.isoformat(),
        aside=str(folder.aside or ""),
        versions=() if read_back is None else other_versions(folder.path),
    )


def _read_back(found: Run, began: float) -> datetime | None:
    """When a run finished that was there before; None if it was made since `began`."""
    if found.spec.optimizer == Optimizer.Q_ITERATION:
        return found.read_back
    summary, _ = optimizer_files(found.folder, found.spec.optimizer)
    finished = summary.stat().st_mtime
    return datetime.fromtimestamp(finished).astimezone() if finished < began else None


def _note_of(row: Mapping[str, Any]) -> str:
    """The metrics of a row of the log, as text."""
    if row.get("step", 0) >= row["steps"]:
        return "evaluating"
    shown = {key: value for key, value in row.items() if isinstance(value, float)}
    return ", ".join(f"{key} {value:.3f}" for key, value in shown.items())


def _houses(session: Session, tell: Tell) -> Callable[[str], None]:
    """Tell of each house that is loaded."""
    numbers, total = count(1), len(session.benchmark.houses)
    return lambda _: tell(0.0, f"house {next(numbers)} of {total}")
