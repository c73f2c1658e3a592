"""`lcrl-bench submit`: finished runs as one JSON, and what is refused."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from board_samples import RUN, Desk

from lcrl_bench.board.collection import learning_curve
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode
from lcrl_bench.storage import write_json

RUNS = f"runs/tiny/{RUN}"
OUT = f"leaderboard/submissions/tiny-{RUN}.json"
"""Where a row is written if no other file is named: after the folder of its runs."""


def submit(desk: Desk, *words: str) -> int:
    out = str(desk.file.relative_to(desk.home))
    return main(["submit", *words, "--benchmark", str(desk.benchmark), "--out", out])


def test_a_methods_runs_become_one_json_with_their_checkpoints(spoilt, capsys):
    shutil.rmtree(spoilt.home / "leaderboard")
    words = ["submit", RUNS, "--benchmark", str(spoilt.benchmark), "--pack", "--json"]
    assert main(words) == ExitCode.DONE
    answer = json.loads(capsys.readouterr().out)
    assert answer.pop("submission") == OUT
    Path(OUT).rename(spoilt.file)
    assert spoilt.document() == answer
    assert [seed["seed"] for seed in answer["seeds"]] == [0, 1, 2]
    assert answer["checkpoints"] == f"../checkpoints/tiny-{RUN}"
    for seed in answer["seeds"]:
        packed = spoilt.home / f"leaderboard/checkpoints/tiny-{RUN}/seed{seed['seed']}/model"
        assert {path.name for path in packed.iterdir()} == {f["path"] for f in seed["files"]}
    assert answer["changed"] == {"passes": "1", "least_steps": "1"}
    assert answer["title"] == RUN
    assert spoilt.verify().verdict == "verified"


def test_without_packing_the_checkpoints_are_where_the_runs_are(spoilt, capsys):
    assert submit(spoilt, RUNS) == ExitCode.DONE
    assert spoilt.document()["checkpoints"] == f"../../{RUNS}"
    shown = capsys.readouterr()
    assert "test-house" in shown.out
    assert "next: lcrl-bench leaderboard verify leaderboard/submissions/tiny-lcrl.json" in shown.err


def test_fewer_seeds_are_a_draft_or_nothing(spoilt, capsys):
    seeds = [f"{RUNS}/seed{seed}" for seed in (0, 1)]
    assert submit(spoilt, *seeds) == ExitCode.USAGE
    assert "2 of 3 seeds are finished" in capsys.readouterr().err
    assert submit(spoilt, *seeds, "--draft") == ExitCode.DONE
    assert spoilt.document()["draft"]


def test_an_unfinished_seed_is_left_out_of_a_folder_and_refused_by_name(spoilt, capsys):
    (spoilt.runs / "seed1" / "DONE").unlink()
    assert submit(spoilt, RUNS, "--draft") == ExitCode.DONE
    assert [seed["seed"] for seed in spoilt.document()["seeds"]] == [0, 2]
    assert submit(spoilt, f"{RUNS}/seed1", "--draft") == ExitCode.USAGE
    assert "is not finished" in capsys.readouterr().err
    assert submit(spoilt, "runs/tiny/nothing") == ExitCode.EMPTY


def test_seeds_of_different_settings_are_no_row(spoilt, capsys):
    file = spoilt.runs / "seed1" / "config.json"
    config = json.loads(file.read_text())
    write_json(file, {**config, "settings": {"passes": "2"}})
    assert submit(spoilt, RUNS) == ExitCode.RED
    assert "it differs in passes (1 then, 2 now)" in capsys.readouterr().err


def test_a_run_on_another_benchmark_is_refused(spoilt, capsys):
    for seed in range(3):
        file = spoilt.runs / f"seed{seed}" / "config.json"
        write_json(file, {**json.loads(file.read_text()), "fingerprint": "0" * 64})
    assert submit(spoilt, RUNS) == ExitCode.RED
    assert "fingerprint 000000000000" in capsys.readouterr().err


def test_a_copied_seed_is_no_seed(spoilt, capsys):
    model = spoilt.runs / "seed1" / "model"
    shutil.rmtree(model)
    shutil.copytree(spoilt.runs / "seed0" / "model", model)
    assert submit(spoilt, RUNS) == ExitCode.RED
    assert "not the model that this run trained (reward.safetensors)" in capsys.readouterr().err


@pytest.mark.parametrize("there", [False, True])
def test_a_refused_submission_leaves_no_checkpoints_and_changes_none(spoilt, there, capsys):
    board = spoilt.home / "leaderboard"
    if not there:
        shutil.rmtree(board)
    before = contents(board)
    file = spoilt.runs / "seed1" / "summary.json"
    summary = json.loads(file.read_text())
    del summary["controls"]
    write_json(file, summary)
    assert submit(spoilt, RUNS, "--pack") == ExitCode.RED
    assert "says nothing of 'controls'" in capsys.readouterr().err
    assert contents(board) == before


def contents(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_large_checkpoints_are_not_packed(spoilt, capsys):
    (spoilt.runs / "seed0" / "model" / "large.bin").write_bytes(bytes(5 * 1024 * 1024))
    assert submit(spoilt, RUNS, "--pack") == ExitCode.USAGE
    assert "say --weights URL instead" in capsys.readouterr().err


def test_a_learning_curve_is_thinned_to_means(tmp_path):
    file = tmp_path / "metrics.jsonl"
    rows = [{"step": step, "loss": float(step)} for step in range(1, 101)]
    file.write_text("".join(json.dumps(row) + "\n" for row in [*rows, {"step": 101}]))
    curve = learning_curve(file, points=10)
    assert [point["step"] for point in curve] == list(range(10, 101, 10))
    assert [point["loss"] for point in curve] == [5.5 + 10 * part for part in range(10)]
    assert learning_curve(tmp_path / "none.jsonl") == []
