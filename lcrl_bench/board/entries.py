"""The submissions of a folder by benchmark: what is shown, how it is marked, what is refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.admission import read_submission
from lcrl_bench.board.document import Submission
from lcrl_bench.board.verdict import SUFFIX, Verification, read_verification, verification_file
from lcrl_bench.board.verification import check_fingerprint
from lcrl_bench.errors import LcrlError
from lcrl_bench.evaluation.language import Control
from lcrl_bench.names import check_name
from lcrl_bench.storage import sha256_of

Mark = Literal["verified", "reproduced", "disputed", "unverified"]
RANKED: Final[frozenset[Mark]] = frozenset({"verified", "reproduced"})
OTHER_COMMANDS: Final = (Control.BLANK, Control.SHUFFLED, Control.WRONG_TARGET)
"""What a method that listens fails under."""
KEPT: Final = 2 / 3
"""Share of its success that a row may keep under another command and still bear a rank. A method
that listens keeps some: the way to another target may lead past the right one."""


@dataclass(frozen=True)
class Entry:
    """A submission, and what is known of it."""

    stem: str
    """The name of its file, without the suffix."""
    digest: str
    """SHA-256 of the file."""
    submission: Submission
    mark: Mark
    note: str
    """Why it is marked so."""

    @property
    def rankable(self) -> bool:
        """Whether it bears a rank: run again, listens, no draft, not given what others are not."""
        oracle = self.submission.oracle or self.submission.expert
        listens = not self.ignores_language
        return self.mark in RANKED and listens and not self.submission.draft and not oracle

    @property
    def ignores_language(self) -> bool:
        """Whether success in new houses hardly depends on the command.

        That is, more than `KEPT` of it is left without a command, or under that of another task,
        or of another target.
        """
        own = self.submission.figures[Split.TEST_HOUSE]["total"]
        told = [self.submission.language[each][Split.TEST_HOUSE].total for each in OTHER_COMMANDS]
        most = max((success for success in told if success is not None), default=0.0)
        return own is not None and most > KEPT * own.mean


@dataclass(frozen=True)
class Board:
    """The rows of one benchmark."""

    benchmark: str
    fingerprint: str
    entries: tuple[Entry, ...]
    """The best in new houses first."""


@dataclass(frozen=True)
class Collection:
    """Everything a page shows."""

    boards: tuple[Board, ...]
    """In order of name."""
    refused: tuple[str, ...]
    """Why each file that is no entry is none."""


def read_collection(folder: Path, benchmark_of: Callable[[str], Benchmark]) -> Collection:
    """Read every submission of a folder, each with what came of its verification.

    Args:
        folder: Where they are.
        benchmark_of: The benchmark of a name, as it is shipped; called once a name.
    """
    known: dict[str, Benchmark] = {}
    rows: dict[str, list[Entry]] = {}
    refused: list[str] = []
    for path in submission_files(folder):
        try:
            # Its name becomes part of links.
            check_name("submission", path.stem)
            submission = read_submission(path)
            name = submission.benchmark
            known[name] = known.get(name) or benchmark_of(name)
            check_fingerprint(submission, known[name], path)
            digest = sha256_of(path.read_bytes())
            entry = Entry(path.stem, digest, submission, *_mark(path, digest, submission))
            rows.setdefault(name, []).append(entry)
        except LcrlError as error:
            # The page is for others: it names the file, not where it lies here.
            reason = str(error).replace(str(path), path.name, 1)
            refused.append(reason if path.name in reason else f"{path.name}: {reason}")
    boards = [
        Board(name, known[name].fingerprint, tuple(sorted(rows[name], key=_order)))
        for name in sorted(rows)
    ]
    return Collection(tuple(boards), tuple(refused))


def submission_files(folder: Path) -> Sequence[Path]:
    """The files of a folder that should be submissions."""
    return [path for path in sorted(folder.glob("*.json")) if not path.name.endswith(SUFFIX)]


def _order(entry: Entry) -> tuple[float, str]:
    house = entry.submission.figures[Split.TEST_HOUSE]["total"]
    return (1.0 if house is None else -house.mean, entry.stem)


def _mark(path: Path, digest: str, submission: Submission) -> tuple[Mark, str]:
    beside = verification_file(path)
    if not beside.exists():
        return "unverified", "Nobody has run it again yet."
    found = read_verification(beside)
    if found.submission != digest:
        return "unverified", "The file was changed after it was verified."
    if submission.deterministic and found.verdict == "verified" and not found.trained:
        return "unverified", "That its method draws nothing is shown by training alone: --retrain."
    return found.verdict, _note(found)


def _note(found: Verification) -> str:
    with_what = f"with lcrl_bench {found.lcrl_bench} on {found.device} ({found.machine})"
    if found.verdict == "verified":
        done = (
            "Its seeds were trained again to the same bits"
            if found.trained
            else "Its checkpoints were evaluated again"
        )
        return f"{done} {with_what}; every figure agrees."
    if found.verdict == "reproduced":
        return f"Its seeds were trained again {with_what}; every success is in its interval."
    if not found.evaluated:
        return "Its checkpoints are not the submitted ones."
    count = len(found.differences)
    first = found.differences[0]
    what = f"{first.where}: {first.submitted} submitted, {first.found} found"
    return f"Run again {with_what}, {count} figures differ; the first is {what}."
