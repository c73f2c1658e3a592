"""The paper's Table 1 for a method and what stands beside it: one printed block per split."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.results import COLUMNS, Figure, Results, language_value

INTERVAL_ROW: Final = "  95 % interval"
MAX_NAME: Final = 30
"""Letters of a row's name that are shown: with three intervals beside it a line has 80."""


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
    """A percentage with one decimal; a dash where there is no task."""
    # Zero is added, since what rounds to it from below would be written -0.0.
    return "–" if value is None else f"{round(value, 1) + 0.0:.1f}"


def interval_cell(figure: Figure | None) -> str:
    """An interval with one decimal; a dash where there is none."""
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
    """A name with its middle left out, if it is long: the end says which row it is."""
    if len(name) <= MAX_NAME:
        return name
    half = (MAX_NAME - 1) // 2
    return f"{name[:half]}…{name[-half:]}"
