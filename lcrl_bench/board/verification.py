"""Verification of a submission: its checkpoints evaluated again, every figure compared.

An evaluation samples nothing, so equal checkpoints on equal machines give equal figures to the bit;
`TOLERANCE` covers other orders of summation on other machines. It is below what one task more or
less changes in a table of up to 100,000 tasks, so it hides no task.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import torch
from pydantic import BaseModel, ConfigDict, Field

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.board.checkpoints import checkpoint_folder, listed_files
from lcrl_bench.board.document import Hash, Setting, Submission
from lcrl_bench.board.tables import scores_of, seed_tables, shared_tables
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.harness import evaluate_each, own_command
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.outcome import Outcome
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.evaluation.run import control_tables
from lcrl_bench.evaluation.run_folder import environment
from lcrl_bench.evaluation.settings import make_method
from lcrl_bench.houses.parsing import Text, parse_document
from lcrl_bench.methods.contract import Method
from lcrl_bench.methods.registry import method_registry, resolve_method
from lcrl_bench.storage import json_place, read_json, sha256_of

TOLERANCE: Final = 1e-3
"""Points of per cent that a figure may differ by."""
MAX_DIFFERENCES: Final = 5_000
SHARED: Final = {"figures", "measures", "failures", "language", "controls"}
OF_A_SEED: Final = {"splits", "measures", "failures", "language"}


class Difference(BaseModel):
    """One thing that is not as submitted."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    where: Annotated[str, Field(max_length=400)]
    submitted: Setting
    found: Setting


class Verification(BaseModel):
    """What came of a verification; nothing in it depends on when it was made."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal["lcrl-verification"] = "lcrl-verification"
    version: Literal[1] = 1
    submission: Hash
    """Of the submission's file: a file changed after it was verified is not verified."""
    verdict: Literal["verified", "disputed"]
    evaluated: bool
    """Whether the checkpoints were the submitted ones, so that they were evaluated."""
    tolerance: float
    differences: Annotated[list[Difference], Field(max_length=MAX_DIFFERENCES)]
    lcrl_bench: Text
    python: Text
    machine: Text
    device: Text
    versions: dict[Text, Text]


@dataclass(frozen=True)
class Claim:
    """A submission, and what it is verified with."""

    submission: Submission
    file: Path
    method: type[Method]
    runs: Path | None = None
    """Where checkpoints are; None: where the submission says."""


def verification_file(submission: Path) -> Path:
    """The file beside a submission that holds what came of its verification."""
    return submission.with_name(f"{submission.stem}.verified.json")


def read_verification(path: Path) -> Verification:
    """Read what came of a verification.

    Raises:
        InvalidFileError: If the file holds none.
    """
    fix = "Verify again: lcrl-bench leaderboard verify SUBMISSION"
    return parse_document(Verification, read_json(path), path=path, kind="a verification", fix=fix)


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
    benchmark: Benchmark,
    problems: Callable[[], Sequence[Problem]],
    *,
    device: torch.device,
    progress: Callable[[str], None] = lambda _: None,
) -> Verification:
    """Evaluate a submission's checkpoints again, and compare.

    A checkpoint is loaded only if its files are the submitted ones.

    Args:
        claim: The submission.
        benchmark: The benchmark as it is shipped.
        problems: Compiles it; not called if checkpoints are not the submitted ones.
        device: Where to evaluate.
        progress: Told each seed that is done.

    Raises:
        InvalidFileError: If the submission is about another benchmark, or a checkpoint is missing.
    """
    submission = claim.submission
    check_fingerprint(submission, benchmark, claim.file)
    folders = {
        seed.seed: checkpoint_folder(submission, seed, file=claim.file, runs=claim.runs)
        for seed in submission.seeds
    }
    differences = list(_other_files(submission, folders))
    swapped = bool(differences)
    differences += _flags(claim)
    if not swapped:
        found = _run_again(claim, benchmark, problems(), folders, progress)
        differences += compare(_submitted(submission), found)
    made_with = environment(device)
    return Verification(
        submission=sha256_of(claim.file.read_bytes()),
        verdict="disputed" if differences else "verified",
        evaluated=not swapped,
        tolerance=TOLERANCE,
        differences=differences[:MAX_DIFFERENCES],
        **{key: made_with[key] for key in ("lcrl_bench", "python", "machine", "versions")},
        device=str(device),
    )


def compare(
    submitted: object, found: object, *, place: tuple[str | int, ...] = ()
) -> Iterator[Difference]:
    """Everything in which two JSON values differ by more than `TOLERANCE`."""
    if isinstance(submitted, Mapping) and isinstance(found, Mapping):
        for key in dict.fromkeys([*submitted, *found]):
            yield from compare(submitted.get(key), found.get(key), place=(*place, key))
    elif isinstance(submitted, (int, float)) and isinstance(found, (int, float)):
        # Written so that whatever is no number differs.
        if not abs(submitted - found) <= TOLERANCE:
            yield Difference(where=json_place(place), submitted=submitted, found=found)
    elif submitted != found:
        yield Difference(where=json_place(place), submitted=_short(submitted), found=_short(found))


def _short(value: object) -> bool | int | float | str | None:
    return value if isinstance(value, (bool, int, float, type(None))) else str(value)[:80]


def _submitted(submission: Submission) -> dict[str, Any]:
    seeds = {
        f"seed {row.seed}": row.model_dump(mode="json", include=OF_A_SEED)
        for row in submission.seeds
    }
    return {**submission.model_dump(mode="json", include=SHARED), **seeds}


def _other_files(submission: Submission, folders: Mapping[int, Path]) -> Iterator[Difference]:
    """The files of checkpoints that are not the submitted ones."""
    for seed in submission.seeds:
        submitted = {file.path: file.sha256 for file in seed.files}
        found = {file["path"]: file["sha256"] for file in listed_files(folders[seed.seed])}
        yield from compare(submitted, found, place=(f"seed {seed.seed}", "files"))


def _flags(claim: Claim) -> Iterator[Difference]:
    """What the submission says its method is handed, against what its class says."""
    for name in ("oracle", "expert"):
        yield from compare(
            str(getattr(claim.submission, name)), str(getattr(claim.method, name)), place=(name,)
        )


def _run_again(
    claim: Claim,
    benchmark: Benchmark,
    problems: Sequence[Problem],
    folders: Mapping[int, Path],
    progress: Callable[[str], None],
) -> dict[str, Any]:
    """The tables of a submission, from its checkpoints."""
    submission = claim.submission
    said = {"command": own_command, **language_controls(problems)}
    runs: list[tuple[Outcome, ...]] = []
    tables: dict[str, dict[str, Any]] = {}
    for seed, folder in folders.items():
        method = make_method(claim.method, submission.changed, preset=submission.preset)
        found = evaluate_each(method.load(folder), problems, said)
        runs.append(found.pop("command"))
        tables[f"seed {seed}"] = seed_tables(runs[-1], found)
        progress(f"seed {seed}")
    controls = {
        name: {split: row for split, row in table.items() if split != "all"}
        for name, table in control_tables(benchmark, problems).items()
    }
    shared = shared_tables(list(tables.values()), scores_of(runs))
    return {**shared, "controls": controls, **tables}
