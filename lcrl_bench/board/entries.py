"""The submissions of a folder by benchmark: shown with a mark, or rejected with a reason."""

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
"""Commands under which a method that uses language fails."""
MAX_SHARE_KEPT: Final = 2 / 3
"""Share of its success that a row may keep under another command and still be ranked. A method that
uses language keeps some: the way to another target may lead past the right one."""


@dataclass(frozen=True)
class Entry:
    """A submission with the outcome of its verification."""

    stem: str
    """The name of its file, without the suffix."""
    digest: str
    """SHA-256 of the file."""
    submission: Submission
    mark: Mark
    note: str
    """Reason for the mark."""

    @property
    def rankable(self) -> bool:
        """Whether it is ranked: verified, uses language, no draft, no oracle."""
        row = self.submission
        excluded = row.oracle or row.expert or row.draft or self.ignores_language
        return self.mark in RANKED and not excluded

    @property
    def ignores_language(self) -> bool:
        """Whether success in new houses hardly depends on the command.

        That is, more than `MAX_SHARE_KEPT` of it remains without a command, or with that of another
        task or target.
        """
        own = self.submission.figures[Split.TEST_HOUSE]["total"]
        others = [self.submission.language[each][Split.TEST_HOUSE].total for each in OTHER_COMMANDS]
        most = max((success for success in others if success is not None), default=0.0)
        return own is not None and most > MAX_SHARE_KEPT * own.mean


@dataclass(frozen=True)
class Board:
    """The rows of one benchmark."""

    benchmark: str
    fingerprint: str
    entries: tuple[Entry, ...]
    """The best in new houses first."""


@dataclass(frozen=True)
class Collection:
    """Everything the page shows."""

    boards: tuple[Board, ...]
    """In order of name."""
    refused: tuple[str, ...]
    """Rejected files, with reasons."""


def read_collection(folder: Path, benchmark_of: Callable[[str], Benchmark]) -> Collection:
    """Read every submission of a folder, each with the outcome of its verification.

    Args:
        folder: The folder.
        benchmark_of: The benchmark of a name, as it is shipped; called once per name.
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
        return "unverified", "Not re-run yet."
    found = read_verification(beside)
    if found.submission != digest:
        return "unverified", "The file was changed after it was verified."
    if submission.deterministic and found.verdict == "verified" and not found.trained:
        return "unverified", "Only retraining shows that its method is deterministic: --retrain."
    return found.verdict, _note(found)


def _note(found: Verification) -> str:
    with_what = f"with lcrl_bench {found.lcrl_bench} on {found.device} ({found.machine})"
    if found.verdict == "verified":
        done = (
            "Its seeds were retrained to the same bits"
            if found.trained
            else "Its checkpoints were re-evaluated"
        )
        return f"{done} {with_what}; every figure agrees."
    if found.verdict == "reproduced":
        return f"Its seeds were retrained {with_what}; every success rate is in its interval."
    if not found.evaluated:
        return "Its checkpoints are not the submitted ones."
    count = len(found.differences)
    first = found.differences[0]
    what = f"{first.where}: {first.submitted} submitted, {first.found} found"
    return f"Re-run {with_what}: {count} figures differ; the first is {what}."
