"""One process writes a folder; its lock names it, and ends with it."""

from __future__ import annotations

import json
import os
import platform
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import pytest

from lcrl_bench.attempt import ATTEMPT, set_attempt
from lcrl_bench.errors import EnvironmentMissingError, ExitCode, FolderInUseError
from lcrl_bench.evaluation.folder_lock import lock_file, locked

HOLDER = """
import sys
from pathlib import Path
from lcrl_bench.evaluation.folder_lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@contextmanager
def held_by_another_process(folder: Path) -> Iterator[subprocess.Popen]:
    """A process that holds the lock of a folder until its stdin ends."""
    words = [sys.executable, "-c", HOLDER, str(folder)]
    pipe = subprocess.PIPE
    with subprocess.Popen(words, stdin=pipe, stdout=pipe, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        yield process


def test_a_second_process_is_told_who_writes(tmp_path):
    folder = tmp_path / "runs" / "seed0"
    with held_by_another_process(folder) as process:
        wanted = rf"seed0 is being written by process {process.pid} on {platform.node()}, since 2"
        with pytest.raises(FolderInUseError, match=wanted) as caught, locked(folder):
            pass
        assert caught.value.exit_code == ExitCode.ENVIRONMENT
        assert lock_file(folder).exists(), "a refused process leaves the lock alone"
    with locked(folder):
        pass


def test_the_lock_of_a_process_that_was_killed_is_taken_over(tmp_path):
    folder = tmp_path / "seed0"
    with held_by_another_process(folder) as process:
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert json.loads(lock_file(folder).read_text())["pid"] == process.pid
        with locked(folder):
            assert json.loads(lock_file(folder).read_text())["pid"] == os.getpid()


def test_nothing_is_left_of_a_lock_that_was_let_go(tmp_path):
    with pytest.raises(KeyboardInterrupt), locked(tmp_path / "seed0"):
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_a_folder_is_locked_against_its_own_process_too(tmp_path):
    with locked(tmp_path / "seed0"), pytest.raises(FolderInUseError), locked(tmp_path / "seed0"):
        pass


def test_a_lock_left_by_another_machine_has_to_be_deleted_by_hand(tmp_path):
    folder = tmp_path / "seed0"
    said = json.dumps({"pid": 7, "host": "elsewhere", "since": "2026-11-27 18:02:00"})
    lock_file(folder).write_text(said)
    wanted = r"process 7 on elsewhere, since 2026-11-27 18:02:00.*delete .*seed0\.lock"
    with pytest.raises(FolderInUseError, match=wanted), locked(folder):
        pass
    assert lock_file(folder).read_text() == said
    lock_file(folder).unlink()
    with locked(folder):
        pass


@pytest.mark.parametrize(
    ("attempt", "free"), [("c 1 a", True), ("c 2 a", False), ("c 1 b", False), ("d 1 a", False)]
)
def test_a_lock_of_a_lost_worker_elsewhere_is_taken_over_by_the_next_attempt(
    attempt, free, tmp_path, monkeypatch
):
    said = {"pid": 7, "host": "elsewhere", "since": "2026-11-27 18:02:00", "attempt": attempt}
    lock_file(tmp_path / "seed0").write_text(json.dumps(said))
    # As undone as any environment variable of a test.
    monkeypatch.setenv(ATTEMPT, "")
    set_attempt("c", 2, "a")
    with nullcontext() if free else pytest.raises(FolderInUseError), locked(tmp_path / "seed0"):
        pass


@pytest.mark.parametrize("text", ["", "{", "[]", "null"])
def test_a_lock_file_that_says_nothing_is_taken_over(text, tmp_path):
    lock_file(tmp_path / "seed0").write_text(text)
    with locked(tmp_path / "seed0"):
        assert json.loads(lock_file(tmp_path / "seed0").read_text())["pid"] == os.getpid()


def test_a_place_that_can_t_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    folder = tmp_path / "file" / "seed0"
    with pytest.raises(EnvironmentMissingError, match="can't be written"), locked(folder):
        pass
