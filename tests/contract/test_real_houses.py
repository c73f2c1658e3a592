"""Real ProcTHOR houses, from file to trained reward (skipped where there are none)."""

from __future__ import annotations

import json

import pytest

from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode

NAMES = ("houses/ai2thor_house_3703", "houses/zg_house_100", "houses_lgpl/house_0")
FURNISHED = ("houses_lgpl/house_1", "houses_lgpl/house_2")


@pytest.fixture(scope="module")
def imported(real_houses, tmp_path_factory):
    """(folder, report rows) of importing the five real houses by the command."""
    out = tmp_path_factory.mktemp("real") / "houses"
    files = [str(real_houses / "procthor" / f"{name}.json") for name in (*NAMES, *FURNISHED)]
    with pytest.MonkeyPatch.context() as patch:
        printed: list[str] = []
        patch.setattr("builtins.print", lambda text: printed.append(text))
        assert main(["house", "import", *files, "--out", str(out), "--json"]) == ExitCode.DONE
    return out, json.loads(printed[0])["houses"]


def test_every_house_is_imported_whole(imported):
    for row in imported[1]:
        assert row["errors"] == []
        assert row["label_coverage"] == 1.0, row["unmapped"]
        assert row["rooms_missed"] == [], "every room that doors connect is reached"
        assert row["reachable"] >= 0.95 * row["tiles"]


def test_lc_rl_trains_on_a_benchmark_of_them(imported, tmp_path, capsys):
    benchmark = tmp_path / "mine"
    words = ["--houses", str(imported[0]), "--out", str(benchmark), "--name", "mine"]
    flags = ["--nav", "6", "--pick", "4", "--renderer", "rays", "--json"]
    assert main(["benchmark", "build", *words, *flags]) == ExitCode.DONE
    built = json.loads(capsys.readouterr().out)
    assert built["splits"]["train"] >= 10
    assert built["splits"]["test-house"] >= 1
    words = ["--method", "lcrl", "--benchmark", str(benchmark), "--out", str(tmp_path / "runs")]
    flags = ["--set", "least_steps=160", "--renderer", "rays", "--no-record", "--json"]
    assert main(["run", *words, *flags]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer["controls"]["optimal"] == 100
    assert answer["splits"]["train"]["total"] >= 10 * answer["controls"]["random"]
    assert answer["splits"]["train"]["nav"] >= 40
