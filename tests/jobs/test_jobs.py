"""Jobs on processes: each done once, failures alone, order kept where it must be."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest
from job_samples import Record, counts, word_job

from lcrl_bench.errors import ExitCode
from lcrl_bench.jobs.engine import ATTEMPTS, Ended, run_jobs
from lcrl_bench.jobs.job import Job, forget
from lcrl_bench.jobs.processes import InThisProcess, Processes

TESTS = Path(__file__).parents[1]


def work(folder: Path, *words: str, workers: int = 1, **after: list[str]) -> dict[str, Ended]:
    jobs = [word_job(folder, word, after=tuple(after.get(word[0], ()))) for word in words]
    return {each.key: each for each in run_jobs(jobs, Processes(workers))}


def errors(ended: dict[str, Ended]) -> dict[str, str | None]:
    return {key: each.error for key, each in ended.items()}


def test_a_worker_takes_job_after_job(tmp_path):
    ended = work(tmp_path, "a", "b", "c")
    assert errors(ended) == {"a": None, "b": None, "c": None}
    assert ended["b"].answer.value == {"name": "b", "square": 1}
    assert len({(tmp_path / f"{name}.done").read_text() for name in "abc"}) == 1


def test_failures_end_alone_whatever_they_are(tmp_path):
    ended = work(tmp_path, "a:fail", "b:die", "c:exit", "d:bug", "e", "f:print", workers=2)
    assert ended["a"].error == "a can't be done"
    assert ended["a"].answer.exit_code == ExitCode.USAGE
    assert "SIGKILL" in str(ended["b"].error)
    assert ended["c"].error == "its process ended with status 7, each of the 3 times it was tried"
    assert str(ended["d"].error).startswith("ZeroDivisionError (see ")
    assert ended["d"].answer.exit_code == ExitCode.BUG
    assert ended["e"].error is None
    assert ended["f"].error is None


def test_a_job_that_kills_its_worker_is_tried_again_and_costs_no_other_job(tmp_path):
    ended = work(tmp_path, "a:slow", "b:die-once", "c:die", "d:slow", workers=2)
    assert [key for key, error in errors(ended).items() if error] == ["c"]
    assert counts(tmp_path, "tried") == {"a": 1, "b": 2, "c": ATTEMPTS, "d": 1}
    assert counts(tmp_path, "done") == {"a": 1, "b": 1, "d": 1}


def test_a_job_waits_for_its_predecessor_and_is_not_tried_if_that_fails(tmp_path):
    ended = work(tmp_path, "b", "a", "d", "c:fail", "e", workers=2, b=["a"], d=["c"], e=["d"])
    assert ended["b"].error is None
    assert list(ended).index("a") < list(ended).index("b")
    assert ended["d"].error == "not tried, because 'c' failed"
    assert ended["e"].error == "not tried, because 'd' failed"
    assert "d" not in counts(tmp_path, "tried")


def test_a_job_whose_function_is_missing_fails(tmp_path):
    jobs = [Job("a", "job_samples:nothing", {}), word_job(tmp_path, "b")]
    ended = errors({each.key: each for each in run_jobs(jobs, Processes(1))})
    assert ended == {"a": "Module 'job_samples' has no 'nothing'.", "b": None}


def test_what_is_finished_is_not_done_again_until_it_is_forgotten(tmp_path):
    jobs = [word_job(tmp_path, word) for word in ("a", "b:fail", "c")]
    first = list(run_jobs(jobs, InThisProcess()))
    again = {each.key: each for each in run_jobs(jobs, InThisProcess())}
    assert counts(tmp_path, "tried") == {"a": 1, "b": 2, "c": 1}
    assert again["a"].answer == next(each for each in first if each.key == "a").answer
    forget(jobs)
    list(run_jobs(jobs, InThisProcess()))
    assert counts(tmp_path, "tried") == {"a": 2, "b": 3, "c": 2}


def test_a_job_that_keeps_its_own_results_is_called_each_time(tmp_path):
    job = word_job(tmp_path, "a", kept=False)
    for _ in range(2):
        list(run_jobs([job], InThisProcess()))
    assert counts(tmp_path, "tried") == {"a": 2}
    assert not job.file.exists()


def test_without_an_executor_values_are_read_and_missing_ones_reported(tmp_path):
    jobs = [word_job(tmp_path, word) for word in ("a", "b")]
    list(run_jobs(jobs[:1], InThisProcess()))
    ended = errors({each.key: each for each in run_jobs(jobs, None)})
    assert ended == {"a": None, "b": "not done yet"}


def test_what_can_not_be_kept_is_done_all_the_same_unless_another_command_wants_it(
    tmp_path, monkeypatch
):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("LCRL_BENCH_HOME", str(tmp_path / "file"))
    job = word_job(tmp_path, "a")
    (ended,) = run_jobs([job], InThisProcess())
    assert ended.answer.value == {"name": "a", "square": 1}
    (ended,) = run_jobs([job], InThisProcess(), must_keep=True)
    assert "can't be written" in str(ended.error)
    assert ended.answer.exit_code == ExitCode.ENVIRONMENT


def test_a_damaged_value_is_made_again(tmp_path):
    job = word_job(tmp_path, "a")
    list(run_jobs([job], InThisProcess()))
    job.file.write_text(job.file.read_text()[:20])
    (ended,) = run_jobs([job], InThisProcess())
    assert ended.answer.value == {"name": "a", "square": 1}
    assert counts(tmp_path, "tried") == {"a": 2}


def test_a_digest_follows_function_arguments_and_the_content_of_inputs(tmp_path):
    file = tmp_path / "input.json"
    file.write_text("1")
    job = replace(word_job(tmp_path, "a"), inputs=(file,))
    before = job.digest
    assert replace(job, name="other", after=("x",)).digest == before
    assert replace(job, function="job_samples:other").digest != before
    assert replace(job, arguments={**job.arguments, "word": "b"}).digest != before
    file.write_text("2")
    assert replace(job).digest != before


TWIN = """
import json, sys
from pathlib import Path

