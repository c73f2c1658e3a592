"""`lcrl-bench benchmark`: freeze houses and tasks into a benchmark, and prove them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments, run_verb
from lcrl_bench.cli.benchmark_build import build, freeze
from lcrl_bench.cli.fan_out import (
    HOUSES_PER_WORKER,
    FanOut,
    command_of,
    do_jobs,
    ended_early,
)
from lcrl_bench.cli.output import print_json, say, stdout_kept_clean
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, UnknownNameError
from lcrl_bench.interruption import resumable

HELP = """usage: lcrl-bench benchmark build|check|freeze|gallery [FLAGS]

  build    make a benchmark of houses: draw, prove and split tasks, and render what is seen
  check    prove every task of a benchmark again, from physics and pixels
  freeze   render the views of every house, and ship them with the benchmark
  gallery  draw its houses from above, and as an agent inside sees them

`lcrl-bench benchmark build --help` shows the flags."""


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
        "build": build,
        "check": _check,
        "freeze": freeze,
        "gallery": _gallery,
    }
    moved = {"optics": "python -m tools.optics"}
    return run_verb(argv, verbs, kind="benchmark verb", help_text=HELP, moved=moved)


def _check(argv: Sequence[str]) -> int:
    flags = parse_arguments(CheckFlags, argv, verb="benchmark check")
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.check import split_failures
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.benchmarks.house_jobs import check_jobs, failures_of
    from lcrl_bench.benchmarks.rerender import join_agreements
    from lcrl_bench.benchmarks.view_jobs import agreements_of, rerender_jobs
    from lcrl_bench.jobs.job import forget

    folder = benchmark_folder(flags.benchmark)
    benchmark = read_benchmark(folder)
    for name in flags.houses:
        if name not in benchmark.houses:
            raise UnknownNameError("house", name, benchmark.houses)
    houses = flags.houses or tuple(benchmark.houses)
    command = command_of("benchmark", "check", *argv)
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        proofs = check_jobs(folder, benchmark, houses, renderer=flags.renderer)
        again = rerender_jobs(folder, benchmark, houses, _backends()) if flags.render else []
        jobs = [*proofs, *again]
        done = do_jobs(jobs, flags.fan_out, label="houses", share=HOUSES_PER_WORKER)
        if (code := ended_early(done, command)) is not None:
            return code
        values = done.values()
        found = [values[job.name] for job in proofs]
        checked = sum(each["checked"] for each in found)
        failures = [*split_failures(benchmark), *(f for each in found for f in failures_of(each))]
        forget(jobs)
    failed = len({failure.subject for failure in failures})
    rendered = {}
    if flags.render:
        joined = join_agreements([agreements_of(values[job.name]) for job in again])
        rendered = {backend: asdict(agreement) for backend, agreement in joined.items()}
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


def _backends() -> tuple[str, ...]:
    """The renderers of this machine."""
    from lcrl_bench.scenes.panoramas import describe_gl

    return ("gl", "rays") if describe_gl().backend else ("rays",)


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
