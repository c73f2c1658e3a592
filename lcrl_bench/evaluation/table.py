"""The paper's Table 1 for a method and its controls: one printed block per split."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Self

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.figure import COLUMNS, Figure, language_value

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


class Tabled(ABC):
    """An object with a success table, shown by `print` and in notebooks."""

    method: str
    """Name of its row."""
    seeds: tuple[int, ...]
    """Its runs."""
    optimized: Mapping[str, Self]
    """Rows below it, for other optimizers."""
    beside: Mapping[str, Self]
    """Rows below those, for the benchmark's controls."""

    @property
    @abstractmethod
    def controls(self) -> tuple[str, ...]:
        """Language controls that were evaluated."""

    @abstractmethod
    def figure(self, split: str, column: str, value: str = "success") -> Figure | None:
        """A mean; None if there is no task."""

    @abstractmethod
    def estimate(self, split: str, column: str) -> Figure | None:
        """Mean success with its interval; None if there is no task."""

    def __str__(self) -> str:
        """The success table as text, at most 80 columns wide."""
        return "\n\n".join(map(_text, table_blocks(self)))

    def _repr_html_(self) -> str:
        """The success table as HTML, for notebooks."""
        import pandas

        frames = [pandas.DataFrame(b.rows, columns=list(b.headings)) for b in table_blocks(self)]
        return "".join(frame.to_html(index=False) for frame in frames)


def table_blocks(results: Tabled) -> tuple[Block, ...]:
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


def _rows(split: Split, results: Tabled) -> list[tuple[str, ...]]:
    rows = [_row(results.method, results, split)]
    if len(results.seeds) > 1:
        estimates = (results.estimate(split, kind) for kind in COLUMNS)
        rows.append((INTERVAL_ROW, *map(interval_cell, estimates)))
    rows += [_row(name, other, split) for name, other in results.optimized.items()]
    for control in results.controls:
        name = f"{results.method}, {control}"
        rows.append(_row(name, results, split, language_value(control)))
    return rows + [_row(name, other, split) for name, other in results.beside.items()]


def _row(name: str, results: Tabled, split: Split, value: str = "success") -> tuple[str, ...]:
    figures = (results.figure(split, kind, value) for kind in COLUMNS)
    return (_shortened(name), *(cell(None if f is None else f.mean) for f in figures))


def _text(block: Block) -> str:
    lines = [block.headings, *block.rows]
    first, *others = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
    rows = [
        "   ".join((name.ljust(first), *map(str.rjust, cells, others))) for name, *cells in lines
    ]
    return "\n".join([rows[0], "-" * len(rows[0]), *rows[1:]])


def _shortened(name: str) -> str:
    """A long name with its middle left out, as its end identifies the row."""
    if len(name) <= MAX_NAME:
        return name
    half = (MAX_NAME - 1) // 2
    return f"{name[:half]}…{name[-half:]}"
