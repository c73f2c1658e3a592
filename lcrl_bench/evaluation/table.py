"""The paper's Table 1, for one method and its controls, as blocks to print: one per split."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from lcrl_bench.benchmarks.task import Split

KINDS: Final = ("pick", "nav", "total")
"""The columns of a block."""
INTERVAL_ROW: Final = "  95 % interval"
MAX_NAME: Final = 30
"""Letters of a row's name that are shown: with three intervals beside it a line has 80."""

Table = Mapping[str, Mapping[str, Any]]
"""Split → kind → value."""


@dataclass(frozen=True)
class Block:
    """The rows of one split."""

    headings: tuple[str, ...]
    """The split, then `PICK`, `NAV` and `total`."""
    rows: tuple[tuple[str, ...], ...]
    """One cell per heading."""


def table_blocks(
    tables: Mapping[str, Table], *, intervals: Mapping[str, Table] | None = None
) -> tuple[Block, ...]:
    """One block per split, with a row per method or control, no line wider than 80 columns.

    Args:
        tables: Name → split table (see `summary.split_table`).
        intervals: Name → interval table (see `summary.interval_table`), for the rows that have one:
            the intervals are a row of their own, below.
    """
    return tuple(
        Block(
            (f"{split.value}: success, %", *(_heading(kind) for kind in KINDS)),
            tuple(_rows(split, tables, intervals or {})),
        )
        for split in Split
    )


def cell(value: float | None) -> str:
    """A percentage with one decimal; a dash where there is no task."""
    # Zero is added, since what rounds to it from below would be written -0.0.
    return "–" if value is None else f"{round(value, 1) + 0.0:.1f}"


def interval_cell(bounds: Sequence[float] | None) -> str:
    """An interval with one decimal; a dash where there is no task."""
    return "–" if bounds is None else f"[{bounds[0]:.1f}, {bounds[1]:.1f}]"


def _heading(kind: str) -> str:
    return kind if kind == "total" else kind.upper()


def _rows(
    split: Split, tables: Mapping[str, Table], intervals: Mapping[str, Table]
) -> list[tuple[str, ...]]:
    rows = []
    for name, table in tables.items():
        rows.append((_shortened(name), *(cell(table[split.value][kind]) for kind in KINDS)))
        if name in intervals:
            bounds = [intervals[name][split.value][kind] for kind in KINDS]
            rows.append((INTERVAL_ROW, *map(interval_cell, bounds)))
    return rows


def _shortened(name: str) -> str:
    """A name with its middle left out, if it is long: the end says which row it is."""
    if len(name) <= MAX_NAME:
        return name
    half = (MAX_NAME - 1) // 2
    return f"{name[:half]}…{name[-half:]}"
