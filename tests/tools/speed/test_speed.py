"""`python -m tools.speed`: ratios between variants, on a tiny benchmark; none about speed."""

from __future__ import annotations

import itertools
import json
import os
import sys
from pathlib import Path

import pytest
import torch
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import run_command
from lcrl_bench.errors import ExitCode
from lcrl_bench.mdp.kernels.dispatch import VARIABLE
from tools.speed import measurement
from tools.speed.command import PROGRAM, main
from tools.speed.comparisons import comparisons
from tools.speed.rendering import NAME, PIXEL_LIMIT, cannot_render
from tools.speed.timing import Comparison, Variant, difference, time_variants
from tools.speed.workload import spread_houses, workloads

ONE, TWO = torch.ones(3), 2 * torch.ones(3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tiny benchmark's."""
    path = tmp_path_factory.mktemp("bench") / "tiny"
    write_benchmark(path, tiny_benchmark())
    return path


def words(folder: Path, *flags: str, threads: str = "1") -> list[str]:
    """The shortest measurement there is."""
    shortest = ["--houses", "1", "--repeats", "1", "--threads", *threads.split()]
    return ["--benchmark", str(folder), "--renderer", "rays", *shortest, *flags]


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch):
    """Replaces the comparisons with one of the given variants; returns what was asked for."""

    def measure(*variants: Variant) -> list[bool]:
        def instead(load: object, *, kernels: bool) -> tuple[Comparison, ...]:
            asked.append(kernels)
            return (Comparison("ones", variants, limit=1e-3),)

        asked: list[bool] = []
        monkeypatch.setattr(measurement, "comparisons", instead)
        return asked

    return measure


def test_every_variant_gives_the_references_result_and_a_ratio_to_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setenv(VARIABLE, "torch")
    threads = torch.get_num_threads()
    assert main(words(folder, "--json")) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert (os.environ[VARIABLE], torch.get_num_threads()) == ("torch", threads)
    assert answer["fingerprint"] == tiny_benchmark().fingerprint
    assert (answer["equal"], len(answer["houses"])) == (True, 1)
    assert answer["skipped"] == ([cannot_render()] if cannot_render() else [])
    by_result: dict[str, list[dict]] = {}
    for figure in answer["figures"]:
        by_result.setdefault(figure["what"], []).append(figure)
    rendering = [] if cannot_render() else [3]
    assert [len(variants) for variants in by_result.values()] == [3, 3, 2, 5, 2, *rendering]
    for reference, *others in by_result.values():
        assert (reference["times"], reference["difference"]) == (1, 0)
        for other in others:
            assert 0 < other["ms"] <= other["ms_median"]
            assert other["times"] == pytest.approx(reference["ms"] / other["ms"])
            assert 0 <= other["difference"] < (PIXEL_LIMIT if reference["what"] == NAME else 1e-3)
    for layer in answer["repetition"]:
        assert layer["all"] >= layer["distinct"] > 0
        assert layer["times"] == layer["all"] / layer["distinct"]


def test_a_variant_runs_with_the_kernel_it_names_and_a_wrong_result_is_red(
    folder: Path, given, capsys: pytest.CaptureFixture[str]
):
    seen = []

    def look() -> list[torch.Tensor]:
        seen.append((os.environ[VARIABLE], torch.get_num_threads()))
        return [TWO if seen[-1][0] == "numba" else ONE]

    asked = given(Variant("here", look), Variant("there", look, "numba"))
    assert main(words(folder)) == ExitCode.RED
    # Once to compare, then in turns.
    assert seen == 2 * [("torch", 1), ("numba", 1)]
    assert asked == [True]
    shown = capsys.readouterr()
    assert "'there' differs from the reference by 1.0e+00" in shown.err
    assert "speedup" in shown.out
    assert "times fewer" in shown.out


def test_missing_kernels_and_cores_are_skipped_with_a_notice(
    folder: Path, given, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.setattr("os.sched_getaffinity", lambda process: {0})
    asked = given(Variant("here", lambda: [ONE]), Variant("there", lambda: [ONE]))
    assert main(words(folder, threads="1 2")) == ExitCode.DONE
    said = capsys.readouterr().err
    assert "numba is not installed" in said
    assert "skipped: 2 threads" in said
    assert asked == [False]


def test_without_kernels_no_variant_asks_for_one():
    benchmark, device = tiny_benchmark(), torch.device("cpu")
    (load,) = workloads(benchmark, spread_houses(benchmark, 1), device=device, renderer="rays")
    found = comparisons(load, kernels=False)
    assert [len(comparison.variants) for comparison in found] == [2, 2, 2]
    assert {v.kernel for comparison in found for v in comparison.variants} == {"torch"}


def test_a_variant_that_does_part_of_the_work_counts_in_full():
    ticks = itertools.count()
    comparison = Comparison(
        "ones",
        (Variant("all", lambda: [ONE]), Variant("a quarter", lambda: [ONE], share=0.25)),
        limit=1e-3,
        clock=lambda: float(next(ticks)),
    )
    timings = time_variants(comparison, repeats=3, device=torch.device("cpu"))
    assert [timing.seconds for timing in timings] == [(1.0, 1.0, 1.0), (4.0, 4.0, 4.0)]


def test_houses_are_spread_from_the_smallest_to_the_largest():
    benchmark = tiny_benchmark()
    sizes = [benchmark.grids[name].tiles for name in spread_houses(benchmark, 5)]
    assert sizes == sorted(sizes)
    assert len(sizes) == 2
    assert spread_houses(benchmark, 1) == spread_houses(benchmark, 2)[1:]


def test_a_difference_is_a_share_of_each_tensor_and_no_number_is_the_largest():
    assert difference([ONE, 1e6 * ONE], [TWO, 1e6 * ONE]) == pytest.approx(0.5)
    assert difference([ONE * torch.nan], [ONE]) == float("inf")
    assert difference([0 * ONE], [0 * ONE]) == 0


@pytest.mark.parametrize(
    ("flags", "complaint"),
    [
        (("--threads", "0"), "--threads 0: give at least 1"),
        (("--threads", "4096"), "Try --threads 1"),
        (("--repeats", "0"), "--repeats 0"),
        (("--houses", "0"), "--houses 0"),
    ],
)
def test_a_measurement_of_nothing_is_refused(folder, flags, complaint, capsys):
    words = ["--benchmark", str(folder), *flags]
    assert run_command(main, words, program=PROGRAM) == ExitCode.USAGE
    assert complaint in capsys.readouterr().err
