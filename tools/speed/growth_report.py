"""Growth with the number of houses as a table, and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Final

from lcrl_bench.cli.output import print_table, print_text
from tools.speed.growth import GOAL, MEMORY_GOAL_MB, STAGES, Grown, slopes

COLUMNS: Final = ("stage", "houses", "CPU s", "CPU s per house", "peak MB")


def growth_as_json(found: Sequence[Grown]) -> dict[str, Any]:
    """What `--json` prints: every measurement, the slopes, and the goals."""
    return {
        "growth": [asdict(each) for each in found],
        "slopes": slopes(found),
        "goals": {"slope": GOAL, "peak_mb": MEMORY_GOAL_MB},
    }


def print_growth(found: Sequence[Grown]) -> None:
    """Print every measurement, and the slopes if there are two sizes or more."""
    rows = [
        (
            each.stage,
            f"{each.houses:,}",
            f"{each.cpu_s:,.2f}",
            f"{each.cpu_s / each.houses:.3f}",
            f"{each.peak_mb:,.0f}",
        )
        for stage in STAGES
        for each in found
        if each.stage == stage
    ]
    print_table(COLUMNS, rows, right=COLUMNS[1:])
    if found_slopes := slopes(found):
        print_text("")
        goal = f"≤ {GOAL}"
        print_table(
            ("stage", "slope of log time over log houses", "goal"),
            [(stage, f"{value:.2f}", goal) for stage, value in found_slopes.items()],
            right=("slope of log time over log houses", "goal"),
        )
