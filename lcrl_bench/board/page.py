"""The leaderboard's page: self-contained; makes no network requests.

The markup is in `leaderboard/templates`. Every text of a submission is escaped there; only the
page's own style sheet and script are not. The page's policy allows these two, by their hashes,
pictures and the player beside it, and nothing else.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from importlib import resources
from typing import Final

from jinja2 import Environment, PackageLoader, StrictUndefined

from lcrl_bench.board.details import Media, row_details
from lcrl_bench.board.entries import Collection
from lcrl_bench.board.table_rows import COLUMN_TITLES, table_rows
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.table import cell, interval_cell

MARKS: Final = {
    "verified": "✓ verified",
    "reproduced": "✓ reproduced",
    "disputed": "✗ disputed",
    "unverified": "· unverified",
}


def page(collection: Collection, media: Mapping[str, Media]) -> str:
    """The whole page as HTML.

    Args:
        collection: What it shows.
        media: The recording and pictures of each submission, by the name of its file.
    """
    boards = [(board, table_rows(board)) for board in collection.boards]
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            boards=boards,
            refused=collection.refused,
            media=media,
            details_of=row_details,
            column_titles=COLUMN_TITLES,
            commands=tuple(Control),
            marks=MARKS,
            style=leaderboard_file("page.css"),
            script=leaderboard_file("page.js"),
            data={board.benchmark: [row.record() for row in rows] for board, rows in boards},
        )
    )


def leaderboard_file(name: str) -> str:
    """A style sheet, script or document that ships with the leaderboard."""
    return resources.files("lcrl_bench.leaderboard").joinpath(name).read_text("utf-8")


def _environment() -> Environment:
    """Renders the templates: every text is escaped, and a name that is not given is an error."""
    environment = Environment(
        loader=PackageLoader("lcrl_bench.leaderboard"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"sort_keys": True, "allow_nan": False}
    environment.filters |= {"cell": cell, "interval": interval_cell, "sha256": _sha256}
    return environment


def _sha256(text: str) -> str:
    """The hash of an inline style sheet or script, as a Content-Security-Policy names it."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