from job_samples import word_job

from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.processes import Processes

if __name__ == "__main__":
    jobs = [word_job(Path(sys.argv[1]), f"{name}:slow") for name in "abcd"]
    print(json.dumps({each.key: each.answer.value for each in run_jobs(jobs, Processes(2))}))
"""


def start(program: str, folder: Path) -> subprocess.Popen[str]:
    file = folder / "program.py"
    file.write_text(program)
    environment = os.environ | {"PYTHONPATH": str(TESTS)}
    words = [sys.executable, str(file), str(folder)]
    pipe = subprocess.PIPE
    return subprocess.Popen(words, env=environment, stdout=pipe, stderr=pipe, text=True)


def test_two_commands_with_the_same_jobs_do_each_once(tmp_path):
    with start(TWIN, tmp_path) as one, start(TWIN, tmp_path) as other:
        said = [json.loads(command.communicate()[0]) for command in (one, other)]
    assert counts(tmp_path, "done") == dict.fromkeys("abcd", 1)
    assert said[0] == said[1]
    assert len(said[0]) == 4


def test_progress_is_told_as_it_comes(tmp_path):
    record = Record()
    jobs = [word_job(tmp_path, f"{name}:slow") for name in "ab"]
    list(run_jobs(jobs, Processes(1), record))
    assert record.words == [
        (word, key) for key in "ab" for word in ("started", "advanced", "ended")
    ]


def test_stopping_ends_the_workers_at_once(tmp_path):
    def stop() -> None:
        while not (tmp_path / "begun").exists():
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=stop)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        work(tmp_path, "a:long", "b")
    thread.join()
    # It sleeps for longer than a test may take: it was ended, not waited for.
    assert counts(tmp_path, "done") == {}
    worker = int((tmp_path / "a.tried").read_text())
    with pytest.raises(ProcessLookupError):
        os.kill(worker, 0)
    assert not list(tmp_path.rglob(".partial-*"))
    assert not word_job(tmp_path, "a:long").file.with_suffix(".lock").exists()


PARENT = """
import sys
from pathlib import Path

from job_samples import word_job

from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.processes import Processes

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    jobs = [word_job(folder, word) for word in ("a", "b:long")]
    jobs.append(word_job(folder, "c", after=("b",)))
    list(run_jobs(jobs, Processes(2)))
"""


def test_workers_end_when_their_parent_is_killed(tmp_path):
    with start(PARENT, tmp_path) as parent:
        while not ((tmp_path / "begun").exists() and (tmp_path / "a.done").exists()):
            assert parent.poll() is None
            time.sleep(0.02)
        parent.kill()
        # Workers share its stderr, which ends with the last of them.
        parent.communicate()
