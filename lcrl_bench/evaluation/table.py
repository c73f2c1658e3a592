"""The paper's Table 1 for a method and its controls: one printed block per split."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.results import COLUMNS, Figure, Results, language_value

INTERVAL_ROW: Final = "  95 % interval"
MAX_NAME: Final = 30
"""Maximum length of a row's name: with three intervals, a line has 80 characters."""


@dataclass(frozen=True)
class Block:
    """The rows of one split."""

    headings: tuple[str, ...]
    """The split, then `PICK`, `NAV` and `total`."""
    rows: tuple[tuple[str, ...], ...]
    """One cell per heading."""


def table_blocks(results: Results) -> tuple[Block, ...]:
    """One block per split, no line wider than 80 columns.

    Rows are the method, with its intervals below if it has several seeds, other optimizers, its
    language controls, and the benchmark's controls.
    """
    return tuple(
        Block(
            (f"{split.value}: success, %", *(_heading(kind) for kind in COLUMNS)),
            tuple(_rows(split, results)),
        )
        for split in Split
    )


def cell(value: float | None) -> str:
    """A percentage with one decimal; a dash if there is no task."""
    # Adding zero avoids -0.0 for values that round to zero from below.
    return "–" if value is None else f"{round(value, 1) + 0.0:.1f}"


def interval_cell(figure: Figure | None) -> str:
    """An interval with one decimal; a dash if there is none."""
    bounds = None if figure is None else figure.bounds
    return "–" if bounds is None else f"[{bounds[0]:.1f}, {bounds[1]:.1f}]"


def _heading(kind: str) -> str:
    return kind if kind == "total" else kind.upper()


def _rows(split: Split, results: Results) -> list[tuple[str, ...]]:
    rows = [_row(results.method, results, split)]
    if len(results.seeds) > 1:
        estimates = (results.estimate(split, kind) for kind in COLUMNS)
        rows.append((INTERVAL_ROW, *map(interval_cell, estimates)))
    rows += [_row(name, other, split) for name, other in results.optimized.items()]
    for control in results.controls:
        name = f"{results.method}, {control}"
        rows.append(_row(name, results, split, language_value(control)))
    return rows + [_row(name, other, split) for name, other in results.beside.items()]


def _row(name: str, results: Results, split: Split, value: str = "success") -> tuple[str, ...]:
    figures = (results.figure(split, kind, value) for kind in COLUMNS)
    return (_shortened(name), *(cell(None if f is None else f.mean) for f in figures))


def _shortened(name: str) -> str:
    """A long name with its middle left out, as its end identifies the row."""
    if len(name) <= MAX_NAME:
        return name
    half = (MAX_NAME - 1) // 2
    return f"{name[:half]}…{name[-half:]}"
