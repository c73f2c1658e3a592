"""The leaderboard's page: one file that asks nobody for anything.

Every text of a submission is escaped; the figures are JSON in which no `<` stands, so nothing in it
can end the element it is in. The page's policy allows its own sheet and program, by their hashes,
pictures and the player beside it, and nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping, Sequence
from html import escape
from importlib import resources
from string import Template
from typing import Any

from lcrl_bench.board.details import Show, details
from lcrl_bench.board.entries import Board, Collection
from lcrl_bench.board.lines import Line, lines_of
from lcrl_bench.board.rows import body, headings


def page(collection: Collection, shows: Mapping[str, Show]) -> str:
    """The whole page as HTML.

    Args:
        collection: What it shows.
        shows: What there is to look at of each submission, by the name of its file.
    """
    style, script = _template("page.css"), _template("page.js")
    lines = {board.benchmark: lines_of(board) for board in collection.boards}
    boards = [_board(board, lines[board.benchmark], shows) for board in collection.boards]
    return Template(_template("page.html")).substitute(
        style=style,
        style_hash=_digest(style),
        script=script,
        script_hash=_digest(script),
        choices=_choices([board.benchmark for board in collection.boards]),
        boards="".join(boards),
        refused=_refused(collection.refused),
        empty="" if boards else '<p class="empty">No submission yet.</p>',
        data=embedded({name: [line.record() for line in rows] for name, rows in lines.items()}),
    )


def embedded(value: Any) -> str:  # noqa: ANN401 - any JSON value
    """JSON that can stand in a `<script>` element: whatever could end it is written otherwise."""
    text = json.dumps(value, sort_keys=True, allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _template(name: str) -> str:
    return resources.files("lcrl_bench.leaderboard").joinpath(name).read_text("utf-8")


def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _choices(names: Sequence[str]) -> str:
    """The benchmarks to choose from."""
    if not names:
        return ""
    buttons = "".join(
        f'<label><input type="radio" name="benchmark" value="{escape(name)}"'
        f"{' checked' if place == 0 else ''}><span>{escape(name)}</span></label>"
        for place, name in enumerate(names)
    )
    return f'<fieldset class="choice"><legend>Benchmark</legend>{buttons}</fieldset>'


def _board(board: Board, lines: Sequence[Line], shows: Mapping[str, Show]) -> str:
    name = escape(board.benchmark)
    rows = "".join(
        body(line, "" if line.entry is None else details(line.entry, shows[line.entry.stem]))
        for line in lines
    )
    return (
        f'<section class="board" data-benchmark="{name}"><h2 class="unseen">{name}</h2>'
        f'<div class="scroll" tabindex="0" role="region" aria-label="{name}, scrolls sideways">'
        f'<table class="results show-total"><caption class="unseen">Success in per cent on {name}'
        f"</caption><thead><tr>{headings()}</tr></thead>{rows}</table></div>"
        f'<p class="quiet print">Benchmark {name}, fingerprint <code>{escape(board.fingerprint)}'
        "</code>. A row of another fingerprint is refused.</p></section>"
    )


def _refused(reasons: Sequence[str]) -> str:
    if not reasons:
        return ""
    items = "".join(f"<li>{escape(reason)}</li>" for reason in reasons)
    return f'<section class="refused"><h2>Refused</h2><ul>{items}</ul></section>'
