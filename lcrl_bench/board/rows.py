"""A board's table as HTML: headings, and a body a row, which holds what the row opens.

Every text of a submission is escaped here.
"""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Final

from lcrl_bench.board.document import COLUMNS, Column
from lcrl_bench.board.drawings import whisker
from lcrl_bench.board.lines import HEADINGS, Figure, Line
from lcrl_bench.evaluation.table import cell, interval_cell

MARKS: Final = {
    "verified": "✓ verified",
    "reproduced": "✓ reproduced",
    "disputed": "✗ disputed",
    "unverified": "· unverified",
}
FIRST: Final = "test-house"
"""What the page is sorted by at first."""
LANGUAGE: Final = ("paraphrase", "wrong-target", "shuffled", "blank")


def headings() -> str:
    """The cells of the table's head; each sorts."""
    cells = [_heading("title", "method", "none")]
    for name, text in HEADINGS.items():
        cells.append(_heading(name, text, "descending" if name == FIRST else "none"))
    return "".join(cells)


def body(line: Line, opened: str) -> str:
    """The rows of a line.

    Args:
        line: What it shows.
        opened: What it opens, as HTML; empty: it does not open.
    """
    name = escape(line.id)
    cells = "".join(_cell(line, column) for column in HEADINGS)
    details = (
        f'<tr class="details" id="{name}-details"><td colspan="{len(HEADINGS) + 1}">'
        f'<div class="detail">{opened}</div></td></tr>'
    )
    return (
        f'<tbody id="{name}" class="{line.sort}"><tr>{_title(line)}{cells}</tr>'
        f"{details if opened else ''}</tbody>"
    )


def _heading(name: str, text: str, order: str) -> str:
    return (
        f'<th scope="col" data-column="{name}" class="{_group(name)}" aria-sort="{order}">'
        f'<button type="button">{text}</button></th>'
    )


def _group(column: str) -> str:
    """The class of a column: what a narrow screen leaves out goes together."""
    if column in LANGUAGE:
        return "language"
    return column if column in ("title", "gap") else "split"


def _title(line: Line) -> str:
    title = escape(line.title)
    if line.entry is not None:
        title = (
            f'<button type="button" class="open" disabled aria-expanded="true" '
            f'aria-controls="{escape(line.id)}-details">{title}</button>'
        )
    tags = "".join(f' <span class="tag">{escape(tag)}</span>' for tag in line.tags)
    mark = ""
    if line.mark is not None:
        mark = f'<span class="mark {line.mark}">{MARKS[line.mark]}</span> · '
    return (
        f'<th scope="row" class="title"><span class="rank" aria-label="rank"></span>'
        f'<span class="name">{title}{tags}<small>{mark}{escape(line.under)}</small></span></th>'
    )


def _cell(line: Line, column: str) -> str:
    shown = "".join(_figure(line.figures[kind], column, kind) for kind in COLUMNS)
    return f'<td class="{_group(column)}">{shown}</td>'


def _figure(figures: Mapping[str, Figure | None], column: str, kind: Column) -> str:
    figure = figures[column]
    if figure is None:
        return f'<span class="{kind}"><span class="none">–</span></span>'
    drawn = ""
    if _group(column) == "split":
        drawn = whisker(*figure)
        if figure.low is not None and figure.high is not None:
            drawn += f"<small>{interval_cell((figure.low, figure.high))}</small>"
    return f'<span class="{kind}"><b>{cell(figure.mean)}</b>{drawn}</span>'
