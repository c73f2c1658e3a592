"""Reading a submission from its file, with cross-field checks."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.document import LEAST_SEEDS, Estimated, Submission
from lcrl_bench.documents import parse_document
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.results import COLUMNS
from lcrl_bench.storage import read_json

TOLERANCE: Final = 1e-3
"""Percentage points by which figures that should be equal may differ."""
MAX_BYTES: Final = 1024 * 1024
AGAIN: Final = "Write it again: lcrl-bench submit runs/<benchmark>/<method>"


def read_submission(path: Path) -> Submission:
    """Read a submission.

    Raises:
        InvalidFileError: If it is none, or `check_submission` refuses it.
    """
    value = read_json(path, max_bytes=MAX_BYTES)
    submission = parse_document(Submission, value, path=path, kind="a submission", fix=AGAIN)
    check_submission(submission, path)
    return submission


def check_submission(submission: Submission, path: Path) -> None:
    """Cross-field checks.

    Raises:
        InvalidFileError: If a seed is listed twice, there are too few seeds (one is enough for a
            deterministic method), two seeds have the same checkpoint, or the
            figures are not those of the seeds.
    """
    _check_seeds(submission, path)
    _check_checkpoints(submission, path)
    for where, reason in _contradictions(submission):
        fix = f"The figures of a row are the means over its seeds. {AGAIN}"
        raise InvalidFileError(path, reason, where=where, fix=fix)


def _check_seeds(submission: Submission, path: Path) -> None:
    seeds = [row.seed for row in submission.seeds]
    if len(set(seeds)) < len(seeds):
        raise InvalidFileError(path, f"a seed stands there twice: {seeds}", fix=AGAIN)
    if submission.deterministic:
        if len(seeds) > 1:
            reason = f"{len(seeds)} seeds of a method that draws nothing"
            fix = f"They are all the same: one counts for all. {AGAIN}"
            raise InvalidFileError(path, reason, where="seeds", fix=fix)
        return
    if len(seeds) < LEAST_SEEDS and not submission.draft:
        reason = f"{len(seeds)} of {LEAST_SEEDS} seeds"
        fix = "Run more: lcrl-bench run --seeds 0 1 2. Or submit with --draft: shown, not ranked."
        raise InvalidFileError(path, reason, where="seeds", fix=fix)


def _check_checkpoints(submission: Submission, path: Path) -> None:
    owners: dict[frozenset[tuple[str, str]], int] = {}
    for row in submission.seeds:
        content = frozenset((file.path, file.sha256) for file in row.files)
        if content in owners:
            reason = f"seeds {owners[content]} and {row.seed} have the same checkpoint"
            fix = (
                "A copy is no seed: train each. (Of a method that draws nothing `submit` takes one "
                "seed for all.)"
            )
            raise InvalidFileError(path, reason, where="seeds", fix=fix)
        owners[content] = row.seed


def _contradictions(submission: Submission) -> Iterator[tuple[str, str]]:
    """Where figures contradict those of the seeds: (place, what is wrong)."""
    for split in Split:
        for column in COLUMNS:
            figure = submission.figures[split][column]
            seeds = [getattr(row.splits[split], column) for row in submission.seeds]
            where = f"figures.{split.value}.{column}"
            if (figure is None) != (None in seeds):
                yield where, "a figure and no task, or tasks and no figure"
            elif figure is not None:
                yield from ((where, reason) for reason in _wrong(figure, seeds))
        total = submission.figures[split]["total"]
        tasks = sum(row.splits[split].n for row in submission.seeds)
        if total is not None and total.n != tasks:
            yield f"figures.{split.value}.total.n", f"n is {total.n}, its seeds have {tasks} tasks"


def _wrong(figure: Estimated, seeds: list[float]) -> Iterator[str]:
    mean = math.fsum(seeds) / len(seeds)
    if abs(figure.mean - mean) > TOLERANCE:
        yield f"{figure.mean} is not the mean of its seeds, {mean:.4f}"
    if not figure.low - TOLERANCE <= figure.mean <= figure.high + TOLERANCE:
        yield f"{figure.mean} is outside its interval [{figure.low}, {figure.high}]"
