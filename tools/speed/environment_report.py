"""The speed of the Gymnasium environments as a table, and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Final

from lcrl_bench.cli.output import print_table
from tools.speed.environments import TASKS, Stepping, times_faster

COLUMNS: Final = ("environment", "at once", "opened in s", "MB", "steps per s", "by median")


def environments_as_json(benchmark: str, found: Sequence[Stepping]) -> dict[str, Any]:
    """What `--json` prints: every measurement, with its ratios to other environments."""
    rows = [{**asdict(each), "times": _ratios(each, found)} for each in found]
    return {"benchmark": benchmark, "environments": rows}


def print_environments(found: Sequence[Stepping]) -> None:
    """Print every measurement, with its ratios to other environments."""
    others = [name for name in TASKS if any(each.environment == name for each in found)]
    columns = (*COLUMNS, *(f"x {name}" for name in others))
    rows = [(*_cells(each), *_ratio_cells(each, found, others)) for each in found]
    print_table(columns, rows, right=columns[1:])


def _ratios(each: Stepping, found: Sequence[Stepping]) -> dict[str, float]:
    return {} if each.environment in TASKS else times_faster(each, found)


def _ratio_cells(each: Stepping, found: Sequence[Stepping], others: Sequence[str]) -> list[str]:
    ratios = _ratios(each, found)
    return [f"{ratios[name]:.0f}" if name in ratios else "" for name in others]


def _cells(each: Stepping) -> tuple[str, ...]:
    return (
        each.environment,
        str(each.environments or 1),
        f"{each.opening:.2f}",
        f"{each.used:.0f}",
        f"{each.steps:,.0f}",
        f"{each.median:,.0f}",
    )
