"""`lcrl-bench bench`: how fast the suite is beside what its users would otherwise pick.

Ratios are of CPU time on one thread, measured in one process: other work on the machine changes
them little. What measures is in `tools/`, which a checkout holds and the package does not.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any, Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, warn
from lcrl_bench.cli.progress import counting, working
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.registry import import_target

COLUMNS: Final = ("what", "work", "beside", "measured", "goal", "met")


ROUNDING: Final = 1e-3
"""Largest relative difference that counts as rounding: the suite's planner and networks are
float32."""


@dataclass(frozen=True)
class Figure:
    """One line of the table that `bench` prints."""

    name: str
    """What `--only` calls it: `"planning"`."""
    work: str
    """The work that is measured."""
    against: str
    """What it is compared with; empty for a plain quantity."""
    value: float
    unit: str
    """`"x"` for a ratio of CPU times, else a unit such as `"s"` or `"GB"`."""
    goal: float
    at_least: bool = True
    """Whether the goal is a lower bound; an upper bound if not."""
    difference: float = 0.0
    """Between the two results, relative; 0 if there is nothing to compare."""
    limit: float = ROUNDING
    """Largest difference that counts as rounding."""
    detail: Mapping[str, Any] = field(default_factory=dict)
    """What the figure was computed from, for `--json`."""

    @property
    def met(self) -> bool:
        """Whether the goal is reached."""
        return self.value >= self.goal if self.at_least else self.value <= self.goal

    @property
    def agrees(self) -> bool:
        """Whether both results are the same but for rounding."""
        return self.difference < self.limit


@dataclass(frozen=True)
class Skipped:
    """A figure that was not measured, and why."""

    name: str
    reason: str


@dataclass(frozen=True)
class BenchFlags:
    """Measure how fast the suite is beside what its users would otherwise pick.

    Exits with code 1 if two programs that do the same work disagree on its result. A missed goal is
    no error: it is shown.
    """

    only: tuple[str, ...] = ()
    """What to measure: rendering, planning, training, environments, building, opening, memory;
    default: all of these. Beside them, what takes minutes: running (what `run` does beside
    training) and table-1 (the first table of the paper)."""
    benchmark: str = "lcrl-v1"
    """A shipped benchmark, or the folder of your own."""
    houses: int = 3
    """Number of its training houses to measure in, spread from the smallest to the largest."""
    peers: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """First install imitation and MiniGrid, each into an environment of its own in the cache
    folder: minutes and about 1.5 GB, once. Without them, what needs them is left out."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the command."""
    flags = parse_arguments(BenchFlags, argv, verb="bench")
    with stdout_kept_clean(flags.json):
        figures, skipped = _measure(flags)
    if flags.json:
        print_json(
            {
                "benchmark": flags.benchmark,
                "figures": [_as_json(figure) for figure in figures],
                "skipped": [asdict(each) for each in skipped],
            }
        )
    else:
        print_table(COLUMNS, [_row(figure) for figure in figures], right=("measured", "goal"))
    for each in skipped:
        say(f"{each.name}: not measured: {each.reason}")
    apart = [figure for figure in figures if not figure.agrees]
    for figure in apart:
        warn(f"{figure.name}: the results differ by {figure.difference:.1e}. Please report it.")
    return ExitCode.RED if apart else ExitCode.DONE


def _measure(flags: BenchFlags) -> tuple[Sequence[Figure], Sequence[Skipped]]:
    checkout = Path(__file__).parents[2]
    if not (checkout / "tools" / "bench").is_dir():
        raise UsageError(
            "`lcrl-bench bench` needs a checkout of the repository: the package holds only what "
            "runs need. Clone it, run `make install` there, and start it from there."
        )
    if str(checkout) not in sys.path:
        sys.path.insert(0, str(checkout))
    if flags.peers:
        with working("installing imitation and MiniGrid"):
            import_target("tools.bench.measures:make_peers")()
    setting = import_target("tools.bench.measures:Setting")(flags.benchmark, flags.houses)
    with counting("figures", len(flags.only)) as advance:
        return import_target("tools.bench.measures:measure")(flags.only, setting, progress=advance)


def _as_json(figure: Figure) -> dict[str, Any]:
    return {**asdict(figure), "met": figure.met}


def _row(figure: Figure) -> tuple[str, ...]:
    bound = "≥" if figure.at_least else "≤"
    return (
        figure.name,
        figure.work,
        figure.against or "-",
        f"{figure.value:,.{_digits(figure.value)}f} {figure.unit}",
        f"{bound} {figure.goal:,g} {figure.unit}",
        "yes" if figure.met else "no",
    )


def _digits(value: float) -> int:
    """Decimals that leave about three digits."""
    return 0 if value >= 100 else 1 if value >= 10 else 2
