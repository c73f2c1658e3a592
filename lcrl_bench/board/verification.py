"""Verification of a submission: its checkpoints evaluated again, every figure compared.

An evaluation samples nothing, so equal checkpoints on equal machines give equal figures to the bit;
`TOLERANCE` covers other orders of summation on other machines. It is below what one task more or
less changes in a table of up to 100,000 tasks, so it hides no task.

Without checkpoints the seeds are trained again: equal settings and seeds give the same bits on one
machine with the same versions. On another they give other bits, and then every success must lie in
its submitted interval: such a row is reproduced.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.board.admission import TOLERANCE
from lcrl_bench.board.checkpoints import checkpoint_folder, listed_files
from lcrl_bench.board.collection import shared_tables
from lcrl_bench.board.document import Submission
from lcrl_bench.board.verdict import MAX_DIFFERENCES, Difference, Verification, compare
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.environment import environment
from lcrl_bench.evaluation.harness import Sentences, evaluate_each, own_command
from lcrl_bench.evaluation.independence import dependence_of
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.results import COLUMNS, TABLES, Results
from lcrl_bench.evaluation.run import Run, RunSpec, run
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.session import Session
from lcrl_bench.evaluation.settings import make_method, settings_document
from lcrl_bench.methods.contract import Log, Method, Policy, Reward
from lcrl_bench.methods.registry import method_registry, resolve_method
from lcrl_bench.storage import json_place, sha256_of

SHARED: Final = {"figures", "measures", "failures", "language", "controls"}


@dataclass(frozen=True)
class Claim:
    """A submission, and what it is verified with."""

    submission: Submission
    file: Path
    method: type[Method]
    runs: Path | None = None
    """Where checkpoints are; None: where the submission says."""
    retrain: bool = False
    """Train every seed again, where the session writes, instead of taking checkpoints."""


def trusted_method(submission: Submission, named: str | None, file: Path) -> type[Method]:
    """The class that a submission's checkpoints are loaded with.

    Args:
        submission: The submission.
        named: A method or `path/to/file.py:Class`, from a person who has read its code; None: the
            registered method of the submission's name.
        file: The submission's file, for messages.

    Raises:
        UsageError: If the suite does not know the method and none was named.
    """
    if named is not None:
        return resolve_method(named)
    if not submission.registered or submission.method not in method_registry():
        where = f" Its code is said to be at {submission.code!r}." if submission.code else ""
        raise UsageError(
            f"{file}: method '{submission.method}' is not registered here.{where} To load it is to "
            "run its code: read it first, then name it: --method path/to/file.py:Class."
        )
    return resolve_method(submission.method)


def check_fingerprint(submission: Submission, benchmark: Benchmark, file: Path) -> None:
    """Refuse a submission about another benchmark.

    Raises:
        InvalidFileError: If its fingerprint is not the benchmark's.
    """
    if (submission.benchmark, submission.fingerprint) == (benchmark.name, benchmark.fingerprint):
        return
    reason = (
        f"made on {submission.benchmark} {submission.fingerprint[:12]}, "
        f"not on {benchmark.name} {benchmark.fingerprint[:12]}"
    )
    fix = "Figures of other tasks are never ranked together: run and submit it again."
    raise InvalidFileError(file, reason, where="fingerprint", fix=fix)


def verify(
    claim: Claim,
    session: Session,
    *,
    progress: Callable[[str], None] = lambda _: None,
    show: Callable[[Run], None] = lambda _: None,
) -> Verification:
    """Evaluate a submission's checkpoints again, and compare.

    A checkpoint is loaded only if its files are the submitted ones, or were trained here.

    Args:
        claim: The submission.
        session: The benchmark as it is shipped, and where to train and evaluate. No house is
            loaded if checkpoints are not the submitted ones.
        progress: Told each seed that is done.
        show: Given the first seed's run, to record it.

    Raises:
        InvalidFileError: If the submission is about another benchmark, or a checkpoint is missing.
    """
    submission = claim.submission
    check_fingerprint(submission, session.benchmark, claim.file)
    specs = [_spec(claim, row.seed) for row in submission.seeds]
    folders = {
        spec.seed: run(spec, session).folder.model
        if claim.retrain
        else checkpoint_folder(submission, row, file=claim.file, runs=claim.runs)
        for spec, row in zip(specs, submission.seeds, strict=True)
    }
    others = list(_other_files(submission, folders))
    differences = list(_flags(claim))
    if claim.retrain and submission.deterministic:
        differences += _drawn(specs[0], session, folders[specs[0].seed])
    evaluated = claim.retrain or not others
    if not evaluated:
        differences = others + differences
    else:
        found, dependences = _run_again(specs, session, folders, progress, show)
        differences += dependences
        if others:
            differences += _outside(submission, found)
        else:
            differences += compare(_submitted(submission), _tables(found))
    here = environment(session.place.device)
    return Verification(
        submission=sha256_of(claim.file.read_bytes()),
        verdict="disputed" if differences else "reproduced" if others else "verified",
        evaluated=evaluated,
        trained=claim.retrain,
        tolerance=TOLERANCE,
        differences=differences[:MAX_DIFFERENCES],
        lcrl_bench=here.lcrl_bench,
        python=here.python,
        machine=here.machine,
        device=here.device,
        versions=here.versions,
    )


def retrain(claim: Claim, session: Session, seed: int, *, log: Log = lambda _: None) -> RunFolder:
    """Train a seed of a submission again, where the session writes; `verify` reads it back.

    Args:
        claim: The submission.
        session: As for `verify`.
        seed: One of the submission's.
        log: Called with each row of training metrics.

    Raises:
        InvalidFileError: As `verify` and `training_settings`.
    """
    check_fingerprint(claim.submission, session.benchmark, claim.file)
    return run(_spec(claim, seed), session, log=log).folder


def training_settings(claim: Claim) -> dict[str, str]:
    """What to set so that a training here has the submission's settings, whatever the defaults are.

    Raises:
        InvalidFileError: If the method here has settings that the submission does not know, or
            lacks some that it has.
    """
    submission = claim.submission
    method = make_method(claim.method, submission.changed, preset=submission.preset)
    here = settings_document(method)
    if strange := sorted(set(here) ^ set(submission.settings)):
        made_with = submission.seeds[0].machine.lcrl_bench
        reason = f"{submission.method} has other settings here: {', '.join(strange)}"
        fix = f"Train it with the lcrl_bench and the method that made it ({made_with})."
        raise InvalidFileError(claim.file, reason, where="settings", fix=fix)
    return {key: str(value) for key, value in submission.settings.items() if here[key] != value}


def _spec(claim: Claim, seed: int) -> RunSpec:
    """The run that the submission claims a seed to be of."""
    submission = claim.submission
    training = training_settings(claim) if claim.retrain else {}
    return RunSpec.of(
        submission.method,
        {**submission.changed, **training},
        seed=seed,
        preset=submission.preset,
        image_size=submission.image_size,
        code=claim.method,
    )


def _submitted(submission: Submission) -> dict[str, Any]:
    seeds = {
        f"seed {row.seed}": row.model_dump(mode="json", include=set(TABLES))
        for row in submission.seeds
    }
    return {**submission.model_dump(mode="json", include=SHARED), **seeds}


def _other_files(submission: Submission, folders: Mapping[int, Path]) -> Iterator[Difference]:
    """The files of checkpoints that are not the submitted ones."""
    for seed in submission.seeds:
        submitted = {file.path: file.sha256 for file in seed.files}
        found = {file.path: file.sha256 for file in listed_files(folders[seed.seed])}
        yield from compare(submitted, found, place=(f"seed {seed.seed}", "files"))


def _flags(claim: Claim) -> Iterator[Difference]:
    """Where the submission and its method's class disagree on what the method is given."""
    for name in ("oracle", "expert"):
        yield from compare(
            str(getattr(claim.submission, name)), str(getattr(claim.method, name)), place=(name,)
        )


