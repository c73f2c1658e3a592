"""`lcrl-bench benchmark`: freeze houses and tasks into a benchmark, and prove them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.fan_out import (
    HOUSES_PER_WORKER,
    FanOut,
    command_of,
    do_jobs,
    ended_early,
)
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, suggest
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, NothingSelectedError, UnknownNameError, UsageError
from lcrl_bench.interruption import resumable
from lcrl_bench.names import check_name

if TYPE_CHECKING:
    # At run time these would import torch before a mistyped flag is named.
    from lcrl_bench.benchmarks.benchmark import Benchmark
    from lcrl_bench.benchmarks.build import TaskCount

HELP = """usage: lcrl-bench benchmark build|check|freeze|gallery [FLAGS]

  build    make a benchmark from a folder of houses: draw, prove and split tasks
  check    prove every task of a benchmark again, from physics and pixels
  freeze   render the views of every house, and ship them with the benchmark
  gallery  draw its houses from above, and as an agent inside sees them

`lcrl-bench benchmark build --help` shows the flags."""


@dataclass(frozen=True)
class BuildFlags:
    """Make a benchmark from a folder of houses: draw, prove and split tasks."""

    houses: Path
    """Folder of House JSON files, as `lcrl-bench house import` writes it."""
    out: Path
    """Folder to write; an existing benchmark there is replaced."""
    name: str
    """The benchmark's name."""
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
    """auto, gl or rays."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print only a JSON object on stdout."""
    fan_out: FanOut = field(default_factory=FanOut)


@dataclass(frozen=True)
class CheckFlags:
    """Prove every task of a benchmark again, from physics and pixels."""

    benchmark: Annotated[str, tyro.conf.Positional]
    """A shipped benchmark's name, or a folder."""
    houses: tuple[str, ...] = ()
    """Check only these houses; default: all."""
    render: bool = False
    """Also re-render everything with each available renderer, and report how much is equal."""
    renderer: str = "auto"
    """auto, gl or rays."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print only a JSON object on stdout."""
    fan_out: FanOut = field(default_factory=FanOut)


@dataclass(frozen=True)
class FreezeFlags:
    """Render the views of every house with MuJoCo's cameras, and ship them with the benchmark."""

    folder: Annotated[Path, tyro.conf.Positional]
    """A benchmark folder."""


