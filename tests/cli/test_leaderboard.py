"""`lcrl-bench leaderboard`: a row's way from runs to the page, and what stops it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from board_samples import RUN, Desk

from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode

FILE = "leaderboard/submissions/tiny-lcrl.json"
BUILD = ("leaderboard", "build", "--benchmarks", "tiny")
NOISE = Path(__file__).parents[1] / "noise_method.py"


def verify(desk: Desk, *words: str) -> int:
    shared = ("--benchmark", str(desk.benchmark), "--renderer", "rays")
    return main(["leaderboard", "verify", *words, *shared])


@pytest.fixture(scope="module")
def recorded(desk, tmp_path_factory) -> Desk:
    """A desk whose row was verified, and so recorded."""
    own = desk.copy(tmp_path_factory.mktemp("recorded"))
    recordings = str(own.home / "leaderboard" / "recordings")
    assert verify(own, str(own.file), "--recordings", recordings) == ExitCode.DONE
    return own


@pytest.fixture
def shown(recorded, tmp_path, monkeypatch) -> Desk:
    """The same, to spoil."""
    monkeypatch.chdir(tmp_path)
    return recorded.copy(tmp_path)


def test_a_verified_row_is_shown_with_its_recording_and_a_player(shown, capsys):
    recorded = Path("leaderboard/recordings/tiny-lcrl")
    assert (recorded / "recording.rrd").read_bytes().startswith(b"RRF")
    assert main([*BUILD, "--json"]) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer["rows"] == {"tiny-lcrl": "verified"}
    assert answer["refused"] == []
    site = Path(answer["page"]).parent
    shown_recording = (site / "rows/tiny-lcrl/recording.rrd").read_bytes()
    assert shown_recording == (recorded / "recording.rrd").read_bytes()
    text = (site / "index.html").read_text()
    assert 'data-script="tiny-lcrl/recording.js"' in text
    for picture in ("showcase.png", "map-1.png"):
        assert (site / "rows" / "tiny-lcrl" / picture).read_bytes().startswith(b"\x89PNG")
        assert f'src="rows/tiny-lcrl/{picture}"' in text
    assert (site / "player" / "player.html").exists()


def test_without_the_viewer_recordings_are_linked_to(shown):
    assert main([*BUILD, "--no-viewer"]) == ExitCode.DONE
    assert not Path("leaderboard/site/player").exists()
    text = Path("leaderboard/site/index.html").read_text()
    assert 'href="rows/tiny-lcrl/recording.rrd"' in text
    assert "data-script=" not in text


def test_a_recording_of_another_content_is_not_shown(shown, capsys):
    document = shown.document()
    document["title"] = "Another"
    shown.rewrite(document)
    assert main([*BUILD, "--no-viewer", "--json"]) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out)["rows"] == {"tiny-lcrl": "unverified"}
    assert not Path("leaderboard/site/rows").exists()


def test_a_disputed_row_prints_the_difference_and_is_red(spoilt, capsys):
    document = spoilt.document()
    document["controls"]["lexical"]["train"]["total"] -= 2
    spoilt.rewrite(document)
    assert verify(spoilt, FILE, "--no-record") == ExitCode.RED
    shown = capsys.readouterr().out
    assert "controls.lexical.train.total" in shown
    assert "disputed: " in shown
    assert not Path("leaderboard/recordings").exists()


def test_one_refused_file_does_not_stop_the_others(spoilt, capsys):
    Path("leaderboard/submissions/torn.json").write_text("{")
    words = ("leaderboard/submissions/torn.json", FILE, "--no-record", "--json")
    assert verify(spoilt, *words) == ExitCode.RED
    answers = json.loads(capsys.readouterr().out)["submissions"]
    assert [each["verdict"] for each in answers] == ["refused", "verified"]
    assert "not valid JSON" in answers[0]["reason"]
    assert main([*BUILD, "--no-viewer"]) == ExitCode.RED
    assert "refused: " in capsys.readouterr().err


def test_every_row_is_verified_if_none_is_named(spoilt, capsys):
    assert verify(spoilt, "--no-record") == ExitCode.DONE
    assert f"verified: {FILE}" in capsys.readouterr().out
    shutil.rmtree("leaderboard")
    assert verify(spoilt, "--no-record") == ExitCode.EMPTY
    assert f"No submission in {spoilt.file.parent}" in capsys.readouterr().err


def test_a_row_can_be_trained_again(spoilt, capsys):
    shutil.rmtree("leaderboard/checkpoints")
    shutil.rmtree("runs")
    assert verify(spoilt, FILE, "--no-record") == ExitCode.RED
    assert "--retrain" in capsys.readouterr().err
    assert verify(spoilt, FILE, "--no-record", "--retrain", "again") == ExitCode.DONE
    assert "verified: " in capsys.readouterr().out
    assert Path(f"again/tiny/{RUN}/seed2/model/config.json").exists()


def test_a_method_of_ones_own_is_verified_by_who_names_its_file(spoilt, capsys):
    shutil.copy(NOISE, "noise_method.py")
    method = "noise_method.py:NoiseMethod"
    run = ["run", "--method", method, "--benchmark", "tiny", "--seeds", "0", "1", "2"]
    assert main([*run, "--renderer", "rays", "--no-record"]) == ExitCode.DONE
    submit = ["submit", "runs/tiny/noise_method", "--benchmark", "tiny", "--pack"]
    assert main(submit) == ExitCode.DONE
    file = "leaderboard/submissions/tiny-noise_method.json"
    assert f"leaderboard verify {file} --method {method}" in capsys.readouterr().err
    assert verify(spoilt, file, "--no-record") == ExitCode.USAGE
    assert "read it first, then name it" in capsys.readouterr().err
    assert verify(spoilt, file, "--no-record", "--method", method) == ExitCode.DONE


def test_a_board_of_nothing_is_not_built_and_says_where_it_looked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["leaderboard", "build"]) == ExitCode.EMPTY
    assert f"No submission in {tmp_path / 'leaderboard/submissions'}" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_the_schema_is_printed(capsys):
    assert main(["leaderboard", "schema"]) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out)["title"] == "Submission"
