"""The figure of a success table: each row is named, and each figure stands where it belongs."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.reproduction.table import FigureDocument, RowDocument, TableDocument
from lcrl_bench.recording.success_figure import success_figure

BASE = {"preset": "default", "settings": {}, "optimizer": "q-iteration", "image_size": None}


def row(label: str, figures: dict[str, FigureDocument | None], **changes: object) -> RowDocument:
    fields = {"control": False, "oracle": False, "seeds": (0, 1), "missing": (), "wall_s": 1.0}
    named = {"label": label, "method": "lcrl", "figures": figures, "language": {}}
    return RowDocument.model_validate({**BASE, **fields, **named, **changes})


def document(*rows: RowDocument, **changes: object) -> TableDocument:
    fields = {
        "format": 1,
        "experiment": "table-1",
        "title": "Success of every method",
        "paper_label": "tab",
        "benchmark": "lcrl-v1",
        "fingerprint": "ab" * 32,
        "tasks": {},
        "seeds": (0, 1),
        "budget": None,
        "complete": True,
        "command": "lcrl-bench reproduce table-1",
        "environments": [],
        "interval": {"confidence": 0.95},
        "rows": list(rows),
        "claims": [],
    }
    return TableDocument.model_validate({**fields, **changes})


def figures(mean: float, paper: float | None = None) -> dict[str, FigureDocument | None]:
    found = FigureDocument(mean=mean, low=mean - 5, high=mean + 5, tasks=9, paper=paper)
    return {f"{split.value}.{part}": found for split in Split for part in ("pick", "total")}


@pytest.fixture
def table() -> TableDocument:
    nothing: dict[str, FigureDocument | None] = dict.fromkeys(figures(0))
    return document(
        row("LC-RL", figures(60, paper=52.1)),
        row("slow & late", nothing, seeds=(), missing=(0, 1)),
        row("random actions", figures(5), control=True),
        complete=False,
        budget=0.5,
    )


def test_a_figure_names_rows_splits_marks_and_what_is_missing(table, tmp_path: Path):
    path = tmp_path / "success.svg"
    success_figure(path, table)
    text = path.read_text().replace("&#x27;", "'")
    for words in (
        "Success of every method",
        "LC-RL",
        "slow &amp; late",
        "random actions",
        "not run",
        "test-house",
        "new houses",
        ">all tasks<",
        ">PICK<",
        "the paper's",
        "95 % intervals",
        "2 seeds, only 0.5 of the full training, unfinished",
    ):
        assert words in text, words
    assert ">NAV<" not in text


def test_the_same_table_gives_the_same_picture_on_white(table, tmp_path: Path):
    first, second = tmp_path / "first.png", tmp_path / "second.png"
    success_figure(first, table)
    success_figure(second, table)
    assert first.read_bytes() == second.read_bytes()
    with Image.open(first) as picture:
        assert picture.convert("RGBA").getpixel((0, 0)) == (255, 255, 255, 255)
