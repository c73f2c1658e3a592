"""Building and checking a benchmark as jobs: one per house, each a function of the house's file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

from lcrl_bench.benchmarks.benchmark import Benchmark, grid_to_json
from lcrl_bench.benchmarks.build import BuildConfig, Proved, check_ids, prove_house
from lcrl_bench.benchmarks.check import Failure, check_house
from lcrl_bench.benchmarks.document import GridDocument, TaskDocument, read_benchmark, read_grid
from lcrl_bench.houses.document import read_house
from lcrl_bench.houses.house import House
from lcrl_bench.jobs.job import Job

Tell = Callable[[float], None]


def prove_jobs(
    files: Mapping[str, Path], houses: Sequence[House], config: BuildConfig, *, renderer: str
) -> list[Job]:
    """Drawing and proving the tasks of every house.

    Args:
        files: House JSON by house id.
        houses: What the files hold.
        config: With the suite's semantics.
        renderer: `"auto"`, `"gl"` or `"rays"`.

    Raises:
        UsageError: If two houses share an id.
    """
    check_ids(houses)
    asked = {"seed": config.seed, "nav": config.nav, "pick": config.pick, "renderer": renderer}
    return [
        Job(
            name,
            f"{__name__}:prove_job",
            {**asked, "file": str(files[name]), "number": number},
            inputs=(files[name],),
        )
        for number, name in enumerate(sorted(files))
    ]


def prove_job(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of `prove_jobs`: the grid and the tasks of a house, as JSON."""
    config = BuildConfig(
        "any", seed=arguments["seed"], nav=arguments["nav"], pick=arguments["pick"]
    )
    house = read_house(Path(arguments["file"]))
    found = prove_house(house, config, arguments["number"], renderer=arguments["renderer"])
    tasks = [task.to_json() for task in found.tasks]
    return {"grid": grid_to_json(found.grid), "tasks": tasks}


def proved_of(value: Mapping[str, Any], house: House) -> Proved:
    """What a job of `prove_jobs` found out, read from its value."""
    grid = read_grid(GridDocument.model_validate(value["grid"]), house, path=Path(house.id))
    tasks = (TaskDocument.model_validate(task).to_task() for task in value["tasks"])
    return Proved(grid, tuple(tasks))


def check_jobs(
    folder: Path, benchmark: Benchmark, houses: Sequence[str], *, renderer: str
) -> list[Job]:
    """Proving the tasks of every house again.

    Args:
        folder: The benchmark's folder.
        benchmark: What it holds.
        houses: Ids of the houses.
        renderer: `"auto"`, `"gl"` or `"rays"`.
    """
    common = {
        "folder": str(folder),
        "fingerprint": benchmark.fingerprint,
        "renderer": renderer,
    }
    return [
        Job(
            name,
            f"{__name__}:check_job",
            {**common, "house": name},
            inputs=(benchmark.views[name],) if name in benchmark.views else (),
        )
        for name in houses
    ]


def check_job(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of `check_jobs`: the number of tasks, and the failures."""
    benchmark = _benchmark(arguments["folder"], arguments["fingerprint"])
    number, failures = check_house(benchmark, arguments["house"], renderer=arguments["renderer"])
    return {"checked": number, "failures": [asdict(failure) for failure in failures]}


def failures_of(value: Mapping[str, Any]) -> list[Failure]:
    """The failures that a job of `check_jobs` found, read from its value."""
    return [Failure(**failure) for failure in value["failures"]]


@lru_cache(maxsize=1)
def _benchmark(folder: str, fingerprint: str) -> Benchmark:
    """The benchmark that the jobs of this process share."""
    return read_benchmark(Path(folder))
