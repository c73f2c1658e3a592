"""`lcrl-bench benchmark build` and `freeze`: houses become a benchmark, with its views."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.fan_out import (
    HOUSES_PER_WORKER,
    FanOut,
    command_of,
    do_jobs,
    ended_early,
)
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, suggest
from lcrl_bench.errors import EnvironmentMissingError, ExitCode, NothingSelectedError, UsageError
from lcrl_bench.interruption import resumable
from lcrl_bench.names import check_name

if TYPE_CHECKING:
    # At run time these would import torch before a mistyped flag is named.
    from lcrl_bench.benchmarks.benchmark import Benchmark
    from lcrl_bench.benchmarks.build import BuildConfig, TaskCount
    from lcrl_bench.houses.house import House
    from lcrl_bench.jobs.job import Job


@dataclass(frozen=True)
class BuildFlags:
    """Make a benchmark of houses: draw, prove and split tasks, and render what is seen."""

    houses: Path | None = None
    """Folder of House JSON files, as `lcrl-bench house import` writes it."""
    procedural: int = 0
    """Instead of --houses: generate this many houses, from consecutive seeds."""
    house_seed: int = 100
    """First seed of --procedural. Those of lcrl-v1 are 1 to 76, those of mini begin at 1000000."""
    out: Path | None = None
    """Folder to write; an existing benchmark there is replaced. Default: procedural-N."""
    name: str = ""
    """The benchmark's name; default: the folder's."""
    seed: int = 0
    """Seed for tasks, starts and splits."""
    nav: int = 10
    """NAV tasks wanted per house."""
    pick: int = 10
    """PICK tasks wanted per house."""
    test_houses: float = 0.25
    """Share of houses held out entirely."""
    counts: tuple[str, ...] = ()
    """Exact task counts, split.kind=number: `--counts train.pick=508 train.nav=496`."""
    renderer: str = "auto"
    """auto, gl or rays; auto means gl if views are frozen."""
    freeze: Literal["auto", "yes", "no"] = "auto"
    """Ship the views too, as `benchmark freeze` does, which needs OpenGL; auto: with --procedural,
    where there is OpenGL."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print only a JSON object on stdout."""
    fan_out: FanOut = field(default_factory=FanOut)


@dataclass(frozen=True)
class FreezeFlags:
    """Render the views of every house with MuJoCo's cameras, and ship them with the benchmark."""

    folder: Annotated[Path, tyro.conf.Positional]
    """A benchmark folder."""
    fan_out: FanOut = field(default_factory=FanOut)


def build(argv: Sequence[str]) -> int:
    """Run the verb `build`."""
    flags = parse_arguments(BuildFlags, argv, verb="benchmark build")
    from lcrl_bench.benchmarks.build import BuildConfig, join_houses, random_streams
    from lcrl_bench.benchmarks.description import describe_benchmark
    from lcrl_bench.benchmarks.document import write_benchmark
    from lcrl_bench.benchmarks.house_jobs import built_of
    from lcrl_bench.jobs.job import forget

    out = _checked_out(flags)
    name = flags.name or out.resolve().name
    check_name("benchmark", name)
    config = BuildConfig(
        name=name,
        seed=flags.seed,
        nav=flags.nav,
        pick=flags.pick,
        test_houses=flags.test_houses,
        counts=_counts(flags.counts),
    )
    freezes = _freezes(flags)
    command = command_of("benchmark", "build", *argv)
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        renderer = "gl" if freezes and flags.renderer == "auto" else flags.renderer
        jobs, houses = _jobs(flags, config, renderer)
        done = do_jobs(jobs, flags.fan_out, label="houses", share=HOUSES_PER_WORKER)
        if (code := ended_early(done, command)) is not None:
            return code
        found = done.values()
        built = [built_of(value, houses.get(key)) for key, value in found.items()]
        rng, _ = random_streams(list(found), config.seed)
        benchmark = join_houses(built, config, rng)
        write_benchmark(out, benchmark)
        if freezes and (code := _freeze(out, benchmark, flags.fan_out, command)) is not None:
            return code
        forget(jobs)
    answer = {**describe_benchmark(benchmark), "folder": str(out)}
    if flags.json:
        print_json(answer)
        return ExitCode.DONE
    rows = [
        (split, answer["split_houses"][split], count) for split, count in answer["splits"].items()
    ]
    print_table(("split", "houses", "tasks"), rows, title=name, right=("houses", "tasks"))
    words = ("lcrl-bench", "run", "--method", "lcrl", "--benchmark", str(out))
    suggest(words, "train on it")
    return ExitCode.DONE


