"""Building and checking a benchmark as jobs: one per house, each a function of the house's file."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from lcrl_bench.benchmarks.benchmark import Benchmark, grid_to_json
from lcrl_bench.benchmarks.build import BuildConfig, house_stream
from lcrl_bench.benchmarks.built_house import BuiltHouse, build_house
from lcrl_bench.benchmarks.check import Failure, check_house
from lcrl_bench.benchmarks.document import GridDocument, TaskDocument, read_benchmark
from lcrl_bench.errors import UsageError
from lcrl_bench.houses.document import house_to_json, parse_house, read_house
from lcrl_bench.houses.house import House
from lcrl_bench.houses.procedural import generate_house, house_id
from lcrl_bench.jobs.job import Job
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS

Tell = Callable[[float], None]


def build_jobs(houses: Mapping[Path, House], config: BuildConfig, *, renderer: str) -> list[Job]:
    """Drawing and proving the tasks of every house; the jobs are named after the houses.

    Args:
        houses: House JSON, and what it holds.
        config: With the suite's semantics.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.

    Raises:
        UsageError: If two houses share an id.
    """
    names = Counter(house.id for house in houses.values())
    if doubled := [name for name, count in names.items() if count > 1]:
        raise UsageError(f"Several houses are named {doubled}; rename all but one.")
    files = {house.id: file for file, house in houses.items()}
    return [
        Job(
            name,
            f"{__name__}:build_job",
            {**_asked(config, renderer), "file": str(files[name]), "number": number},
            inputs=(files[name],),
        )
        for number, name in enumerate(sorted(files))
    ]


def procedural_jobs(seeds: Iterable[int], config: BuildConfig, *, renderer: str) -> list[Job]:
    """The same for houses that are generated from seeds, all different."""
    of = {house_id(seed): seed for seed in seeds}
    return [
        Job(
            name,
            f"{__name__}:build_job",
            {**_asked(config, renderer), "house_seed": of[name], "number": number},
        )
        for number, name in enumerate(sorted(of))
    ]


def _asked(config: BuildConfig, renderer: str) -> dict[str, Any]:
    return {"seed": config.seed, "nav": config.nav, "pick": config.pick, "renderer": renderer}


def build_job(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of both: the grid and the tasks of a house as JSON, and the house if it is new.

    The stream of a house is that of its place among all; which others there are has no effect.
    """
    new = "house_seed" in arguments
    house = generate_house(arguments["house_seed"]) if new else read_house(Path(arguments["file"]))
    found = build_house(
        house,
        DEFAULT_SEMANTICS,
        nav=arguments["nav"],
        pick=arguments["pick"],
        rng=house_stream(arguments["number"], arguments["seed"]),
        renderer=arguments["renderer"],
    )
    tasks = [task.to_json() for task in found.tasks]
    answer = {"grid": grid_to_json(found.grid), "tasks": tasks}
    return {**answer, "house": house_to_json(house)} if new else answer


def built_of(value: Mapping[str, Any], house: House | None = None) -> BuiltHouse:
    """What a job made of a house, read from its value.

    Args:
        value: The job's.
        house: The house; None if it was generated, and is in the value.
    """
    house = house or parse_house(value["house"], path=value["house"]["id"])
    tasks = (TaskDocument.model_validate(task).to_task() for task in value["tasks"])
    row = GridDocument.model_validate(value["grid"])
    grid = Grid(
        tile=row.tile,
        origin=row.origin,
        cells=np.array(row.cells, np.int64),
        points=np.array(row.points, np.float64),
        neighbours=np.array(row.neighbours, np.int64).reshape(-1, HEADINGS),
        rooms=tuple(row.rooms),
    )
    return BuiltHouse(house, grid, tuple(tasks))


def check_jobs(
    folder: Path, benchmark: Benchmark, houses: Sequence[str], *, renderer: str
) -> list[Job]:
    """Proving the tasks of every house again.

    Args:
        folder: The benchmark's folder.
        benchmark: What it holds.
        houses: Ids of the houses.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`.
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
    benchmark = shared_benchmark(arguments["folder"], arguments["fingerprint"])
    number, failures = check_house(benchmark, arguments["house"], renderer=arguments["renderer"])
    return {"checked": number, "failures": [asdict(failure) for failure in failures]}


def failures_of(value: Mapping[str, Any]) -> list[Failure]:
    """The failures that a job of `check_jobs` found, read from its value."""
    return [Failure(**failure) for failure in value["failures"]]


@lru_cache(maxsize=1)
def shared_benchmark(folder: str, fingerprint: str) -> Benchmark:
    """The benchmark that the jobs of this process share."""
    return read_benchmark(Path(folder))
