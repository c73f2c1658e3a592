"""The paper's Table 1, for one method and its controls, as rows to print."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from lcrl_bench.benchmarks.task import Split

KINDS = ("pick", "nav", "total")

HEADINGS = (
    "success, %",
    *(
        f"{split.value} {kind.upper() if kind != 'total' else kind}"
        for split in Split
        for kind in KINDS
    ),
)
"""Column headings: three splits of three columns, as in the paper."""


def table_rows(
    tables: Mapping[str, Mapping[str, Any]],
    *,
    intervals: Mapping[str, Mapping[str, Mapping[str, Sequence[float] | None]]] | None = None,
) -> list[list[str]]:
    """One row a method or control, and one below it for its intervals, if it has any.

    Args:
        tables: Name → split table (see `summary.split_table`).
        intervals: Name → interval table (see `summary.interval_table`), for the rows that have one.
    """
    rows = []
    for name, table in tables.items():
        rows.append([name, *(cell(value) for value in _columns(table))])
        if intervals and name in intervals:
            bounds = _columns(intervals[name])
            rows.append([f"{name}, 95 % interval", *(interval_cell(pair) for pair in bounds)])
    return rows


def cell(value: float | None) -> str:
    """A percentage with one decimal; a dash where there is no task."""
    # Zero is added, since what rounds to it from below would be written -0.0.
    return "–" if value is None else f"{round(value, 1) + 0.0:.1f}"


def interval_cell(bounds: Sequence[float] | None) -> str:
    """An interval with one decimal; a dash where there is no task."""
    return "–" if bounds is None else f"[{bounds[0]:.1f}, {bounds[1]:.1f}]"


def _columns(table: Mapping[str, Mapping[str, Any]]) -> list[Any]:
    return [table[split.value][kind] for split in Split for kind in KINDS]
