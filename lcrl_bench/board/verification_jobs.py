"""Verification as jobs: one per submission, and with `retrain` one per seed before it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.board.admission import read_submission
from lcrl_bench.board.checkpoints import checkpoint_folder
from lcrl_bench.board.exhibits import record_exhibits
from lcrl_bench.board.verdict import verification_file
from lcrl_bench.board.verification import Claim, retrain, trusted_method, verify
from lcrl_bench.errors import LcrlError
from lcrl_bench.evaluation.run import Run
from lcrl_bench.evaluation.session import Session, Workplace, resolve_device
from lcrl_bench.jobs.job import Job
from lcrl_bench.storage import sha256_of, write_json

Tell = Callable[[float], None]


@dataclass(frozen=True)
class Means:
    """What submissions are verified with; paths as text."""

    runs: str | None = None
    """Where checkpoints are; None: where the submission says."""
    retrain: str | None = None
    """Where every seed is trained again; None: load checkpoints."""
    method: str | None = None
    """The method to load with; None: the registered one of the submission's name."""
    benchmark: str = ""
    """The folder of the benchmark; empty: the submission's shipped one."""
    recordings: str | None = None
    """Where recordings and pictures go; None: nothing is recorded."""
    device: str = "auto"
    renderer: str = "auto"


def verification_jobs(file: Path, means: Means) -> list[Job]:
    """The jobs that verify a submission; the last one, named after the file, has the verdict."""
    arguments = {"file": str(file), "means": asdict(means)}
    training: list[Job] = []
    inputs: list[Path] = []
    # What is wrong with the submission is said by the job that verifies it.
    with suppress(LcrlError):
        submission = read_submission(file)
        inputs = [file, *_method_file(means)]
        if means.retrain is None:
            runs = None if means.runs is None else Path(means.runs)
            for row in submission.seeds:
                model = checkpoint_folder(submission, row, file=file, runs=runs)
                inputs += sorted(path for path in model.rglob("*") if path.is_file())
        else:
            training = [
                Job(
                    f"{file} seed{row.seed}",
                    f"{__name__}:retrain_job",
                    {**arguments, "seed": row.seed},
                    kept=False,
                )
                for row in submission.seeds
            ]
    verdict = Job(
        str(file),
        f"{__name__}:verify_job",
        arguments,
        inputs=tuple(inputs),
        outputs=(verification_file(file),),
        after=tuple(job.name for job in training),
        kept=bool(inputs),
    )
    return [*training, verdict]


def _method_file(means: Means) -> Iterator[Path]:
    if means.method is not None and ".py:" in means.method:
        yield Path(means.method.rpartition(":")[0])


def retrain_job(arguments: Mapping[str, Any], tell: Tell) -> None:
    """Train a seed of a submission again; what can't be trained is left to `verify_job` to say."""

    def log(row: dict[str, Any]) -> None:
        if row.get("steps"):
            tell(row.get("step", 0) / row["steps"])

    with suppress(LcrlError):
        claim, session = _claim(Path(arguments["file"]), Means(**arguments["means"]))
        retrain(claim, session, arguments["seed"], log=log)


def verify_job(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Verify a submission and write the verdict beside it; returns the verdict.

    Raises:
        LcrlError: If the submission is refused.
    """
    file, means = Path(arguments["file"]), Means(**arguments["means"])
    claim, session = _claim(file, means)
    digest = sha256_of(file.read_bytes())
    seeds = len(claim.submission.seeds)
    done: list[str] = []

    def progress(seed: str) -> None:
        done.append(seed)
        tell(len(done) / seeds)

    def show(run: Run) -> None:
        if means.recordings is not None:
            folder = Path(means.recordings) / file.stem
            record_exhibits(run, session, folder, submission=digest)

    document = verify(claim, session, progress=progress, show=show).model_dump(mode="json")
    write_json(verification_file(file), document)
    return document


def _claim(file: Path, means: Means) -> tuple[Claim, Session]:
    # As in `run`: one order of summation, so that a checkpoint always gives the same bits.
    torch.set_num_threads(1)
    submission = read_submission(file)
    benchmark = read_benchmark(benchmark_folder(means.benchmark or submission.benchmark))
    method = trusted_method(submission, means.method, file)
    out = Path(means.retrain or ".")
    place = Workplace(out, device=resolve_device(means.device), renderer=means.renderer)
    runs = None if means.runs is None else Path(means.runs)
    claim = Claim(submission, file, method, runs, retrain=means.retrain is not None)
    return claim, Session(benchmark, place)
