"""Jobs through submitit, on its own executor for this machine: the same laws as anywhere."""

from __future__ import annotations

import os
import signal
import threading
import time

import pytest
from job_samples import counts, word_job

from lcrl_bench.errors import UsageError
from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.processes import InThisProcess

pytest.importorskip("submitit", reason="submitit is not installed: the extra [slurm]")

from lcrl_bench.jobs.slurm import SlurmExecutor


@pytest.fixture(autouse=True)
def found_by_jobs(monkeypatch, request):
    """Let the queue's processes find the functions of the tests' jobs."""
    monkeypatch.setenv("PYTHONPATH", str(request.config.rootpath / "tests"))


def local(workers: int = 2) -> SlurmExecutor:
    return SlurmExecutor({"timeout_min": 60}, workers=workers, cluster="local")


def test_jobs_of_a_queue_have_the_values_of_jobs_here(tmp_path):
    words = ("a", "b:die-once", "c:fail", "d")
    jobs = [word_job(tmp_path, word) for word in words]
    ended = {each.key: [each.error, each.answer.value] for each in run_jobs(jobs, local())}
    assert counts(tmp_path, "done") == {"a": 1, "b": 1, "d": 1}
    assert counts(tmp_path, "tried") == {"a": 1, "b": 2, "c": 1, "d": 1}
    here = tmp_path / "here"
    here.mkdir()
    alike = [word_job(here, word) for word in ("a", "b", "c:fail", "d")]
    assert ended == {
        each.key: [each.error, each.answer.value] for each in run_jobs(alike, InThisProcess())
    }


def test_a_job_that_kills_each_of_its_workers_fails_alone(tmp_path):
    jobs = [word_job(tmp_path, word) for word in ("a:die", "b")]
    ended = {each.key: each.error for each in run_jobs(jobs, local())}
    assert ended["b"] is None
    assert "each of the 3 times it was tried" in str(ended["a"])


def test_stopping_cancels_the_queue(tmp_path):
    def stop() -> None:
        while not (tmp_path / "begun").exists():
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=stop)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        list(run_jobs([word_job(tmp_path, "a:long")], local()))
    thread.join()
    assert counts(tmp_path, "done") == {}
    worker = int((tmp_path / "a.tried").read_text())
    with pytest.raises(ProcessLookupError):
        os.kill(worker, 0)
    assert not list(tmp_path.rglob(".partial-*"))


def test_an_option_that_the_queue_does_not_know_is_named():
    with pytest.raises(UsageError, match="slurm_partitoin"):
        SlurmExecutor({"slurm_partitoin": "cpu"}, workers=0, cluster="local")
