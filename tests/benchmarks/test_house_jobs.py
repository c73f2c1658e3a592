"""A benchmark that is built and checked house by house is the one that is built at once."""

from __future__ import annotations

import json

import pytest
from benchmark_samples import CONFIG, SEEDS, tiny_benchmark

from lcrl_bench.benchmarks.build import house_stream, join_houses, random_streams
from lcrl_bench.benchmarks.check import check_benchmark, split_failures
from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.benchmarks.house_jobs import (
    build_jobs,
    built_of,
    check_jobs,
    failures_of,
    procedural_jobs,
)
from lcrl_bench.errors import UsageError
from lcrl_bench.houses.document import read_house, write_house
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.processes import InThisProcess


@pytest.fixture
def houses(tmp_path):
    for seed in SEEDS:
        write_house(tmp_path / f"{seed}.json", generate_house(seed, rooms=4))
    return {file: read_house(file) for file in sorted(tmp_path.glob("*.json"))}


def test_houses_built_one_by_one_in_any_order_are_the_same_benchmark(houses):
    jobs = build_jobs(houses, CONFIG, renderer="rays")
    values = {each.key: each.answer.value for each in run_jobs(jobs[::-1], InThisProcess())}
    # As they cross processes.
    values = json.loads(json.dumps(values))
    built = [built_of(values[house.id], house) for house in houses.values()]
    rng, _ = random_streams(list(values), CONFIG.seed)
    benchmark = join_houses(built, CONFIG, rng)
    assert benchmark.fingerprint == tiny_benchmark().fingerprint
    assert benchmark.tasks == tiny_benchmark().tasks


def test_two_houses_of_one_name_are_refused(houses, tmp_path):
    twice = {**houses, tmp_path / "again.json": next(iter(houses.values()))}
    with pytest.raises(UsageError, match="procedural-11"):
        build_jobs(twice, CONFIG, renderer="rays")


def test_houses_checked_one_by_one_have_the_failures_of_all(tmp_path):
    folder, benchmark = tmp_path / "tiny", tiny_benchmark()
    write_benchmark(folder, benchmark)
    names = tuple(benchmark.houses)
    jobs = check_jobs(folder, benchmark, names, renderer="rays")
    values = [each.answer.value for each in run_jobs(jobs, InThisProcess())]
    found = split_failures(benchmark) + [one for each in values for one in failures_of(each)]
    assert (sum(each["checked"] for each in values), found) == check_benchmark(
        benchmark, renderer="rays"
    )


def test_generated_houses_are_the_benchmark_of_the_same_houses_from_files(tmp_path):
    for seed in (11, 12):
        write_house(tmp_path / f"{seed}.json", generate_house(seed))
    houses = {file: read_house(file) for file in sorted(tmp_path.glob("*.json"))}
    read = run_jobs(build_jobs(houses, CONFIG, renderer="rays"), InThisProcess())
    made = run_jobs(procedural_jobs((11, 12), CONFIG, renderer="rays"), InThisProcess())
    whole = {house.id: house for house in houses.values()}
    for one, other in zip(read, made, strict=True):
        assert built_of(other.answer.value).house == whole[one.key]
        assert (
            built_of(other.answer.value).tasks == built_of(one.answer.value, whole[one.key]).tasks
        )


def test_the_stream_of_a_house_is_that_of_its_place_among_all():
    _, streams = random_streams(["a", "b", "c"], 5)
    assert house_stream(2, 5).random() == streams["c"].random()
