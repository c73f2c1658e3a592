"""Tables as files: one page and JSON each, an index, and hand-written notes."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from pydantic import ValidationError

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.reproduction.experiments import EXPERIMENTS, PAPER_SEEDS
from lcrl_bench.evaluation.reproduction.markdown import NOTES_FILE, grid, page
from lcrl_bench.evaluation.reproduction.table import TableDocument
from lcrl_bench.storage import read_json, write_bytes, write_json

REFERENCE: Final = "lcrl-v1"
"""The benchmark whose tables are named after the experiment alone."""
INDEX_FILE: Final = "README.md"
INDEX_COLUMNS: Final = ("table", "benchmark", "seeds", "of the full training", "runs finished")
NOTES: Final = """# Notes on the results

This page is written by hand; the tables next to it are generated and don't change it.
"""


def table_name(document: TableDocument) -> str:
    """The name of a table's files: `table-1`, or a longer one for partial results.

    Fewer seeds than the table's own, a budget, another benchmark and unfinished work each get
    separate files, so that they are not mistaken for the full result and don't overwrite it.
    """
    parts = [document.experiment]
    if document.benchmark != REFERENCE:
        parts.append(document.benchmark)
    if document.budget is not None:
        parts.append(f"budget-{document.budget:g}")
    if not _own_seeds(document.experiment) <= set(document.seeds):
        parts.append("seeds-" + "-".join(map(str, document.seeds)))
    if not document.complete:
        parts.append("unfinished")
    return "-".join(parts)


def _own_seeds(name: str) -> set[int]:
    """The default seeds of a table's rows."""
    experiment = next((each for each in EXPERIMENTS if each.name == name), None)
    rows = () if experiment is None else experiment.rows
    return {seed for row in rows if not row.control for seed in row.seeds} or set(PAPER_SEEDS)


def publish(document: TableDocument, folder: Path) -> Path:
    """Write a table's page and JSON atomically, and the folder's index; return the page's path."""
    path = folder / f"{table_name(document)}.md"
    write_json(path.with_suffix(".json"), document.model_dump(mode="json"))
    write_bytes(path, page(document).encode())
    if document.complete:
        # The files of the unfinished table are obsolete now.
        for suffix in (".md", ".json", ".svg"):
            path.with_name(f"{path.stem}-unfinished{suffix}").unlink(missing_ok=True)
    if not (folder / NOTES_FILE).exists():
        write_bytes(folder / NOTES_FILE, NOTES.encode())
    write_bytes(folder / INDEX_FILE, index(folder).encode())
    return path


def read_table(path: Path) -> TableDocument:
    """Read a table's JSON.

    Raises:
        InvalidFileError: If it is not a table.
    """
    try:
        return TableDocument.model_validate(read_json(path))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        fix = "Write it again: lcrl-bench reproduce."
        raise InvalidFileError(path, first["msg"], where=where, fix=fix) from error


def index(folder: Path) -> str:
    """The page that lists the tables of a folder."""
    documents = {}
    for path in folder.glob("*.json"):
        # A table in an older format must not block the others: it can be written again.
        with contextlib.suppress(InvalidFileError):
            documents[path.stem] = read_table(path)
    order = [experiment.name for experiment in EXPERIMENTS]
    names = sorted(documents, key=lambda name: (_place(documents[name], order), len(name), name))
    sections = [
        "# Results",
        "The paper's tables from runs of this suite, next to the paper's results. Each page has a "
        f"JSON of the same name. How to interpret them: [{NOTES_FILE}]({NOTES_FILE}).",
        grid(INDEX_COLUMNS, [_index_row(name, documents[name]) for name in names]),
    ]
    return "\n\n".join(sections) + "\n"


def _place(document: TableDocument, order: Sequence[str]) -> int:
    return order.index(document.experiment) if document.experiment in order else len(order)


def _index_row(name: str, document: TableDocument) -> list[str]:
    done = sum(len(row.seeds) for row in document.rows)
    asked = done + sum(len(row.missing) for row in document.rows)
    return [
        f"[{document.title}]({name}.md)",
        f"`{document.benchmark}` `{document.fingerprint[:12]}`",
        ", ".join(map(str, document.seeds)),
        "all" if document.budget is None else f"{document.budget:g}",
        f"{done} of {asked}",
    ]
