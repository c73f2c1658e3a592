"""The paper's Table 1, for one method and its controls, as rows to print."""

from __future__ import annotations

from collections.abc import Mapping
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


def table_rows(tables: Mapping[str, Mapping[str, Any]]) -> list[list[str]]:
    """One row a method or control.

    Args:
        tables: Name → split table (see `summary.split_table`).
    """
    return [
        [name, *(cell(table[split.value][kind]) for split in Split for kind in KINDS)]
        for name, table in tables.items()
    ]


def cell(value: float | None) -> str:
    """A percentage with one decimal; a dash where there is no task."""
    return "–" if value is None else f"{value:.1f}"
