"""Which run a folder stands for."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.evaluation.finished_runs import find_run, finished_runs


def make_run(folder: Path, *, finished: int | None) -> Path:
    folder.mkdir(parents=True)
    (folder / "config.json").write_text("{}")
    if finished is not None:
        (folder / "DONE").touch()
        os.utime(folder / "DONE", (finished, finished))
    return folder


def test_the_run_that_was_finished_last_is_meant(tmp_path):
    old = make_run(tmp_path / "mini" / "lcrl" / "seed0", finished=100)
    new = make_run(tmp_path / "lcrl-v1" / "cloning" / "seed1", finished=200)
    make_run(tmp_path / "mini" / "lcrl" / "seed1", finished=None)
    assert finished_runs(tmp_path) == (new, old)
    assert find_run(tmp_path) == new
    assert find_run(tmp_path / "mini") == old
    assert find_run(tmp_path / "mini" / "lcrl") == old


def test_a_runs_own_folder_is_that_run_even_before_it_is_finished(tmp_path):
    run = make_run(tmp_path / "seed0", finished=None)
    assert find_run(run) == run


def test_without_a_run_the_next_step_is_said(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NothingSelectedError, match="Train one: lcrl-bench run"):
        find_run()
    with pytest.raises(NothingSelectedError, match="No finished run in"):
        find_run(tmp_path)
    with pytest.raises(UsageError, match="No folder nowhere"):
        find_run(Path("nowhere"))
