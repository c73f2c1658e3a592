"""`lcrl-bench benchmark build` and `check`."""

from __future__ import annotations

import json

import pytest
from benchmark_samples import SEEDS, tiny_benchmark

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(path, tiny_benchmark())
    return path


def test_a_benchmark_is_built_from_a_folder_of_houses_and_proved(tmp_path, capsys):
    for seed in SEEDS[:2]:
        write_house(tmp_path / "houses" / f"{seed}" / "house.json", generate_house(seed, rooms=4))
    out, flags = tmp_path / "mine", ("--nav", "9", "--pick", "3", "--renderer", "rays", "--json")
    words = ["--houses", str(tmp_path / "houses"), "--out", str(out), "--name", "mine"]
    assert main(["benchmark", "build", *words, *flags]) == ExitCode.DONE
    built = json.loads(capsys.readouterr().out)
    assert built["houses"] == 2
    assert main(["benchmark", "check", str(out), "--renderer", "rays", "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer == {"checked": sum(built["splits"].values()), "failed": 0, "failures": []}


def test_a_failed_check_is_red_and_names_the_task(folder, tmp_path, capsys):
    rows = json.loads((folder / "tasks.json").read_text())
    forged = tiny_benchmark().tasks[0]
    rows["tasks"][0]["proof"]["optimal_length"] += 1
    copy = tmp_path / "forged"
    for path in folder.rglob("*.json"):
        target = copy / path.relative_to(folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())
    (copy / "tasks.json").write_text(json.dumps(rows))
    code = main(["benchmark", "check", str(copy), "--json"])
    assert code == ExitCode.ENVIRONMENT, "its fingerprint does not match"
    from lcrl_bench.benchmarks.document import read_benchmark

    write_benchmark(copy, read_benchmark(copy, verify=False))
    words = [str(copy), "--houses", forged.house, "--renderer", "rays", "--json"]
    capsys.readouterr()
    assert main(["benchmark", "check", *words]) == ExitCode.RED
    answer = json.loads(capsys.readouterr().out)
    assert answer["failed"] == 1
    assert answer["failures"][0]["subject"] == forged.id


def test_an_empty_folder_is_nothing_selected(tmp_path, capsys):
    words = ["--houses", str(tmp_path), "--out", str(tmp_path / "out"), "--name", "mine"]
    assert main(["benchmark", "build", *words]) == ExitCode.EMPTY
    assert "house import" in capsys.readouterr().err


def test_a_folder_that_is_no_benchmark_is_never_replaced(tmp_path, capsys):
    precious = tmp_path / "thesis"
    precious.mkdir()
    (precious / "chapter.txt").write_text("years")
    words = ["--houses", str(tmp_path), "--out", str(precious), "--name", "mine"]
    assert main(["benchmark", "build", *words]) == ExitCode.USAGE
    assert (precious / "chapter.txt").read_text() == "years"
    capsys.readouterr()


def test_an_unknown_house_lists_the_ones_there_are(folder, capsys):
    assert main(["benchmark", "check", str(folder), "--houses", "attic"]) == ExitCode.USAGE
    assert tiny_benchmark().tasks[0].house in capsys.readouterr().err
