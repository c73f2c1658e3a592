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
    """One row a method or control.

    Args:
        tables: Name → split table (see `summary.split_table`).
        intervals: Name → interval table (see `summary.interval_table`), for the rows that have one.
    """
    rows = []
    for name, table in tables.items():
        bounds = (intervals or {}).get(name, {})
        cells = [
            cell(table[split.value][kind], bounds.get(split.value, {}).get(kind))
            for split in Split
            for kind in KINDS
        ]
        rows.append([name, *cells])
    return rows


def cell(value: float | None, bounds: Sequence[float] | None = None) -> str:
    """A percentage with one decimal and its interval, if any; a dash where there is no task."""
    if value is None:
        return "–"
    return f"{value:.1f}" if bounds is None else f"{value:.1f} [{bounds[0]:.1f}, {bounds[1]:.1f}]"
