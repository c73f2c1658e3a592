"""`Verification`: the outcome of re-running a submission, kept in a file beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import Field

from lcrl_bench.board.admission import TOLERANCE
from lcrl_bench.board.document import Hash, Setting
from lcrl_bench.documents import Document, Text, parse_document
from lcrl_bench.storage import json_place, read_json

SUFFIX: Final = ".verified.json"
MAX_DIFFERENCES: Final = 5_000

Verdict = Literal["verified", "reproduced", "disputed"]


class Difference(Document):
    """A value that differs from the submitted one."""

    where: Annotated[str, Field(max_length=400)]
    submitted: Setting
    found: Setting


class Verification(Document):
    """The outcome of a verification; it does not depend on when it was made."""

    format: Literal["lcrl-verification"] = "lcrl-verification"
    version: Literal[1] = 1
    submission: Hash
    """Of the submission's file: a file changed after it was verified is not verified."""
    verdict: Verdict
    evaluated: bool
    """Whether anything was run: not if the checkpoints are not the submitted ones."""
    trained: bool
    """Whether the checkpoints were trained again here."""
    tolerance: float
    differences: Annotated[list[Difference], Field(max_length=MAX_DIFFERENCES)]
    lcrl_bench: Text
    python: Text
    machine: Text
    device: Text
    versions: dict[Text, Text]


def verification_file(submission: Path) -> Path:
    """The file beside a submission that holds its verification."""
    return submission.with_name(f"{submission.stem}{SUFFIX}")


def read_verification(path: Path) -> Verification:
    """Read a verification.

    Raises:
        InvalidFileError: If the file holds none.
    """
    fix = "Verify again: lcrl-bench leaderboard verify SUBMISSION"
    return parse_document(Verification, read_json(path), path=path, kind="a verification", fix=fix)


def compare(
    submitted: object, found: object, *, place: tuple[str | int, ...] = ()
) -> Iterator[Difference]:
    """Everything in which two JSON values differ by more than `TOLERANCE`."""
    if isinstance(submitted, Mapping) and isinstance(found, Mapping):
        for key in dict.fromkeys([*submitted, *found]):
            yield from compare(submitted.get(key), found.get(key), place=(*place, key))
    elif not _equal(submitted, found):
        yield Difference(where=json_place(place), submitted=_short(submitted), found=_short(found))


def _equal(submitted: object, found: object) -> bool:
    if isinstance(submitted, (int, float)) and isinstance(found, (int, float)):
        # NaN equals nothing.
        return abs(submitted - found) <= TOLERANCE
    return submitted == found


def _short(value: object) -> bool | int | float | str | None:
    if value is None or isinstance(value, int) or (isinstance(value, float) and isfinite(value)):
        return value
    return str(value)[:80]