def _drawn(spec: RunSpec, session: Session, model: Path) -> Iterator[Difference]:
    """How training with another seed differs, which it should not for a deterministic method."""
    other = run(replace(spec, seed=(spec.seed + 1) % 2**63), session).folder
    found = {
        "draws nothing": RunFolder(model.parent).deterministic and other.deterministic,
        "files": {file.path: file.sha256 for file in listed_files(other.model)},
    }
    files = {file.path: file.sha256 for file in listed_files(model)}
    yield from compare({"draws nothing": True, "files": files}, found, place=("deterministic",))


def _tables(results: Results) -> dict[str, Any]:
    """The same tables as `_submitted`, of what was found here."""
    controls = {name: each.splits() for name, each in results.beside.items()}
    seeds = {f"seed {seed}": tables for seed, tables in results.seed_tables().items()}
    return {**shared_tables(results), "controls": controls, **seeds}


def _outside(submission: Submission, results: Results) -> Iterator[Difference]:
    """Success of other checkpoints that is outside its submitted interval."""
    figures = results.figures()
    for split in Split:
        for column in COLUMNS:
            figure, now = submission.figures[split][column], figures[split.value][column]
            if figure is None:
                continue
            mean = None if now is None else now.mean
            if mean is not None and figure.low - TOLERANCE <= mean <= figure.high + TOLERANCE:
                continue
            place = json_place(("figures", split.value, column))
            said = f"{figure.mean} [{figure.low}, {figure.high}]"
            yield Difference(where=place, submitted=said, found=mean)


