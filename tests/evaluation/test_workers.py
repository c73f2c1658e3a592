"""Worker processes: set up once, failures alone, order kept where it must be."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import pytest
from worker_samples import Broken, Diary

from lcrl_bench.evaluation.workers import Ended, Item, work_through


class Record:
    """A watcher that keeps what it is told."""

    def __init__(self) -> None:
        self.words: list[tuple[str, str]] = []

    def started(self, key: str) -> None:
        self.words.append(("started", key))

    def advanced(self, key: str, share: float) -> None:
        assert share == 0.5
        self.words.append(("advanced", key))

    def ended(self, ended: Ended) -> None:
        self.words.append(("ended", ended.key))


def work(folder: Path, *words: str, workers: int = 1, **after: list[str]) -> dict[str, str | None]:
    items = [Item(word.partition(":")[0], word, after=after.get(word[0], [])) for word in words]
    ended = work_through(items, partial(Diary, folder), workers=workers, watcher=Record())
    return {each.key: each.error for each in ended}


def made(folder: Path) -> int:
    return len(list(folder.glob("made-by-*")))


def test_a_worker_is_set_up_once_and_takes_job_after_job(tmp_path):
    assert work(tmp_path, "a", "b", "c") == {"a": None, "b": None, "c": None}
    assert made(tmp_path) == 1
    assert len({(tmp_path / name).read_text() for name in "abc"}) == 1


def test_failures_end_alone_whatever_they_are(tmp_path):
    ended = work(tmp_path, "a:fail", "b:die", "c:exit", "d:bug", "e", "f:print", workers=2)
    assert ended["a"] == "a can't be done"
    assert "SIGKILL" in str(ended["b"])
    assert ended["c"] == "its process ended with status 7"
    assert ended["d"] == "ZeroDivisionError"
    assert ended["e"] is None
    assert ended["f"] is None


def test_a_job_waits_for_its_predecessor_and_is_not_tried_if_that_fails(tmp_path):
    ended = work(tmp_path, "b", "a", "d", "c:fail", "e", workers=2, b=["a"], d=["c"], e=["d"])
    assert ended["b"] is None
    assert list(ended).index("a") < list(ended).index("b")
    assert ended["d"] == "not tried, because 'c' failed"
    assert ended["e"] == "not tried, because 'd' failed"
    assert not (tmp_path / "d").exists()


def test_a_worker_that_can_t_be_set_up_fails_its_jobs():
    items = [Item("a", "a"), Item("b", "b")]
    ended = work_through(items, Broken, workers=1, watcher=Record())
    assert [each.error for each in ended] == ["no such benchmark"] * 2


def test_a_worker_goes_on_with_what_it_has_at_hand(tmp_path):
    kinds = ("x", "y", "x", "y")
    items = [Item(f"{kind}{k}", f"{kind}{k}", affinity=kind) for k, kind in enumerate(kinds)]
    record = Record()
    work_through(items, partial(Diary, tmp_path), workers=1, watcher=record)
    assert [key for word, key in record.words if word == "started"] == ["x0", "x2", "y1", "y3"]
    assert [key for word, key in record.words if word == "advanced"] == ["x0", "x2", "y1", "y3"]


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
    assert not (tmp_path / "a").exists()
    (worker,) = tmp_path.glob("made-by-*")
    with pytest.raises(ProcessLookupError):
        os.kill(int(worker.name.rpartition("-")[2]), 0)


PARENT = """
import sys
from functools import partial
from pathlib import Path

from test_workers import Record
from worker_samples import Diary

from lcrl_bench.evaluation.workers import Item, work_through

if __name__ == "__main__":
    items = [Item("a", "a"), Item("b", "b:long"), Item("c", "c", after=["b"])]
    work_through(items, partial(Diary, Path(sys.argv[1])), workers=2, watcher=Record())
"""


def test_workers_end_when_their_parent_is_killed(tmp_path):
    program = tmp_path / "parent.py"
    program.write_text(PARENT)
    paths = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
    words = [sys.executable, str(program), str(tmp_path)]
    with subprocess.Popen(words, env=environment, stderr=subprocess.PIPE) as parent:
        while not ((tmp_path / "begun").exists() and (tmp_path / "a").exists()):
            assert parent.poll() is None
            time.sleep(0.02)
        parent.kill()
        # Workers share its stderr, which ends with the last of them.
        parent.communicate()
