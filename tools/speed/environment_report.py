"""Prints the speed of the Gymnasium environments, as a table or as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Final

from lcrl_bench.cli.output import print_json, print_table
from lcrl_bench.cli.progress import counting
from tools.speed.environments import COUNTS, Stepping, measure_environments, times_faster
from tools.speed.minigrid import TASKS

COLUMNS: Final = ("environment", "at once", "opened in s", "MB", "steps per s", "by median")


def report_environments(
    benchmark: str, *, renderer: str, minigrid: bool, seconds: float, as_json: bool
) -> None:
    """Measure and print.

    Args:
        benchmark: A name or a folder.
        renderer: Draws views that are not in the cache.
        minigrid: Whether to compare with MiniGrid.
        seconds: CPU seconds to step each environment for.
        as_json: Whether to print one JSON object.

    Raises:
        EnvironmentMissingError: If MiniGrid can't be installed.
    """
    others = TASKS if minigrid else ()
    with counting("environments", len(COUNTS) * (1 + len(others))) as advance:
        found = measure_environments(
            benchmark, renderer=renderer, minigrid=minigrid, seconds=seconds, progress=advance
        )
    ratios = [times_faster(each, found) if each.environment not in others else {} for each in found]
    if as_json:
        rows = [{**asdict(each), "times": ratio} for each, ratio in zip(found, ratios, strict=True)]
        print_json({"benchmark": benchmark, "environments": rows})
        return
    columns = (*COLUMNS, *(f"x {name}" for name in others))
    rows = [
        (*_cells(each), *(f"{ratio[name]:.0f}" if ratio else "" for name in others))
        for each, ratio in zip(found, ratios, strict=True)
    ]
    print_table(columns, rows, right=columns[1:])


def _cells(each: Stepping) -> tuple[str, ...]:
    return (
        each.environment,
        str(each.environments or 1),
        f"{each.opening:.2f}",
        f"{each.used:.0f}",
        f"{each.steps:,.0f}",
        f"{each.median:,.0f}",
    )
