"""Finished runs on disk: which one is meant, whether it is the one asked for, what it learned."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import tiny_session
from run_samples import write_run

from lcrl_bench.errors import InvalidFileError, NothingSelectedError, UsageError
from lcrl_bench.evaluation.finished_runs import (
    changes,
    find_run,
    finished_runs,
    is_done,
    read_reward,
    read_run,
)
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.run import RunSpec, run
from lcrl_bench.evaluation.session import Session
from lcrl_bench.methods.contract import Reward
from lcrl_bench.storage import write_json

NOISE = f"{noise_method.__file__}:NoiseMethod"


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


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> Session:
    return tiny_session(tmp_path_factory.mktemp("runs"))


SPEC = RunSpec.of(NOISE, {"passes": "2"}, seed=3)


@pytest.fixture(scope="module")
def finished(session) -> Path:
    """The folder of a finished run, not to be changed."""
    return run(SPEC, session).folder.path


@pytest.fixture
def spoilt(finished, session) -> Iterator[Path]:
    """The same, to spoil."""
    kept = finished.with_name("kept")
    shutil.copytree(finished, kept)
    yield finished
    shutil.rmtree(finished)
    kept.rename(finished)


def test_a_run_s_folder_tells_which_run_it_is_and_what_it_learned(finished):
    spec, learned = read_run(finished)
    assert spec == SPEC
    assert isinstance(learned, Reward)
    assert find_run(finished.parent) == finished


def test_a_run_is_done_as_the_spec_that_it_was_made_by_and_no_other(finished, session):
    out, benchmark = session.place.out, session.benchmark
    assert is_done(SPEC, out, benchmark)
    assert changes(SPEC, out, benchmark) == ()
    for other in (
        replace(SPEC, seed=4),
        RunSpec.of(NOISE, {"passes": "3"}, seed=3),
        replace(SPEC, optimizer=Optimizer.DQN),
    ):
        assert not is_done(other, out, benchmark)
    assert not is_done(SPEC, out, replace(benchmark, tasks=benchmark.tasks[1:]))


def test_a_run_whose_method_is_gone_is_not_done(finished, session, tmp_path):
    gone = RunSpec.of(str(tmp_path / "noise_method.py:NoiseMethod"), {"passes": "2"}, seed=3)
    assert changes(gone, session.place.out, session.benchmark) == (
        "a method that can't be made here",
    )
    assert not is_done(gone, session.place.out, session.benchmark)


def test_a_damaged_run_is_not_done(spoilt, session):
    (spoilt / "episodes.parquet").write_bytes(b"of another run")
    assert not is_done(SPEC, session.place.out, session.benchmark)


def test_what_is_no_run_is_not_read(tmp_path, spoilt):
    (tmp_path / "config.json").write_text('{"control": "random", "settings": {}}')
    with pytest.raises(InvalidFileError, match="not the configuration of a run"):
        read_run(tmp_path)
    config = json.loads((spoilt / "config.json").read_text())
    write_json(spoilt / "config.json", {**config, "image_size": [64, 64]})
    with pytest.raises(UsageError, match="of another size"):
        read_run(spoilt)


def test_a_policy_has_no_reward(tmp_path):
    with pytest.raises(UsageError, match="learned a policy, which has no reward"):
        read_reward(write_run(tmp_path / "cloning", "cloning"))
