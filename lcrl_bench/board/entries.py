"""The submissions of a folder as entries of a page: what is shown, how it is marked, or refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.document import Submission, read_submission
from lcrl_bench.board.verification import (
    check_fingerprint,
    read_verification,
    verification_file,
)
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.summary import KINDS
from lcrl_bench.storage import sha256_of

Mark = Literal["verified", "disputed", "unverified"]
SUFFIX: Final = ".verified.json"


@dataclass(frozen=True)
class Board:
    """Everything a page shows."""

    benchmark: str
    fingerprint: str
    entries: tuple[Entry, ...]
    """The best in new houses first."""
    refused: tuple[str, ...]
    """Why each file that is no entry is none."""


@dataclass(frozen=True)
class Entry:
    """A submission, and what is known of it."""

    stem: str
    """The name of its file, without the suffix."""
    submission: Submission
    mark: Mark
    note: str
    """Why it is marked so."""

    @property
    def rankable(self) -> bool:
        """Whether it bears a rank: verified, no draft, not given what others are not."""
        oracle = self.submission.oracle or self.submission.expert
        return self.mark == "verified" and not self.submission.draft and not oracle

    def values(self, kind: str) -> dict[str, float | str | None]:
        """What the page sorts by, for a kind of task: column → figure in per cent."""
        means = {split.value: self._mean(split, kind) for split in Split}
        train, house = means["train"], means["test-house"]
        gap = None if train is None or house is None else round(train - house, 4)
        language = self.submission.language
        said = {name.value: getattr(language[name][Split.TEST_HOUSE], kind) for name in Control}
        return {"title": self.submission.title.lower(), **means, "gap": gap, **said}

    def _mean(self, split: Split, kind: Any) -> float | None:  # noqa: ANN401 - a column's name
        figure = self.submission.figures[split][kind]
        return None if figure is None else figure.mean

    def record(self) -> dict[str, Any]:
        """What the page's program sorts, filters and ranks by."""
        row = self.submission
        changed = [f"{key}={value}" for key, value in row.changed.items()]
        words = [row.title, row.method, row.summary, row.author, row.preset, self.mark, *changed]
        return {
            "id": f"row-{self.stem}",
            "rankable": self.rankable,
            "oracle": row.oracle or row.expert,
            "mark": self.mark,
            "search": " ".join(words).lower(),
            "values": {kind: self.values(kind) for kind in KINDS},
        }


def read_board(folder: Path, benchmark: Benchmark) -> Board:
    """Read every submission of a folder, each with what came of its verification."""
    entries: list[Entry] = []
    refused: list[str] = []
    for path in submission_files(folder):
        try:
            submission = read_submission(path)
            check_fingerprint(submission, benchmark, path)
            entries.append(Entry(path.stem, submission, *_mark(path)))
        except InvalidFileError as error:
            # The page is for others: it names the file, not where it lies here.
            refused.append(str(error).replace(str(path), path.name, 1))
    entries.sort(key=_order)
    return Board(benchmark.name, benchmark.fingerprint, tuple(entries), tuple(refused))


def submission_files(folder: Path) -> Sequence[Path]:
    """The files of a folder that should be submissions."""
    return [path for path in sorted(folder.glob("*.json")) if not path.name.endswith(SUFFIX)]


def _order(entry: Entry) -> tuple[float, str]:
    house = entry.values("total")["test-house"]
    return (-house if isinstance(house, float) else 1.0, entry.stem)


def _mark(path: Path) -> tuple[Mark, str]:
    beside = verification_file(path)
    if not beside.exists():
        return "unverified", "Nobody has run it again yet."
    found = read_verification(beside)
    if found.submission != sha256_of(path.read_bytes()):
        return "unverified", "The file was changed after it was verified."
    with_what = f"with lcrl_bench {found.lcrl_bench} on {found.device}"
    if found.verdict == "verified":
        return "verified", f"Its checkpoints were evaluated again {with_what}; every figure agrees."
    if not found.evaluated:
        return "disputed", "Its checkpoints are not the submitted ones."
    count = len(found.differences)
    first = found.differences[0]
    what = f"{first.where}: {first.submitted} submitted, {first.found} found"
    return "disputed", f"Run again {with_what}, {count} figures differ; the first is {what}."
