"""`python -m tools.house_statistics`: figures beside bands, for generated houses and folders."""

from __future__ import annotations

import json

import pytest

from lcrl_bench.cli.main import run_command
from lcrl_bench.errors import ExitCode
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house
from tools.house_statistics.command import PROGRAM, main
from tools.house_statistics.reference import reference


def test_each_figure_is_a_line_with_its_band_and_verdict(capsys):
    main(["--count", "2"])
    printed = capsys.readouterr()
    assert "2 houses beside aggregates of 472 ProcTHOR houses" in printed.out
    for band in reference().bands:
        assert band.name in printed.out
    for row in reference().unmeasured:
        assert row.reason in printed.err


def test_a_folder_of_houses_gives_the_figures_of_its_seeds(tmp_path, capsys):
    for seed in (4, 5):
        write_house(tmp_path / f"{seed}.json", generate_house(seed))
    main(["--seeds", "4", "5", "--json"])
    generated = json.loads(capsys.readouterr().out)
    main(["--houses", str(tmp_path), "--json"])
    assert json.loads(capsys.readouterr().out) == generated
    assert generated["houses"] == 2
    assert {row["check"] for row in generated["figures"]} == set(range(1, 26))
    assert set(generated["figures"][0]) == {
        *("check", "name", "value", "low", "high", "band", "verdict", "note", "reason")
    }


def test_red_exactly_where_a_figure_differs_without_a_reason(capsys):
    code = main(["--seeds", "0", "--json"])
    rows = json.loads(capsys.readouterr().out)["figures"]
    unexplained = [r for r in rows if r["verdict"] == "differs" and not r["reason"]]
    assert code == (ExitCode.RED if unexplained else ExitCode.DONE)


@pytest.mark.parametrize("words", [["--count", "0"], ["--houses", "nowhere"]])
def test_what_can_not_be_measured_is_refused(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run_command(main, words, program=PROGRAM) not in (ExitCode.DONE, ExitCode.RED)
    assert "error" in capsys.readouterr().err
