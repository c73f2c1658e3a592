"""What every benchmark that ships with the suite must be."""

from __future__ import annotations

import re
import shlex

import pytest

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder, list_benchmarks
from lcrl_bench.benchmarks.check import check_benchmark
from lcrl_bench.benchmarks.description import describe_benchmark
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import house_digest

SAMPLE = 2
"""Houses proved again in every run of the suite; the marked tests prove them all."""


@pytest.fixture(scope="module", params=list_benchmarks())
def benchmark(request) -> Benchmark:
    return read_benchmark(benchmark_folder(request.param))


def test_the_shipped_ones_are_these():
    assert list_benchmarks() == ("lcrl-v1", "mini")


def test_lcrl_v1_has_the_paper_s_counts():
    figures = describe_benchmark(read_benchmark(benchmark_folder("lcrl-v1")))
    assert (figures["houses"], figures["tasks"]) == (76, 1413)
    assert (figures["pick"], figures["nav"]) == (716, 697)
    assert figures["splits"] == {"train": 1004, "test-task": 236, "test-house": 173}
    assert (figures["objects"], figures["classes"]) == (14, 61)


def test_no_house_is_in_two_benchmarks():
    digests = [
        {house_digest(house) for house in read_benchmark(benchmark_folder(name)).houses.values()}
        for name in list_benchmarks()
    ]
    assert sum(map(len, digests)) == len(set.union(*digests))


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
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", list_benchmarks())
def test_the_commands_of_its_card_make_it_again(name, tmp_path, monkeypatch, capsys):
    card = (benchmark_folder(name) / "README.md").read_text("utf-8")
    (block,) = re.findall(r"```sh\n(.*?)```", card, flags=re.DOTALL)
    monkeypatch.chdir(tmp_path)
    for command in block.splitlines():
        assert main(shlex.split(command)[1:]) == ExitCode.DONE
    again, shipped = read_benchmark(tmp_path / name), read_benchmark(benchmark_folder(name))
    assert again.fingerprint == shipped.fingerprint
    assert set(again.views) == set(shipped.views)
    capsys.readouterr()
