"""`lcrl-bench benchmark build|check`: freeze houses and tasks, and prove every task again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, suggest
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, NothingSelectedError, UnknownNameError, UsageError
from lcrl_bench.names import check_name

HELP = """usage: lcrl-bench benchmark build|check [FLAGS]

  build   make a benchmark from a folder of houses: draw tasks, prove them, split them
  check   prove every task of a benchmark again, from physics and pixels

`lcrl-bench benchmark build --help` shows the flags."""


@dataclass(frozen=True)
class BuildFlags:
    """Make a benchmark from a folder of houses: draw tasks, prove them, split them."""

    houses: Path
    """Folder of House JSON files, as `lcrl-bench house import` writes it."""
    out: Path
    """Folder to write; replaced whole if it is there and is a benchmark."""
    name: str
    """The benchmark's name."""
    seed: int = 0
    """Draws tasks, starts and splits."""
    nav: int = 10
    """NAV tasks wanted a house."""
    pick: int = 10
    """PICK tasks wanted a house."""
    test_houses: float = 0.25
    """Share of the houses held out whole."""
    renderer: str = "auto"
    """auto, gl or rays."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


@dataclass(frozen=True)
class CheckFlags:
    """Prove every task of a benchmark again, from physics and pixels."""

    benchmark: Annotated[str, tyro.conf.Positional]
    """A shipped benchmark's name, or a folder."""
    houses: tuple[str, ...] = ()
    """Check only these houses; none means all."""
    renderer: str = "auto"
    """auto, gl or rays."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    verbs = {"build": _build, "check": _check}
    return run_verb(argv, verbs, kind="benchmark verb", help_text=HELP)


def _build(argv: Sequence[str]) -> int:
    flags = parse_arguments(BuildFlags, argv, verb="benchmark build")
    from lcrl_bench.benchmarks.build import BuildConfig, build_benchmark
    from lcrl_bench.benchmarks.description import describe_benchmark
    from lcrl_bench.benchmarks.document import write_benchmark
    from lcrl_bench.houses.document import read_house

    check_name("benchmark", flags.name)
    if flags.out.exists() and not (flags.out / "benchmark.json").exists():
        raise UsageError(f"--out {flags.out} exists and is no benchmark; choose another folder.")
    files = _house_files(flags.houses)
    config = BuildConfig(
        name=flags.name,
        seed=flags.seed,
        nav=flags.nav,
        pick=flags.pick,
        test_houses=flags.test_houses,
    )
    with stdout_kept_clean(flags.json), counting("houses", len(files)) as advance:
        houses = [read_house(file) for file in files]
        benchmark = build_benchmark(houses, config, renderer=flags.renderer, progress=advance)
        write_benchmark(flags.out, benchmark)
    answer = {**describe_benchmark(benchmark), "folder": str(flags.out)}
    if flags.json:
        print_json(answer)
        return ExitCode.DONE
    rows = [
        (split, answer["split_houses"][split], count) for split, count in answer["splits"].items()
    ]
    print_table(("split", "houses", "tasks"), rows, title=flags.name, right=("houses", "tasks"))
    suggest(f"lcrl-bench run --method lcrl --benchmark {flags.out}", "train on it")
    return ExitCode.DONE


def _house_files(folder: Path) -> list[Path]:
    """The House JSON files of a folder: at its top, or under `<id>/house.json`."""
    if not folder.is_dir():
        raise UsageError(f"--houses {folder} is no folder.")
    files = sorted([*folder.glob("*.json"), *folder.glob("*/house.json")])
    if not files:
        raise NothingSelectedError(
            f"--houses {folder} holds no House JSON. Make some with `lcrl-bench house import` or "
            "`lcrl-bench house generate`."
        )
    return files


def _check(argv: Sequence[str]) -> int:
    flags = parse_arguments(CheckFlags, argv, verb="benchmark check")
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.check import check_benchmark
    from lcrl_bench.benchmarks.document import read_benchmark

    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    for name in flags.houses:
        if name not in benchmark.houses:
            raise UnknownNameError("house", name, benchmark.houses)
    houses = flags.houses or tuple(benchmark.houses)
    with stdout_kept_clean(flags.json), counting("houses", len(houses)) as advance:
        checked, failures = check_benchmark(
            benchmark, houses=houses, renderer=flags.renderer, progress=advance
        )
    failed = len({failure.subject for failure in failures})
    if flags.json:
        rows = [{"subject": f.subject, "reason": f.reason} for f in failures]
        print_json({"checked": checked, "failed": failed, "failures": rows})
    else:
        for failure in failures:
            print_failure = f"{failure.subject}: {failure.reason}"
            say(print_failure, style="red")
        say(f"{checked} tasks checked, {failed} failed")
    return ExitCode.RED if failures else ExitCode.DONE
