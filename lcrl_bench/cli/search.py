"""`lcrl-bench search`: choose a method's settings on validation houses carved from train."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean
from lcrl_bench.cli.progress import JobBar, working
from lcrl_bench.errors import ExitCode
from lcrl_bench.interruption import resumable

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
    jobs: int = 0
    """Runs at the same time, each in a process and with one thread; 0: one a core."""
    out: Path = Path("runs/search")
    """Where runs are written; finished ones are kept."""
    fresh: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Where a run of other code or settings is in the way, set it aside and start anew."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(SearchFlags, argv, verb="search")
    with resumable(shlex.join(["lcrl-bench", "search", *argv])), stdout_kept_clean(flags.json):
        found, failed = _search(flags)
    if flags.json:
        print_json(_answer(flags, found, failed))
    else:
        headings = ("settings", "seeds", "validation houses, %", "new tasks, %", "train, %")
        print_table(headings, [_row(each) for each in found], right=headings[1:])
    for key, reason in failed.items():
        say(f"failed: {key}: {reason}", style="bold red")
    return ExitCode.RED if failed else ExitCode.DONE


def _search(flags: SearchFlags) -> tuple[Findings, dict[str, str]]:
    """Make the runs: what was found, the best first, and what failed."""
    from lcrl_bench.evaluation.finished_runs import is_done
    from lcrl_bench.evaluation.reproduction.runner import Runner
    from lcrl_bench.evaluation.run_folder import finished_between
    from lcrl_bench.evaluation.search import Search, combinations, findings, parse_options
    from lcrl_bench.evaluation.workers import Item, work_through

    search = Search(
        flags.method, flags.benchmark, flags.houses, flags.out, flags.preset, flags.fresh
    )
    every, carved = combinations(parse_options(flags.options)), search.carved()
    specs = [search.spec(settings, seed) for settings in every for seed in flags.seeds]
    if before := [spec for spec in specs if is_done(spec, flags.out, carved)]:
        folders = [spec.folder(flags.out, carved) for spec in before]
        say(f"read back from {flags.out}: {finished_between(folders)}")
    items = [Item(key=spec.key, value=spec) for spec in specs]
    workers = min(flags.jobs or len(os.sched_getaffinity(0)), len(items))
    with JobBar(len(items)) as bar:
        ended = work_through(items, partial(Runner, search.session), workers=workers, watcher=bar)
    failed = {each.key: each.error for each in ended if each.error is not None}
    with working("findings"):
        return findings(search, every, flags.seeds), failed


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
