"""The leaderboard's page: one file that asks nobody for anything.

Every text of a submission is escaped; the figures are JSON in which no `<` stands, so nothing in it
can end the element it is in. The page's policy allows its own sheet and program, by their hashes,
and nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any, Final

from lcrl_bench.board.details import ORDER, artifacts_of, details, table
from lcrl_bench.board.entries import Board, Entry
from lcrl_bench.evaluation.reproduction.paper import paper_tables
from lcrl_bench.evaluation.summary import KINDS
from lcrl_bench.evaluation.table import cell, interval_cell
from lcrl_bench.storage import write_bytes

FILE: Final = "index.html"
COLUMNS: Final = (
    ("title", "method"),
    ("test-house", "new houses"),
    ("test-task", "new tasks"),
    ("train", "training"),
    ("gap", "gap"),
    ("paraphrase", "other words"),
    ("wrong-target", "wrong target"),
    ("shuffled", "other task"),
    ("blank", "no words"),
)
"""What can be sorted by, and what it is called."""
MARKS: Final = {"verified": "✓ verified", "disputed": "✗ disputed", "unverified": "· unverified"}


def write_page(board: Board, out: Path, *, artifacts: Path | None = None) -> Path:
    """Write the page.

    Args:
        board: What it shows.
        out: Folder to write `index.html` to.
        artifacts: Folder of pictures and recordings, a folder a submission; the page links to them.

    Returns:
        The page's path.
    """
    path = out / FILE
    write_bytes(path, page(board, out=out, artifacts=artifacts).encode())
    return path


def page(board: Board, *, out: Path, artifacts: Path | None = None) -> str:
    """The whole page as HTML; arguments as `write_page`."""
    style, script = _template("page.css"), _template("page.js")
    bodies = [
        _body(entry, details(entry, artifacts_of(entry, artifacts, page=out)))
        for entry in board.entries
    ]
    return Template(_template("page.html")).substitute(
        title=escape(f"{board.benchmark} leaderboard"),
        benchmark=escape(board.benchmark),
        fingerprint=escape(board.fingerprint),
        style=style,
        style_hash=_digest(style),
        script=script,
        script_hash=_digest(script),
        refused=_refused(board.refused),
        headings="\n".join(_heading(key, text) for key, text in COLUMNS),
        rows="\n".join(bodies),
        references=_references(board.entries),
        empty="" if bodies else '<p class="empty">No submission yet: lcrl-bench submit.</p>',
        paper=_paper(),
        data=embedded({"rows": [entry.record() for entry in board.entries]}),
    )


def embedded(value: Any) -> str:  # noqa: ANN401 - any JSON value
    """JSON that can stand in a `<script>` element: whatever could end it is written otherwise."""
    text = json.dumps(value, sort_keys=True, allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _template(name: str) -> str:
    return resources.files("lcrl_bench.leaderboard").joinpath(name).read_text("utf-8")


def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _refused(reasons: Sequence[str]) -> str:
    if not reasons:
        return ""
    items = "".join(f"<li>{escape(reason)}</li>" for reason in reasons)
    return f'<div class="refused"><p><b>Refused</b></p><ul>{items}</ul></div>'


def _heading(key: str, text: str) -> str:
    sort = "descending" if key == "test-house" else "none"
    return (
        f'<th scope="col" data-column="{key}" aria-sort="{sort}">'
        f'<button type="button">{text}</button></th>'
    )


def _body(entry: Entry, opened: str) -> str:
    name = escape(entry.stem)
    cells = "".join(_cell(entry, key) for key, _ in COLUMNS[1:])
    return (
        f'<tbody id="row-{name}"><tr>{_title(entry)}{cells}</tr>'
        f'<tr class="details" id="details-{name}"><td colspan="{len(COLUMNS)}">'
        f'<div class="detail">{opened}</div></td></tr></tbody>'
    )


def _title(entry: Entry) -> str:
    row = entry.submission
    told = {"oracle": row.oracle, "expert's actions": row.expert, "draft": row.draft}
    changed = ", ".join(f"{key}={value}" for key, value in row.changed.items())
    preset = "" if row.preset == "default" else f"preset {row.preset}"
    tags = [text for text, holds in told.items() if holds]
    shown = "".join(f' <span class="tag">{text}</span>' for text in tags)
    asked = escape("; ".join(part for part in (preset, changed) if part))
    seeds = len(row.seeds)
    return (
        f'<th scope="row"><span class="rank"></span><button type="button" class="open" disabled '
        f'aria-expanded="true" aria-controls="details-{escape(entry.stem)}">{escape(row.title)}'
        f"</button>{shown}"
        f'<small><span class="mark {entry.mark}">{MARKS[entry.mark]}</span> · {seeds} '
        f"seed{'' if seeds == 1 else 's'}</small>"
        f"<small>{asked}</small></th>"
    )


def _cell(entry: Entry, column: str) -> str:
    return f"<td>{''.join(_figure(entry, column, kind) for kind in KINDS)}</td>"


def _figure(entry: Entry, column: str, kind: Any) -> str:  # noqa: ANN401 - a column's name
    value = entry.values(kind)[column]
    shown = cell(value) if not isinstance(value, str) else escape(value)
    bounds = ""
    for split in ORDER:
        figure = entry.submission.figures[split][kind] if split.value == column else None
        if figure is not None:
            bounds = f"<small>{interval_cell((figure.low, figure.high))}</small>"
    return f'<span class="{kind}"><b class="mean">{shown}</b>{bounds}</span>'


def _references(entries: Sequence[Entry]) -> str:
    """The benchmark's own rows, as a verified submission has them if there is one."""
    known = sorted(entries, key=lambda entry: entry.mark != "verified")
    if not known:
        return '<tbody class="reference"></tbody>'
    rows = []
    for name, splits in known[0].submission.controls.items():
        columns = [
            "".join(
                f'<span class="{kind}">{cell(getattr(splits[split], kind))}</span>'
                for kind in KINDS
            )
            for split in ORDER
        ]
        filled = "".join(f"<td>{text}</td>" for text in columns)
        rest = "<td></td>" * (len(COLUMNS) - 1 - len(columns))
        rows.append(f'<tr><th scope="row">{name}<small>control</small></th>{filled}{rest}</tr>')
    return f'<tbody class="reference">{"".join(rows)}</tbody>'


def _paper() -> str:
    found = paper_tables()["table-1"]
    names = [f"{split.value}.{kind}" for split in ORDER for kind in KINDS]
    headings = [
        name.replace(".", " ").replace("pick", "PICK").replace("nav", "NAV") for name in names
    ]
    rows = [
        [row, *(cell(figures.get(name)) for name in names)] for row, figures in found.rows.items()
    ]
    return table(["success, %", *headings], rows)
