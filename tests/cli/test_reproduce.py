"""`lcrl-bench reproduce` from the outside: the second table and the image sizes."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.main import main
from lcrl_bench.cli.reproduce import ReproduceFlags, budget_of
from lcrl_bench.errors import ExitCode

ROOT = Path(__file__).parents[2]


def test_every_command_of_the_page_is_one():
    page = (ROOT / "docs" / "reproducing.md").read_text("utf-8")
    shown = re.findall(r"^lcrl-bench reproduce (.*)$", page, flags=re.MULTILINE)
    assert len(shown) >= 4
    for command in shown:
        budget_of(parse_arguments(ReproduceFlags, shlex.split(command), verb="reproduce"))


@pytest.fixture(scope="module")
def workplace(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("reproduce")
    write_benchmark(folder / "tiny", tiny_benchmark())
    return folder


def reproduce(workplace: Path, table: str, *more: str) -> int:
    words = ("--benchmark", str(workplace / "tiny"), "--out", str(workplace / "runs"))
    results = ("--results", str(workplace / "results"), "--renderer", "rays", "--device", "cpu")
    return main(["reproduce", table, *words, *results, "--budget", "0.001", *more])


def test_rewards_are_optimised_again_beside_their_runs(workplace, capsys):
    assert reproduce(workplace, "table-2", "--jobs", "2", "--json") == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert (answer["seeds"], answer["budget"], answer["done"]) == ([0], 0.001, 6)
    run = workplace / "runs" / "tiny" / "lcrl-budget-0.001" / "seed0"
    for name in ("dqn-shaping", "dqn"):
        again = json.loads((run / f"{name}.json").read_text())
        assert again["settings"]["config"]["shaping"] == (
            "none" if name == "dqn" else "optimal-value"
        )
        assert sum(split["n"] for split in again["splits"].values()) == 3
    page = Path(answer["tables"]["table-2"]["page"])
    assert page.name == "table-2-tiny-budget-0.001-seeds-0.md"
    assert "only 0.001 of the full training" in page.with_suffix(".svg").read_text()
    text = page.read_text()
    assert "**Reduced: 0.001 of the full training.**" in text
    assert "|  | train | test-task | test-house |" in text
    assert "\\| 12.9 |" in text

    (run / "dqn.json").unlink()
    assert reproduce(workplace, "table-2", "--json") == ExitCode.DONE
    again = json.loads(capsys.readouterr().out)
    assert (again["found"], again["done"]) == (5, 1)
    assert page.with_suffix(".json").read_text().count('"dqn"') == text.count("| dqn |")


def test_image_sizes_share_the_run_of_the_benchmark_s_own(workplace, capsys):
    assert reproduce(workplace, "image-size", "--jobs", "1") == ExitCode.DONE
    shown = capsys.readouterr()
    assert "64 by 64" in shown.out
    assert "70.6" in shown.out
    assert "written: " in shown.err
    runs = workplace / "runs" / "tiny"
    large = json.loads((runs / "lcrl-64x64-budget-0.001" / "seed0" / "config.json").read_text())
    assert large["image_size"] == [64, 64]
    network = runs / "lcrl-64x64-budget-0.001" / "seed0" / "model" / "config.json"
    assert json.loads(network.read_text())["network"]["width"] == 64


def test_what_is_not_run_is_said_to_be_missing(workplace, capsys):
    # Nothing is run twice, whichever test comes first.
    assert reproduce(workplace, "table-2", "--jobs", "2") == ExitCode.DONE
    capsys.readouterr()
    code = reproduce(workplace, "table-1", "--no-train", "--json")
    assert code == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert not answer["tables"]["table-1"]["complete"]
    text = Path(answer["tables"]["table-1"]["page"]).read_text()
    assert "**Unfinished: 2 of 10 runs are done.**" in text
    assert "| **not run** |" in text
    index = (workplace / "results" / "README.md").read_text()
    assert "table-1-tiny-budget-0.001-seeds-0-unfinished.md" in index
