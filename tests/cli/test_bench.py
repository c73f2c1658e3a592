"""`lcrl-bench bench`: ratios between ways to one result, never seconds, on a tiny benchmark."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
import torch
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.evaluation import contests
from lcrl_bench.mdp.kernels import VARIABLE


@pytest.fixture(scope="module")
def words(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The shortest measurement there is."""
    folder = tmp_path_factory.mktemp("bench") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    shortest = ["--houses", "1", "--repeats", "1", "--threads", "1"]
    return ["bench", "--benchmark", str(folder), *shortest]


def test_every_way_gives_the_references_result_and_a_ratio_to_it(
    words, monkeypatch: pytest.MonkeyPatch, capsys
):
    monkeypatch.setenv(VARIABLE, "torch")
    threads = torch.get_num_threads()
    assert main([*words, "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert (os.environ[VARIABLE], torch.get_num_threads()) == ("torch", threads)
    assert answer["fingerprint"] == tiny_benchmark().fingerprint
    assert (answer["equal"], answer["skipped"], len(answer["houses"])) == (True, [], 1)
    by_result: dict[str, list[dict]] = {}
    for figure in answer["figures"]:
        by_result.setdefault(figure["what"], []).append(figure)
    assert [len(ways) for ways in by_result.values()] == [3, 3, 2, 3]
    for reference, *others in by_result.values():
        assert (reference["times"], reference["difference"]) == (1, 0)
        for other in others:
            assert 0 < other["ms"] <= other["ms_median"]
            assert other["times"] == pytest.approx(reference["ms"] / other["ms"])
            assert 0 <= other["difference"] < 1e-3
    # Compiled and torch round differently: no way was measured twice under two names.
    assert all(ways[-1]["difference"] > 0 for ways in by_result.values())
    for layer in answer["repetition"]:
        assert layer["all"] >= layer["distinct"] > 0
        assert layer["times"] == layer["all"] / layer["distinct"]


def test_without_numba_the_ways_of_torch_are_measured_and_it_is_said(
    words, monkeypatch: pytest.MonkeyPatch, capsys
):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(words) == ExitCode.DONE
    shown = capsys.readouterr()
    assert "numba is not installed" in shown.err
    assert "distinct patches, torch" in shown.out
    assert "compiled" not in shown.out
    assert "times as fast" in shown.out
    assert "times fewer" in shown.out


def test_a_way_that_gives_something_else_ends_red(words, monkeypatch: pytest.MonkeyPatch, capsys):
    def half(*arguments: torch.Tensor) -> torch.Tensor:
        return right(*arguments) / 2

    right = contests.convolve_views
    monkeypatch.setattr(contests, "convolve_views", half)
    assert main(words) == ExitCode.RED
    assert "'distinct patches, torch' gives something else" in capsys.readouterr().err


def test_threads_beyond_the_cores_are_skipped_and_it_is_said(words, monkeypatch, capsys):
    monkeypatch.setattr("os.sched_getaffinity", lambda pid: {0})
    assert main([*words, "--threads", "1", "2"]) == ExitCode.DONE
    shown = capsys.readouterr()
    assert "skipped: 2 threads: this process has 1 cores" in shown.err


@pytest.mark.parametrize(
    ("flags", "complaint"),
    [
        (("--threads", "0"), "--threads takes numbers from 1 on"),
        (("--threads", "4096"), "Try --threads 1"),
        (("--repeats", "0"), "--repeats 0"),
        (("--houses", "0"), "--houses 0"),
    ],
)
def test_a_measurement_of_nothing_is_refused(words, flags, complaint, capsys):
    assert main([*words, *flags]) == ExitCode.USAGE
    assert complaint in capsys.readouterr().err