def _run_again(
    specs: Sequence[RunSpec],
    session: Session,
    folders: Mapping[int, Path],
    progress: Callable[[str], None],
    show: Callable[[Run], None],
) -> tuple[Results, list[Difference]]:
    """The results of checkpoints beside the controls, and what answers should not depend on."""
    sets = session.task_sets(specs[0].image_size)
    said = {"command": own_command, **language_controls(sets)}
    dependences: list[Difference] = []
    runs: list[Results] = []
    for spec in specs:
        folder = folders[spec.seed]
        learned = spec.method_class().learns.load(folder)
        language = evaluate_each(learned, sets, said)
        outcomes = language.pop("command")
        results = Results.of(spec.method, spec.seed, outcomes, language=language)
        dependences += _dependences(learned, sets, said, spec.seed)
        if not runs:
            show(Run(spec, RunFolder(folder.parent), learned, results))
        runs.append(results)
        progress(f"seed {spec.seed}")
    return replace(Results.join(runs), beside=session.controls()), dependences


def _dependences(
    learned: Reward | Policy,
    sets: Sequence[TaskSet],
    said: Mapping[str, Sentences],
    seed: int,
) -> Iterator[Difference]:
    """What the answers of a seed depend on besides what is seen and said.

    All houses that the rank is about are tested, and as many others, drawn at random.
    """
    generator = torch.Generator().manual_seed(seed)
    houses = by_house(sets)
    ranked = [k for k, house in enumerate(houses) if _bears_rank(house)]
    others = [k for k, house in enumerate(houses) if not _bears_rank(house)]
    lot = torch.randperm(len(others), generator=generator)[: len(ranked)].tolist()
    for k in sorted([*ranked, *(others[n] for n in lot)]):
        tasks = [task for tasks in houses[k] for task in tasks.tasks]
        views = houses[k][0].views
        texts = [text for task in tasks for of in said.values() if (text := of(task)) is not None]
        found = dependence_of(learned, views.observed, texts, generator=generator)
        if found:
            yield Difference(
                where=f"seed {seed}.{views.house}.answers",
                submitted="depend on what is seen and said",
                found=f"depend on {found}",
            )


def _bears_rank(house: Sequence[TaskSet]) -> bool:
    return any(task.split == Split.TEST_HOUSE for tasks in house for task in tasks.tasks)
