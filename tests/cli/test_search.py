"""`lcrl-bench search`: combinations, tried on validation houses, the best first."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.evaluation.search import combinations, parse_options


def test_options_are_combined_in_the_order_given():
    options = parse_options(("views=sum,max", "passes=1"))
    assert combinations(options) == (
        (("views", "sum"), ("passes", "1")),
        (("views", "max"), ("passes", "1")),
    )
    assert combinations({}) == ((),)


@pytest.mark.parametrize("word", ["views", "views="])
def test_an_option_without_a_value_is_refused(word):
    with pytest.raises(UsageError, match=r"--try"):
        combinations(parse_options((word,)))


def test_a_search_ranks_its_combinations_and_finds_finished_ones_again(tmp_path: Path, capsys):
    write_benchmark(tmp_path / "tiny", tiny_benchmark())
    words = ["search", "--method", "lcrl", "--benchmark", str(tmp_path / "tiny")]
    words += ["--out", str(tmp_path / "runs"), "--jobs", "1", "--json", "--houses", "1", "--try"]
    options = ["passes=1", "least_steps=0", "views=sum,max"]
    assert main([*words, *options]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    scores = [each["success"]["test-house"] for each in answer["findings"]]
    assert len(scores) == 2
    assert scores == sorted(scores, reverse=True)
    assert {each["settings"]["views"] for each in answer["findings"]} == {"sum", "max"}
    done = {path: path.stat().st_mtime_ns for path in (tmp_path / "runs").rglob("DONE")}
    assert len(done) == 2
    # In whichever order settings are named, they are the same runs.
    assert main([*words, *reversed(options)]) == ExitCode.DONE
    shown = capsys.readouterr()
    assert json.loads(shown.out) == answer
    assert f"read back from {tmp_path / 'runs'}: 2 runs, finished 2" in shown.err
    assert {path: path.stat().st_mtime_ns for path in done} == done


def test_a_mistyped_setting_is_named_before_anything_is_trained(tmp_path: Path, capsys):
    write_benchmark(tmp_path / "tiny", tiny_benchmark())
    words = ["search", "--method", "lcrl", "--benchmark", str(tmp_path / "tiny"), "--houses", "1"]
    words += ["--try", "view=sum", "--out", str(tmp_path / "runs"), "--jobs", "1"]
    assert main(words) == ExitCode.RED
    assert "view" in capsys.readouterr().err


def test_results_of_a_method_that_was_edited_since_are_not_ranked(tmp_path: Path, capsys):
    write_benchmark(tmp_path / "tiny", tiny_benchmark())
    shutil.copy(noise_method.__file__, tmp_path / "noise.py")
    words = ["search", "--method", f"{tmp_path / 'noise.py'}:NoiseMethod", "--houses", "1"]
    words += ["--benchmark", str(tmp_path / "tiny"), "--out", str(tmp_path / "runs")]
    words += ["--jobs", "1", "--json"]
    assert main(words) == ExitCode.DONE
    assert len(json.loads(capsys.readouterr().out)["findings"]) == 1
    with (tmp_path / "noise.py").open("a") as file:
        file.write("# edited")
    assert main(words) == ExitCode.RED
    answer = json.loads(capsys.readouterr().out)
    assert answer["findings"] == []
    assert "edited since" in answer["failed"]["noise/seed0"]
