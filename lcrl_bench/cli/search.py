"""`lcrl-bench search`: choose a method's settings on validation houses carved from train."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.fan_out import Done, FanOut, do_jobs, say_failed, say_part
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean
from lcrl_bench.cli.progress import working
from lcrl_bench.errors import ExitCode
from lcrl_bench.interruption import resumable
from lcrl_bench.jobs.engine import Ended

if TYPE_CHECKING:
    # At run time this would import torch before a mistyped flag is named.
    from lcrl_bench.evaluation.search import Finding, Findings


@dataclass(frozen=True)
class SearchFlags:
    """Train every combination of some settings, and rank them on validation houses."""

    method: str
    """A registered method, or `path/to/file.py:Class`."""
    options: Annotated[tuple[str, ...], tyro.conf.arg(name="try")] = ()
    """Values to try: `--try learning_rate=2e-3,4e-3 views=sum,max`. None: the defaults alone."""
    preset: str = "default"
    """The preset that is changed."""
    benchmark: str = "lcrl-v1"
    """A shipped benchmark, or the folder of one of your own. Its test splits are not looked at."""
    houses: int = 12
    """How many training houses are held out for validation."""
    seeds: tuple[int, ...] = (0,)
    """One run per seed and combination."""
    out: Path = Path("runs/search")
    """Where runs are written; finished ones are kept."""
    fresh: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Where a run of other code or settings is in the way, set it aside and start anew."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""
    fan_out: FanOut = field(default_factory=FanOut)


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(SearchFlags, argv, verb="search")
    command = ["lcrl-bench", "search", *argv]
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        found, done = _search(flags)
    if done.part is not None:
        return say_part(done, command)
    failed = done.failed
    if flags.json:
        print_json(_answer(flags, found, failed))
    else:
        headings = ("settings", "seeds", "validation houses, %", "new tasks, %", "train, %")
        print_table(headings, [_row(each) for each in found], right=headings[1:])
    say_failed(done)
    return ExitCode.RED if failed else ExitCode.DONE


def _search(flags: SearchFlags) -> tuple[Findings, Done]:
    """Make the runs: what was found, the best first, and what came of each."""
    from lcrl_bench.evaluation.finished_runs import is_done
    from lcrl_bench.evaluation.run_folder import finished_between
    from lcrl_bench.evaluation.search import Search, combinations, findings, parse_options

    search = Search(
        flags.method, flags.benchmark, flags.houses, str(flags.out), flags.preset, flags.fresh
    )
    every, carved = combinations(parse_options(flags.options)), search.carved()
    specs = [search.spec(settings, seed) for settings in every for seed in flags.seeds]
    if before := [spec for spec in specs if is_done(spec, flags.out, carved)]:
        folders = [spec.folder(flags.out, carved) for spec in before]
        say(f"read back from {flags.out}: {finished_between(folders)}")
    if flags.fan_out.only_read:
        missing = [spec.key for spec in specs if spec not in before]
        done = Done(tuple(Ended(key, "not done yet") for key in missing), None)
    else:
        done = do_jobs(search.jobs(specs, carved), flags.fan_out)
    with working("findings"):
        return () if done.part else findings(search, every, flags.seeds), done


def _row(finding: Finding) -> list[str]:
    from lcrl_bench.benchmarks.task import Split
    from lcrl_bench.evaluation.table import cell

    settings = " ".join(f"{key}={value}" for key, value in finding.settings) or "defaults"
    columns = [finding.success(split) for split in reversed(Split)]
    return [settings, str(len(finding.results.seeds)), *map(cell, columns)]


def _answer(flags: SearchFlags, found: Findings, failed: dict[str, str]) -> dict[str, Any]:
    from lcrl_bench.benchmarks.task import Split

    return {
        "method": flags.method,
        "benchmark": flags.benchmark,
        "preset": flags.preset,
        "houses": flags.houses,
        "findings": [
            {
                "settings": dict(each.settings),
                "seeds": len(each.results.seeds),
                "success": {split.value: each.success(split) for split in Split},
            }
            for each in found
        ],
        "failed": failed,
    }
