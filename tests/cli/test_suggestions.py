"""The commands that are suggested can be pasted: names with blanks and quotes are quoted."""

from __future__ import annotations

import ast
import json
import shlex
from pathlib import Path

import pytest
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import write_house

AWKWARD = 'it\'s my "own" $HOME folder'
CLI = Path(__file__).parents[2] / "lcrl_bench" / "cli"


def suggested(text: str) -> list[list[str]]:
    """The words of each suggested command, as a shell reads them."""
    lines = [line.removeprefix("next: ") for line in text.splitlines() if line.startswith("next:")]
    return [shlex.split(line.rpartition("   # ")[0]) for line in lines]


@pytest.fixture
def awkward(tmp_path, monkeypatch) -> Path:
    folder = tmp_path / AWKWARD
    folder.mkdir()
    monkeypatch.chdir(tmp_path)
    return folder


def test_a_folder_of_houses_and_a_benchmark_are_quoted(awkward, capsys):
    benchmark = tiny_benchmark()
    house = next(iter(benchmark.houses.values()))
    write_house(awkward / "house.json", house)
    out = f"{AWKWARD}/houses"
    assert main(["house", "import", f"{AWKWARD}/house.json", "--out", out]) == ExitCode.DONE
    (words,) = suggested(capsys.readouterr().err)
    assert words[:5] == ["lcrl-bench", "benchmark", "build", "--houses", out]
    write_benchmark(awkward / "tiny", benchmark)
    assert main(["show", f"{AWKWARD}/tiny"]) == ExitCode.DONE
    (words,) = suggested(capsys.readouterr().err)
    assert words == ["lcrl-bench", "run", "--method", "lcrl", "--benchmark", f"{AWKWARD}/tiny"]


@pytest.mark.parametrize("flags", [(), ("--package",)])
def test_the_steps_of_a_new_method_are_quoted(awkward, flags, capsys):
    words = ["new-method", "soft_gaze", "--out", f"{AWKWARD}/gaze", *flags]
    assert main(words) == ExitCode.DONE
    steps = suggested(capsys.readouterr().err)
    assert any(f"{AWKWARD}/gaze" in word for step in steps for word in step)
    assert steps[-1][:3] == ["lcrl-bench", "run", "--method"]
    (awkward / "gaze").rename(awkward / "other")
    assert main([*words, "--json"]) == ExitCode.DONE
    assert [shlex.split(line) for line in json.loads(capsys.readouterr().out)["next"]] == steps


@pytest.mark.parametrize("kind", ["methods", "benchmarks", "sources"])
def test_what_a_list_suggests_is_about_what_it_lists(kind, capsys):
    assert main(["list", kind]) == ExitCode.DONE
    (words,) = suggested(capsys.readouterr().err)
    if words[1] == "show":
        assert main([*words[1:], "--json"]) == ExitCode.DONE
        assert json.loads(capsys.readouterr().out)["kind"] == kind.removesuffix("s")
    else:
        assert words[1:3] == ["run", "--method"]


def test_every_suggestion_is_made_of_words_and_never_of_one_text():
    found = 0
    for file in sorted(CLI.glob("*.py")):
        for call in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "suggest":
                found += 1
                assert not isinstance(call.args[0], (ast.Constant, ast.JoinedStr)), file.name
    assert found >= 9
    spelled = [file.name for file in CLI.glob("*.py") if "next: {" in file.read_text("utf-8")]
    assert spelled == ["output.py"]
