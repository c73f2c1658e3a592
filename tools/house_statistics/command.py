"""`python -m tools.house_statistics`: a set of houses compared with published ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, UsageError

if TYPE_CHECKING:
    from lcrl_bench.houses.house import House
    from tools.house_statistics.report import Finding

PROGRAM: Final = "python -m tools.house_statistics"


@dataclass(frozen=True)
class StatisticsFlags:
    """Measure a set of houses and compare each figure with published houses.

    Exits with code 1 if a figure is outside its band without a known reason.
    """

    seeds: tuple[int, ...] = ()
    """Measure houses generated from these seeds."""
    count: int = 100
    """Without seeds: measure houses generated from seeds 0 to COUNT - 1."""
    houses: Path | None = None
    """Measure the houses of this folder, which may be a benchmark's, instead."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the command."""
    flags = parse_arguments(StatisticsFlags, argv, program=PROGRAM)
    from tools.house_statistics.reference import reference
    from tools.house_statistics.report import judge, measure

    with stdout_kept_clean(flags.json):
        houses = _read(flags.houses) if flags.houses is not None else _generate(flags)
        findings = judge(measure(houses))
    known = reference()
    if flags.json:
        rows = [{**asdict(finding), "band": finding.band} for finding in findings]
        left_out = [row.model_dump() for row in known.unmeasured]
        print_json({"houses": len(houses), "source": known.source, "figures": rows,
                    "unmeasured": left_out})  # fmt: skip
    else:
        _print(findings, len(houses), known.source)
        for row in known.unmeasured:
            say(f"not measured: check {row.check}, {row.name}: {row.reason}")
    red = any(finding.verdict == "differs" and not finding.reason for finding in findings)
    return ExitCode.RED if red else ExitCode.DONE


def _generate(flags: StatisticsFlags) -> list[House]:
    from lcrl_bench.houses.procedural import generate_house

    if flags.count < 1:
        raise UsageError(f"{flags.count} houses can't be measured; give --count 1 or more.")
    seeds = flags.seeds or tuple(range(flags.count))
    houses = []
    with counting("houses", len(seeds)) as advance:
        for seed in seeds:
            houses.append(generate_house(seed))
            advance(f"seed {seed}")
    return houses


def _read(folder: Path) -> list[House]:
    from lcrl_bench.houses.sources import import_house

    inner = folder / "houses"
    root = inner if inner.is_dir() else folder
    files = sorted({*root.glob("*.json"), *root.glob("*/house.json")})
    if not files:
        raise UsageError(
            f"There is no house in {folder}; give a folder of House JSON, or a benchmark's folder."
        )
    with counting("houses", len(files)) as advance:
        houses = []
        for file in files:
            houses.append(import_house(file).house)
            advance(file.name)
    return houses


def _print(findings: Sequence[Finding], houses: int, source: str) -> None:
    columns = ("check", "figure", "ours", "band", "verdict")
    rows = [
        (f.check, f.name, "-" if f.value is None else f"{f.value:.2f}", f.band, f.verdict)
        for f in findings
    ]
    print_table(
        columns, rows, title=f"{houses} houses beside {source}", right=("check", "ours", "band")
    )
    for finding in findings:
        why = "; ".join(part for part in (finding.note, finding.reason) if part)
        if finding.verdict == "differs":
            say(f"check {finding.check}, {finding.name}: {why or 'no reason known'}")
    passed = sum(finding.verdict == "ok" for finding in findings)
    absent = sum(finding.verdict == "none" for finding in findings)
    say(f"{passed} of {len(findings)} figures within their bands, {absent} with nothing to measure")
