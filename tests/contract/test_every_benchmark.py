"""What every benchmark that ships with the suite must be."""

from __future__ import annotations

import pytest

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.build import BuildConfig, build_benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder, benchmark_names
from lcrl_bench.benchmarks.check import check_benchmark
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.houses.procedural import generate_house

SAMPLE = 2
"""Houses proved again in every run of the suite; the marked tests prove them all."""


@pytest.fixture(scope="module", params=benchmark_names())
def benchmark(request) -> Benchmark:
    return read_benchmark(benchmark_folder(request.param))


def test_there_is_one():
    assert "mini" in benchmark_names()


def test_its_splits_hold_both_kinds_and_its_card_is_there(benchmark):
    for split in Split:
        for kind in Kind:
            assert benchmark.select(split=split, kind=kind), f"no {kind} in {split}"
    assert (benchmark_folder(benchmark.name) / "README.md").is_file()


def test_a_sample_of_its_tasks_is_proved_again(benchmark):
    houses = tuple(sorted(benchmark.houses))[:SAMPLE]
    checked, failures = check_benchmark(benchmark, houses=houses, renderer="rays")
    assert checked == sum(len(benchmark.select(house=house)) for house in houses)
    assert failures == []


@pytest.mark.slow
@pytest.mark.parametrize("renderer", ["auto", "rays"])
def test_all_its_tasks_are_proved_again(benchmark, renderer):
    checked, failures = check_benchmark(benchmark, renderer=renderer)
    assert checked == len(benchmark.tasks)
    assert failures == []


@pytest.mark.slow
def test_mini_is_what_its_card_says_how_to_make():
    houses = [generate_house(1_000_000 + k) for k in range(12)]
    again = build_benchmark(houses, BuildConfig(name="mini"), renderer="rays")
    assert again.fingerprint == read_benchmark(benchmark_folder("mini")).fingerprint
