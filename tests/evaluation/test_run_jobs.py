"""Runs as jobs: what a job answers leads to the results that the run had."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import noise_method
import pytest
from benchmark_samples import tiny_benchmark, tiny_session

from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.errors import ExitCode, UnknownNameError
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.run import RunSpec, run
from lcrl_bench.evaluation.run_jobs import (
    FAILURE_FILE,
    SessionSpec,
    check_job,
    joined_results,
    make_run,
    run_jobs_of,
    spec_document,
    spec_of,
)
from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.job import untold
from lcrl_bench.jobs.performance import do_here
from lcrl_bench.jobs.processes import InThisProcess

NOISE = RunSpec(f"{noise_method.__file__}:NoiseMethod")


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark") / "tiny"
    write_benchmark(folder, tiny_benchmark())
    return folder


def session_of(benchmark: Path, out: Path) -> SessionSpec:
    return SessionSpec(str(benchmark), str(out), device="cpu", renderer="rays")


def test_files_of_runs_hold_the_results_and_the_controls(tmp_path):
    session = tiny_session(tmp_path)
    specs = [replace(NOISE, seed=seed) for seed in (0, 1)]
    again = [replace(spec, optimizer=Optimizer.DQN, budget=0.001, dqn_tasks=1) for spec in specs]
    results = joined_results([make_run(spec, session, untold) for spec in specs + again])
    found = [run(spec, session).results for spec in specs]
    assert results.seed_tables() == {
        seed: each.tables() for seed, each in zip((0, 1), found, strict=True)
    }
    assert {name: each.tables() for name, each in results.beside.items()} == {
        name: each.tables() for name, each in session.controls().items()
    }
    assert list(results.beside) == list(session.controls())
    assert [each.seeds for each in results.optimized.values()] == [(0, 1)]


def _remove(file: Path) -> None:
    file.unlink()


def _damage(file: Path) -> None:
    file.write_text("damaged")


def _mistake(file: Path) -> None:
    shutil.copy(file.with_name("optimal.parquet"), file)


@pytest.mark.parametrize("harm", [_remove, _damage, _mistake])
def test_controls_that_are_not_those_of_the_run_are_evaluated_when_it_is_read_back(harm, tmp_path):
    session = tiny_session(tmp_path)
    first = make_run(NOISE, session, untold)
    before = joined_results([first]).beside
    harm(Path(first.folder) / "controls" / "random.parquet")
    again = joined_results([make_run(NOISE, session, untold)]).beside
    assert {name: each.tables() for name, each in again.items()} == {
        name: each.tables() for name, each in before.items()
    }


def test_a_job_tells_of_houses_of_losses_and_of_the_end(tmp_path):
    told: list[tuple[float, str]] = []

    def tell(share: float, note: str = "") -> None:
        told.append((share, note))

    session = tiny_session(tmp_path)
    settings = {"passes": "1", "least_steps": "3"}
    first = make_run(RunSpec.of("lcrl", settings), session, tell)
    assert told[:3] == [(0.0, f"house {number} of 3") for number in (1, 2, 3)]
    assert "loss " in told[3][1]
    assert told[-1] == (1.0, "evaluating")
    told.clear()
    again = make_run(RunSpec.of("lcrl", settings), session, tell)
    assert (first.read_back, told) == ("", [])
    assert replace(again, read_back="", versions=()) == first
    assert again.read_back


def test_runs_are_checked_before_any_is_made(benchmark, tmp_path):
    session = session_of(benchmark, tmp_path / "runs")
    known = do_here(check_job(session, {"noise/seed0": NOISE}))
    assert known == {
        "benchmark": "tiny",
        "fingerprint": tiny_benchmark().fingerprint,
        "missing": ["noise/seed0"],
    }
    with pytest.raises(UnknownNameError, match="lcrll"):
        do_here(check_job(session, {"a": NOISE, "b": RunSpec("lcrll")}))
    assert not (tmp_path / "runs").exists()


def test_a_bug_of_a_method_ends_its_job_alone_and_leaves_its_traceback(benchmark, tmp_path):
    specs = {"failing": RunSpec.of(NOISE.method, {"fails": "true"}), "noise": NOISE}
    jobs = run_jobs_of(session_of(benchmark, tmp_path / "runs"), specs)
    ended = {each.key: each for each in run_jobs(jobs, InThisProcess())}
    assert ended["noise"].error is None
    assert ended["failing"].answer.exit_code == ExitCode.BUG
    (log,) = (tmp_path / "runs").rglob(FAILURE_FILE)
    assert str(log) in str(ended["failing"].error)
    assert "noise over nothing" in log.read_text("utf-8")


def test_a_spec_survives_its_document():
    spec = RunSpec.of("lcrl", {"passes": "2"}, seed=3, image_size=(16, 12), budget=0.5)
    assert spec_of(spec_document(spec)) == spec
