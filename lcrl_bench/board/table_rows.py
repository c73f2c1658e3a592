"""Rows of a board's table: submissions, the benchmark's controls, and the paper's."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.document import Submission
from lcrl_bench.board.entries import RANKED, Board, Entry, Mark
from lcrl_bench.evaluation.figure import COLUMNS, Column, Figure
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.reproduction.paper import paper_tables

RowType = Literal["method", "control", "paper"]

COLUMN_TITLES: Final[Mapping[str, str]] = {
    "test-house": "new houses",
    "test-task": "new tasks",
    "train": "training",
    "gap": "gap",
    "paraphrase": "other words",
    "wrong-target": "wrong target",
    "shuffled": "other task",
    "blank": "no words",
}
"""Title of each column of figures."""
CONTROL_SUBTITLES: Final = {
    "random": "uniformly random actions",
    "optimal": "optimal policy of the true reward",
    "constant": "the same reward everywhere",
    "lexical": "word lookup, given the class names",
}


Figures = Mapping[Column, Mapping[str, Figure | None]]
"""Kind of task → column of `COLUMN_TITLES` → figure."""


@dataclass(frozen=True)
class TableRow:
    """One row of the table."""

    id: str
    type: RowType
    title: str
    figures: Figures
    tags: tuple[str, ...] = ()
    """Short warnings beside the title."""
    subtitle: str = ""
    search: str = ""
    """Further words that a search finds the row by."""
    mark: Mark | None = None
    rankable: bool = False
    oracle: bool = False
    entry: Entry | None = field(default=None, repr=False)
    """The submission that the row opens; None: it does not open."""

    def record(self) -> dict[str, Any]:
        """What the page's script sorts, filters and ranks by."""
        return {
            "id": self.id,
            "type": self.type,
            "rankable": self.rankable,
            "oracle": self.oracle,
            "ranked": self.mark in RANKED,
            "search": " ".join((self.title, *self.tags, self.subtitle, self.search)).lower(),
            "title": self.title.lower(),
            "values": {
                kind: {name: None if found is None else found.mean for name, found in row.items()}
                for kind, row in self.figures.items()
            },
        }


def table_rows(board: Board) -> tuple[TableRow, ...]:
    """All rows of a board: its entries, the benchmark's controls, and the paper's rows."""
    return (
        *(_method(board, entry) for entry in board.entries),
        *_controls(board),
        *_paper(board),
    )


def _row_id(board: Board, name: str) -> str:
    """The id of a row in the page."""
    return f"row-{board.benchmark}-{name}"


def _method(board: Board, entry: Entry) -> TableRow:
    row = entry.submission
    changed = [f"{key}={value}" for key, value in row.changed.items()]
    preset = [] if row.preset == "default" else [f"preset {row.preset}"]
    tags = {
        "oracle": row.oracle,
        "expert's actions": row.expert,
        "draft": row.draft,
        "ignores language": entry.ignores_language,
        "deterministic": row.deterministic,
    }
    seeds = (
        "any seed"
        if row.deterministic
        else "1 seed"
        if len(row.seeds) == 1
        else f"{len(row.seeds)} seeds"
    )
    return TableRow(
        id=_row_id(board, entry.stem),
        type="method",
        title=row.title,
        figures={kind: _figures(row, kind) for kind in COLUMNS},
        tags=tuple(name for name, holds in tags.items() if holds),
        subtitle=" · ".join([seeds, *preset, *changed]),
        search=" ".join((row.method, row.summary, row.author, entry.mark)),
        mark=entry.mark,
        rankable=entry.rankable,
        oracle=row.oracle or row.expert,
        entry=entry,
    )


def _figures(row: Submission, kind: Column) -> dict[str, Figure | None]:
    found: dict[str, Figure | None] = {}
    for split in Split:
        figure = row.figures[split][kind]
        found[split.value] = figure and figure.figure
    controls = {
        control.value: getattr(row.language[control][Split.TEST_HOUSE], kind) for control in Control
    }
    return _completed({**found, **{name: _bare(mean) for name, mean in controls.items()}})


def _controls(board: Board) -> tuple[TableRow, ...]:
    """The benchmark's controls, from a verified row if there is one."""
    known = sorted(board.entries, key=lambda entry: entry.mark not in RANKED)
    controls = known[0].submission.controls if known else {}
    return tuple(
        TableRow(
            id=_row_id(board, f"control-{name}"),
            type="control",
            title=name,
            figures=_means(lambda split, kind, splits=splits: getattr(splits[split], kind)),
            tags=("control",),
            subtitle=CONTROL_SUBTITLES[name],
        )
        for name, splits in controls.items()
    )


def _paper(board: Board) -> tuple[TableRow, ...]:
    return tuple(
        TableRow(
            id=_row_id(board, f"paper-{number}"),
            type="paper",
            title=name,
            figures=_means(lambda split, kind, row=row: row.get(f"{split.value}.{kind}")),
            tags=("paper", *(("oracle",) if "Oracle" in name else ())),
            subtitle="as published, other houses",
            oracle="Oracle" in name,
        )
        for number, (name, row) in enumerate(paper_tables()["table-1"].rows.items(), start=1)
    )


def _means(
    mean_of: Callable[[Split, Column], float | None],
) -> dict[Column, dict[str, Figure | None]]:
    """The figures of a row without intervals, from its mean per split and kind of task."""
    return {
        kind: _completed({split.value: _bare(mean_of(split, kind)) for split in Split})
        for kind in COLUMNS
    }


def _completed(known: dict[str, Figure | None]) -> dict[str, Figure | None]:
    """Every column, with the gap between training and new houses."""
    train, house = known[Split.TRAIN.value], known[Split.TEST_HOUSE.value]
    gap = None if train is None or house is None else Figure(round(train.mean - house.mean, 4))
    return {name: gap if name == "gap" else known.get(name) for name in COLUMN_TITLES}


def _bare(mean: float | None) -> Figure | None:
    return None if mean is None else Figure(mean)
