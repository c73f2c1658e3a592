"""`python -m tools.speed --growth`: what is measured, and how slopes follow from it."""

from __future__ import annotations

import json

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import run_command
from lcrl_bench.errors import ExitCode, LcrlError
from tools.speed import growing
from tools.speed.command import PROGRAM, main
from tools.speed.growth import STAGES, Grown, run_stage, slope, slopes


@pytest.mark.slow
def test_two_sizes_are_built_opened_trained_on_and_evaluated(tmp_path, capsys):
    words = ["--growth", "4", "2", "--folder", str(tmp_path), "--json"]
    assert main(words) == ExitCode.DONE
    found = json.loads(capsys.readouterr().out)
    rows = found["growth"]
    assert [(row["stage"], row["houses"]) for row in rows] == [
        (s, n) for n in (2, 4) for s in STAGES
    ]
    assert all(row["cpu_s"] > 0 and row["peak_mb"] > 50 for row in rows)
    assert set(found["slopes"]) == set(STAGES)
    assert main(words) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out) == found, "it is read back"


def test_a_pass_over_a_benchmark_is_measured_in_a_process_of_its_own(tmp_path):
    write_benchmark(tmp_path / "tiny", tiny_benchmark())
    row = run_stage("pass", tmp_path / "tiny", 1)
    assert row["cpu_s"] > 0
    assert row["peak_mb"] > 50


def test_a_stage_that_fails_says_why(tmp_path):
    with pytest.raises(LcrlError, match=r"open of .*benchmark\.json"):
        run_stage("open", tmp_path / "nothing", 2)


def test_every_stage_that_is_measured_is_there():
    assert set(STAGES) <= set(growing.STAGES)


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_the_slope_is_the_power_of_growth(power):
    found = [Grown("open", n, 3 * n**power, 100) for n in (8, 76, 300, 1000)]
    assert slope(found) == pytest.approx(power)
    assert slopes(found[:1]) == {}


def test_a_size_without_a_house_to_test_in_is_refused(tmp_path, capsys):
    words = ["--growth", "1", "--folder", str(tmp_path)]
    assert run_command(main, words, program=PROGRAM) == ExitCode.USAGE
    assert "--growth" in capsys.readouterr().err