@dataclass(frozen=True)
class GalleryFlags:
    """Draw houses of a benchmark from above, and as an agent inside sees them."""

    benchmark: Annotated[str, tyro.conf.Positional]
    """A shipped benchmark's name, or a folder."""
    houses: tuple[str, ...] = ()
    """Houses to draw; default: the first twelve."""
    out: Path = Path("gallery.png")
    """The picture: .png, .svg or .pdf."""
    theme: Literal["light", "dark"] = "light"
    """Colours for a light or a dark page."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    verbs = {
        "build": _build,
        "check": _check,
        "freeze": _freeze,
        "gallery": _gallery,
    }
    moved = {"optics": "python -m tools.optics"}
    return run_verb(argv, verbs, kind="benchmark verb", help_text=HELP, moved=moved)


def _build(argv: Sequence[str]) -> int:
    flags = parse_arguments(BuildFlags, argv, verb="benchmark build")
    from lcrl_bench.benchmarks.build import BuildConfig, join_houses, random_streams
    from lcrl_bench.benchmarks.description import describe_benchmark
    from lcrl_bench.benchmarks.document import write_benchmark
    from lcrl_bench.benchmarks.house_jobs import build_jobs, built_of
    from lcrl_bench.houses.document import read_house
    from lcrl_bench.jobs.job import forget

    check_name("benchmark", flags.name)
    if flags.out.exists() and not (flags.out / "benchmark.json").exists():
        raise UsageError(f"--out {flags.out} exists and is not a benchmark; choose another folder.")
    files = house_files(flags.houses)
    config = BuildConfig(
        name=flags.name,
        seed=flags.seed,
        nav=flags.nav,
        pick=flags.pick,
        test_houses=flags.test_houses,
        counts=_counts(flags.counts),
    )
    command = command_of("benchmark", "build", *argv)
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        houses = {file: read_house(file) for file in files}
        jobs = build_jobs(houses, config, renderer=flags.renderer)
        done = do_jobs(jobs, flags.fan_out, label="houses", share=HOUSES_PER_WORKER)
        if (code := ended_early(done, command)) is not None:
            return code
        found = done.values()
        built = [built_of(found[house.id], house) for house in houses.values()]
        rng, _ = random_streams(list(found), config.seed)
        benchmark = join_houses(built, config, rng)
        write_benchmark(flags.out, benchmark)
        forget(jobs)
    answer = {**describe_benchmark(benchmark), "folder": str(flags.out)}
    if flags.json:
        print_json(answer)
        return ExitCode.DONE
    rows = [
        (split, answer["split_houses"][split], count) for split, count in answer["splits"].items()
    ]
    print_table(("split", "houses", "tasks"), rows, title=flags.name, right=("houses", "tasks"))
    words = ("lcrl-bench", "run", "--method", "lcrl", "--benchmark", str(flags.out))
    suggest(words, "train on it")
    return ExitCode.DONE


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


def _check(argv: Sequence[str]) -> int:
    flags = parse_arguments(CheckFlags, argv, verb="benchmark check")
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.check import split_failures
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.benchmarks.house_jobs import check_jobs, failures_of
    from lcrl_bench.jobs.job import forget

    folder = benchmark_folder(flags.benchmark)
    benchmark = read_benchmark(folder)
    for name in flags.houses:
        if name not in benchmark.houses:
            raise UnknownNameError("house", name, benchmark.houses)
    houses = flags.houses or tuple(benchmark.houses)
    command = command_of("benchmark", "check", *argv)
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        jobs = check_jobs(folder, benchmark, houses, renderer=flags.renderer)
        done = do_jobs(jobs, flags.fan_out, label="houses", share=HOUSES_PER_WORKER)
        if (code := ended_early(done, command)) is not None:
            return code
        found = done.values().values()
        checked = sum(each["checked"] for each in found)
        failures = [*split_failures(benchmark), *(f for each in found for f in failures_of(each))]
        forget(jobs)
    failed = len({failure.subject for failure in failures})
    rendered = _render_again(benchmark, houses) if flags.render else {}
    if flags.json:
        rows = [{"subject": f.subject, "reason": f.reason} for f in failures]
        answer: dict[str, Any] = {"checked": checked, "failed": failed, "failures": rows}
        print_json({**answer, "render": rendered} if flags.render else answer)
    else:
        for backend, row in rendered.items():
            share, worst = f"{row['equal']:.4%}", f"{row['worst']:.2%}"
            say(f"{backend}: {share} of pixels equal, {worst} in the worst panorama")
        for failure in failures:
            print_failure = f"{failure.subject}: {failure.reason}"
            say(print_failure, style="red")
        say(f"{checked} tasks checked, {failed} failed")
    return ExitCode.RED if failures else ExitCode.DONE


def _render_again(benchmark: Benchmark, houses: tuple[str, ...]) -> dict[str, dict[str, Any]]:
    """The share of pixels that each renderer of this machine reproduces."""
    from dataclasses import asdict

    from lcrl_bench.benchmarks.rerender import rerender
    from lcrl_bench.scenes.panoramas import describe_gl

    backends = ("gl", "rays") if describe_gl().backend else ("rays",)
    with counting("houses", len(houses)) as advance:
        found = rerender(benchmark, backends, houses=houses, progress=advance)
    return {backend: asdict(agreement) for backend, agreement in found.items()}


def _gallery(argv: Sequence[str]) -> int:
    flags = parse_arguments(GalleryFlags, argv, verb="benchmark gallery")
    import numpy as np

    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.benchmarks.observation import arrangements_of
    from lcrl_bench.recording.pictures import Exhibit, gallery_picture, most_telling

    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    for name in flags.houses:
        if name not in benchmark.houses:
            raise UnknownNameError("house", name, benchmark.houses)
    names = flags.houses or tuple(sorted(benchmark.houses))[:12]
    exhibits = []
    with counting("houses", len(names)) as advance:
        for name in names:
            # The first panoramas are those of the unchanged house, one per tile.
            arrangements = arrangements_of(benchmark.select(house=name))
            views = benchmark.scene(name).panoramas(arrangements)
            seen = np.stack([views.pixels(k) for k in range(benchmark.grids[name].tiles)])
            exhibits.append(Exhibit(benchmark.houses[name], seen[most_telling(seen)]))
            advance(name)
    gallery_picture(flags.out, exhibits, flags.theme)
    say(f"picture: {flags.out}")
    return ExitCode.DONE


def _freeze(argv: Sequence[str]) -> int:
    flags = parse_arguments(FreezeFlags, argv, verb="benchmark freeze")
    from lcrl_bench.benchmarks.document import read_benchmark, view_file
    from lcrl_bench.benchmarks.observation import arrangements_of

    if not (flags.folder / "benchmark.json").is_file():
        raise UsageError(f"{flags.folder} is not a benchmark folder.")
    benchmark = read_benchmark(flags.folder)
    size = 0
    with counting("houses", len(benchmark.houses)) as advance:
        for name in benchmark.houses:
            path = view_file(flags.folder, name)
            benchmark.scene(name).freeze(arrangements_of(benchmark.select(house=name)), path)
            size += path.stat().st_size
            advance(name)
    say(f"{len(benchmark.houses)} houses, {size / 2**20:.1f} MiB of views")
    return ExitCode.DONE