def freeze(argv: Sequence[str]) -> int:
    """Run the verb `freeze`."""
    flags = parse_arguments(FreezeFlags, argv, verb="benchmark freeze")
    from lcrl_bench.benchmarks.document import read_benchmark

    if not (flags.folder / "benchmark.json").is_file():
        raise UsageError(f"{flags.folder} is not a benchmark folder.")
    benchmark = read_benchmark(flags.folder)
    command = command_of("benchmark", "freeze", *argv)
    with resumable(shlex.join(command)):
        code = _freeze(flags.folder, benchmark, flags.fan_out, command)
    return ExitCode.DONE if code is None else code


def _freeze(
    folder: Path, benchmark: Benchmark, fan_out: FanOut, command: Sequence[str]
) -> int | None:
    """Write the views of all houses; returns the exit code if it can't be done."""
    from lcrl_bench.benchmarks.view_jobs import freeze_jobs
    from lcrl_bench.jobs.job import forget

    jobs = freeze_jobs(folder, benchmark)
    done = do_jobs(jobs, fan_out, label="views", share=HOUSES_PER_WORKER)
    if (code := ended_early(done, command)) is not None:
        return code
    size = sum(done.values().values())
    forget(jobs)
    say(f"{len(jobs)} houses, {size / 2**20:.1f} MiB of views")
    return None


def _checked_out(flags: BuildFlags) -> Path:
    if (flags.houses is None) == (not flags.procedural):
        raise UsageError("Name either --houses FOLDER or --procedural NUMBER.")
    if flags.procedural < 0 or flags.house_seed < 0:
        raise UsageError("--procedural and --house-seed must not be negative.")
    if flags.out is None and not flags.procedural:
        raise UsageError("--houses needs --out: the folder to write.")
    out = flags.out or Path(f"procedural-{flags.procedural}")
    if out.exists() and not (out / "benchmark.json").exists():
        raise UsageError(f"--out {out} exists and is not a benchmark; choose another folder.")
    return out


def _freezes(flags: BuildFlags) -> bool:
    """Whether to freeze views.

    Raises:
        EnvironmentMissingError: If it is asked for, and there is no OpenGL.
    """
    from lcrl_bench.scenes.panoramas import describe_gl

    if flags.freeze == "no" or (flags.freeze == "auto" and not flags.procedural):
        return False
    found = describe_gl()
    if found.backend is None and flags.freeze == "yes":
        raise EnvironmentMissingError(
            f"--freeze yes needs OpenGL: {found.error} Try --freeze no, or `lcrl-bench doctor`."
        )
    return found.backend is not None


def _jobs(
    flags: BuildFlags, config: BuildConfig, renderer: str
) -> tuple[list[Job], dict[str, House]]:
    """The jobs of all houses, and the houses that were read from files, by id."""
    from lcrl_bench.benchmarks.house_jobs import build_jobs, procedural_jobs
    from lcrl_bench.houses.document import read_house

    if flags.houses is None:
        seeds = range(flags.house_seed, flags.house_seed + flags.procedural)
        return procedural_jobs(seeds, config, renderer=renderer), {}
    houses = {file: read_house(file) for file in house_files(flags.houses)}
    jobs = build_jobs(houses, config, renderer=renderer)
    return jobs, {house.id: house for house in houses.values()}


def house_files(folder: Path) -> list[Path]:
    """The House JSON files in a folder, at its top or as `<id>/house.json`.

    Raises:
        UsageError: If it is not a folder.
        NothingSelectedError: If it holds none.
    """
    if not folder.is_dir():
        raise UsageError(f"--houses {folder} is no folder.")
    files = sorted([*folder.glob("*.json"), *folder.glob("*/house.json")])
    if not files:
        raise NothingSelectedError(
            f"--houses {folder} holds no House JSON. Make some with `lcrl-bench house import` or "
            "`lcrl-bench house generate`."
        )
    return files


def _counts(words: tuple[str, ...]) -> tuple[TaskCount, ...]:
    """Parse `("train.pick=508",)`."""
    from lcrl_bench.benchmarks.build import TaskCount
    from lcrl_bench.benchmarks.task import Kind, Split

    found = []
    for word in words:
        place, _, number = word.partition("=")
        split, _, kind = place.partition(".")
        if split not in set(Split) or kind not in set(Kind) or not number.isdecimal():
            splits, kinds = "|".join(Split), "|".join(Kind)
            raise UsageError(f"--counts {word}: write {splits}.{kinds}=NUMBER.")
        found.append(TaskCount(Split(split), Kind(kind), int(number)))
    return tuple(found)
