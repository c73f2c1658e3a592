"""Freezing and re-rendering views as jobs: one per house of a benchmark folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.document import view_file
from lcrl_bench.benchmarks.house_jobs import shared_benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.benchmarks.rerender import Agreement, house_agreement
from lcrl_bench.jobs.job import Job

Tell = Callable[[float], None]


def freeze_jobs(folder: Path, benchmark: Benchmark) -> list[Job]:
    """Writing the views of every house into a benchmark's folder.

    Args:
        folder: The benchmark's folder.
        benchmark: What it holds.
    """
    common = {"folder": str(folder), "fingerprint": benchmark.fingerprint}
    return [
        Job(
            name,
            f"{__name__}:freeze_job",
            {**common, "house": name},
            outputs=(view_file(folder, name),),
        )
        for name in benchmark.houses
    ]


def freeze_job(arguments: Mapping[str, Any], tell: Tell) -> int:
    """The function of `freeze_jobs`: the size of the file that it wrote, in bytes."""
    folder, name = Path(arguments["folder"]), arguments["house"]
    benchmark = shared_benchmark(arguments["folder"], arguments["fingerprint"])
    path = view_file(folder, name)
    benchmark.scene(name).freeze(arrangements_of(benchmark.select(house=name)), path)
    return path.stat().st_size


def rerender_jobs(
    folder: Path, benchmark: Benchmark, houses: Sequence[str], backends: Sequence[str]
) -> list[Job]:
    """Rendering houses again, and comparing with the views in use.

    Args:
        folder: The benchmark's folder.
        benchmark: What it holds.
        houses: Ids of the houses.
        backends: `"gl"`, `"rays"` or both.
    """
    common = {"folder": str(folder), "fingerprint": benchmark.fingerprint}
    return [
        Job(
            f"{name} again",
            f"{__name__}:rerender_job",
            {**common, "house": name, "backends": list(backends)},
            inputs=(benchmark.views[name],) if name in benchmark.views else (),
        )
        for name in houses
    ]


def rerender_job(arguments: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """The function of `rerender_jobs`: backend -> agreement."""
    benchmark = shared_benchmark(arguments["folder"], arguments["fingerprint"])
    found = house_agreement(benchmark, arguments["house"], arguments["backends"])
    return {backend: asdict(agreement) for backend, agreement in found.items()}


def agreements_of(value: Mapping[str, Any]) -> dict[str, Agreement]:
    """What a job of `rerender_jobs` found, read from its value."""
    return {backend: Agreement(**each) for backend, each in value.items()}
