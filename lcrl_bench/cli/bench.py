"""`lcrl-bench bench`: the suite's speed, as ratios measured in one run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, print_text, say, stdout_kept_clean, warn
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode

if TYPE_CHECKING:
    # At run time this would import torch before a mistyped flag is named.
    from lcrl_bench.evaluation.speed import Figure

HEADINGS = ("what", "how", "threads", "ms a house", "times as fast", "by medians", "difference")
REPEATED = ("of a house's", "all", "distinct", "times fewer")


@dataclass(frozen=True)
class BenchFlags:
    """Measure the suite's speed: what it computes, beside plainer ways to the same results.

    Ends with exit code 1 if two ways give different results.
    """

    benchmark: str = "lcrl-v1"
    """A shipped benchmark, or the folder of one of your own."""
    houses: int = 5
    """In how many of its training houses, spread from the smallest to the largest."""
    repeats: int = 5
    """How often each way is timed in each house, in turns with the others."""
    threads: tuple[int, ...] = (1, 2)
    """Threads of torch on a CPU, each number measured on its own."""
    device: str = "cpu"
    """auto, cpu or cuda. Compiled kernels are for a CPU."""
    renderer: str = "auto"
    """For views that are not in the cache: auto, gl (MuJoCo's cameras) or rays (no OpenGL)."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(BenchFlags, argv, verb="bench")
    with stdout_kept_clean(flags.json):
        answer, figures = _measure(flags)
    if flags.json:
        print_json(answer)
    else:
        print_table(HEADINGS, [_row(figure) for figure in figures], right=HEADINGS[2:])
        print_text("")
        rows = [
            (each["name"], f"{each['all']:,}", f"{each['distinct']:,}", f"{each['times']:.1f}")
            for each in answer["repetition"]
        ]
        print_table(REPEATED, rows, right=REPEATED[1:])
    for reason in answer["skipped"]:
        say(f"skipped: {reason}")
    for figure in figures:
        if not figure.equal:
            found = f"{figure.difference:.1e} from the reference"
            warn(f"{figure.what}: '{figure.way}' gives something else, {found}. Please report it.")
    return ExitCode.DONE if answer["equal"] else ExitCode.RED


def _measure(flags: BenchFlags) -> tuple[dict[str, Any], tuple[Figure, ...]]:
    """The JSON answer, and the figures in it."""
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.run import resolve_device
    from lcrl_bench.evaluation.speed import measure_speed
    from lcrl_bench.evaluation.workload import spread_houses

    device = resolve_device(flags.device)
    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    houses = spread_houses(benchmark, flags.houses)
    with counting("houses", len(houses)) as advance:
        speed = measure_speed(
            benchmark,
            houses,
            threads=flags.threads,
            repeats=flags.repeats,
            device=device,
            renderer=flags.renderer,
            progress=advance,
        )
    answer = {
        "benchmark": benchmark.name,
        "fingerprint": benchmark.fingerprint,
        "houses": list(houses),
        "repeats": flags.repeats,
        "device": str(device),
        "figures": [asdict(figure) for figure in speed.figures],
        "repetition": [
            {
                "name": each.name,
                "all": each.every,
                "distinct": each.distinct,
                "times": each.times,
            }
            for each in speed.repetitions
        ],
        "skipped": list(speed.skipped),
        "equal": speed.equal,
    }
    return answer, speed.figures


def _row(figure: Figure) -> tuple[str, ...]:
    return (
        figure.what,
        figure.way,
        str(figure.threads),
        f"{figure.ms:.2f}",
        f"{figure.times:.2f}",
        f"{figure.times_median:.2f}",
        f"{figure.difference:.0e}",
    )
