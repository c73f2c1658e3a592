"""`python -m tools.speed`: the suite's speed, as ratios measured in one run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, print_text, say, stdout_kept_clean, warn
from lcrl_bench.cli.progress import counting
from lcrl_bench.errors import ExitCode, UsageError

if TYPE_CHECKING:
    # At run time this would import torch before a mistyped flag is named.
    from tools.speed.measurement import Figure

PROGRAM: Final = "python -m tools.speed"

COLUMNS: Final = (
    *("comparison", "variant", "threads", "ms per house", "speedup", "by medians", "difference"),
)
REPETITION_COLUMNS: Final = ("per house", "all", "distinct", "times fewer")


@dataclass(frozen=True)
class SpeedFlags:
    """Measure the suite's speed beside simpler implementations of the same computations.

    Exits with code 1 if two variants give different results.
    """

    benchmark: str = "lcrl-v1"
    """A shipped benchmark, or the folder of your own."""
    houses: int = 5
    """Number of its training houses to measure in, spread from the smallest to the largest."""
    repeats: int = 5
    """How often each variant is timed in each house, in turns with the others."""
    threads: tuple[int, ...] = (1, 2)
    """Torch threads on a CPU; each count is measured separately."""
    device: str = "cpu"
    """auto, cpu or cuda. Compiled kernels run on a CPU only."""
    renderer: str = "auto"
    """Draws views that are not in the cache: auto, gl (MuJoCo's cameras) or rays (no OpenGL)."""
    environments: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Measure the Gymnasium environments instead: opening, memory, steps per CPU second."""
    minigrid: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """With --environments: compare with MiniGrid, installed by pip in the cache folder."""
    seconds: float = 1.0
    """With --environments: CPU seconds to step each for."""
    growth: tuple[int, ...] = ()
    """Measure growth instead: benchmarks of these many houses are built, opened, trained on for one
    pass and evaluated. A thousand houses take half an hour."""
    folder: Path = Path("growth")
    """With --growth: where they are built; what is measured there already is not measured again."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""


def main(argv: Sequence[str]) -> int:
    """Run the command."""
    flags = parse_arguments(SpeedFlags, argv, program=PROGRAM)
    if flags.growth:
        return _report_growth(flags)
    if flags.environments:
        return _report_environments(flags)
    if flags.minigrid:
        raise UsageError("--minigrid needs --environments.")
    with stdout_kept_clean(flags.json):
        answer, figures = _measure(flags)
    if flags.json:
        print_json(answer)
    else:
        print_table(COLUMNS, [_row(figure) for figure in figures], right=COLUMNS[2:])
        print_text("")
        rows = [
            (each["name"], f"{each['all']:,}", f"{each['distinct']:,}", f"{each['times']:.1f}")
            for each in answer["repetition"]
        ]
        print_table(REPETITION_COLUMNS, rows, right=REPETITION_COLUMNS[1:])
    for reason in answer["skipped"]:
        say(f"skipped: {reason}")
    for figure in figures:
        if not figure.equal:
            off = f"differs from the reference by {figure.difference:.1e}"
            warn(f"{figure.comparison}: '{figure.variant}' {off}. Please report it.")
    return ExitCode.DONE if answer["equal"] else ExitCode.RED


def _report_growth(flags: SpeedFlags) -> int:
    from tools.speed.growth import STAGES, measure_growth
    from tools.speed.growth_report import growth_as_json, print_growth

    total = len(STAGES) * len(set(flags.growth))
    with stdout_kept_clean(flags.json), counting("stages", total) as advance:
        found = measure_growth(flags.growth, flags.folder, progress=advance)
    if flags.json:
        print_json(growth_as_json(found))
    else:
        print_growth(found)
    return ExitCode.DONE


def _report_environments(flags: SpeedFlags) -> int:
    from tools.speed.environment_report import environments_as_json, print_environments
    from tools.speed.environments import COUNTS, TASKS, measure_environments

    total = len(COUNTS) * (1 + flags.minigrid * len(TASKS))
    with stdout_kept_clean(flags.json), counting("environments", total) as advance:
        found = measure_environments(
            flags.benchmark,
            renderer=flags.renderer,
            counts=COUNTS,
            minigrid=flags.minigrid,
            seconds=flags.seconds,
            progress=advance,
        )
    if flags.json:
        print_json(environments_as_json(flags.benchmark, found))
    else:
        print_environments(found)
    return ExitCode.DONE


def _measure(flags: SpeedFlags) -> tuple[dict[str, Any], tuple[Figure, ...]]:
    """The JSON answer, and the figures in it."""
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.session import resolve_device
    from tools.speed.measurement import measure_speed
    from tools.speed.workload import spread_houses

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
        "figures": [_as_json(figure) for figure in speed.figures],
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


def _as_json(figure: Figure) -> dict[str, Any]:
    values = asdict(figure)
    # The names that readers of the JSON know.
    return {"what": values.pop("comparison"), "way": values.pop("variant"), **values}


def _row(figure: Figure) -> tuple[str, ...]:
    return (
        figure.comparison,
        figure.variant,
        str(figure.threads),
        f"{figure.ms:.2f}",
        f"{figure.times:.2f}",
        f"{figure.times_median:.2f}",
        f"{figure.difference:.0e}",
    )
