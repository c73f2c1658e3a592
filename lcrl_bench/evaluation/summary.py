"""Outcomes folded into the paper's table: success in per cent by split and kind."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.evaluation.harness import Outcome

DIGITS = 4
"""Decimals of a percentage in a summary: enough to compare, few enough to read."""


def split_table(outcomes: Iterable[Outcome]) -> dict[str, dict[str, float | int | None]]:
    """Success by split and kind.

    Returns:
        Split → `{"pick", "nav", "total"}` in per cent (None where the split has no such task) and
        `"n"`, the number of tasks.
    """
    rows = list(outcomes)
    table: dict[str, dict[str, float | int | None]] = {}
    for split in Split:
        here = [row for row in rows if row.task.split == split]
        table[split.value] = {
            "pick": percentage(row.success for row in here if row.task.kind == Kind.PICK),
            "nav": percentage(row.success for row in here if row.task.kind == Kind.NAV),
            "total": percentage(row.success for row in here),
            "n": len(here),
        }
    return table


def percentage(successes: Iterable[float]) -> float | None:
    """Mean success in per cent; None for no task.

    `math.fsum` makes the mean independent of the order of the tasks.
    """
    values = list(successes)
    return round(100 * math.fsum(values) / len(values), DIGITS) if values else None


def mean_table(tables: Sequence[dict[str, dict[str, Any]]]) -> dict[str, dict[str, Any]]:
    """The mean over seeds of split tables of the same tasks."""
    mean: dict[str, dict[str, Any]] = {}
    for split in tables[0]:
        mean[split] = {"n": tables[0][split]["n"]}
        for column in ("pick", "nav", "total"):
            values = [table[split][column] for table in tables]
            known = [value for value in values if value is not None]
            mean[split][column] = round(math.fsum(known) / len(known), DIGITS) if known else None
    return mean
