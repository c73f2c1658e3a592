"""Temporaries: a dead writer's are removed by the next one, a living writer's never."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

from lcrl_bench.staging import PREFIX, staged, sweep
from lcrl_bench.storage import atomic_folder, write_json

WRITER = """
import os, signal, sys
from pathlib import Path
from lcrl_bench.storage import atomic_folder, atomic_path

kind, target, moment = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
rename, renames = Path.rename, []

def die(*words):
    print("here", flush=True)
    sys.stdin.readline() if moment == "wait" else os.kill(os.getpid(), signal.SIGKILL)

def rename_and_die(self, to):
    renames.append(rename(self, to))
    if len(renames) == 1:
        die()

if moment == "between":
    Path.rename = rename_and_die
with (atomic_folder if kind == "folder" else atomic_path)(target) as new:
    (new / "file" if kind == "folder" else new).write_text("new")
    if moment != "between":
        die()
"""


def write(kind: str, target: Path, moment: str) -> subprocess.Popen[str]:
    words = [sys.executable, "-c", WRITER, kind, str(target), moment]
    pipe = subprocess.PIPE
    return subprocess.Popen(words, stdin=pipe, stdout=pipe, text=True)


def temporaries(folder: Path) -> list[Path]:
    return list(folder.glob(f"{PREFIX}*"))


@contextmanager
def writing(kind: str, target: Path):
    """A process that is in the middle of writing."""
    with write(kind, target, "wait") as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "here\n"
        yield process
        process.communicate("go on\n")


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_what_a_killed_writer_left_is_removed_by_the_next_writer(kind, tmp_path):
    with write(kind, tmp_path / "target", "now") as process:
        assert process.wait() == -signal.SIGKILL
    assert len(temporaries(tmp_path)) == 1
    write_json(tmp_path / "other.json", 1)
    assert [path.name for path in tmp_path.iterdir()] == ["other.json"]


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_what_a_living_writer_writes_is_left_alone(kind, tmp_path):
    with writing(kind, tmp_path / "target"):
        assert len(temporaries(tmp_path)) == 1
        write_json(tmp_path / "other.json", 1)
        assert len(temporaries(tmp_path)) == 1
    assert (tmp_path / "target").exists()
    assert temporaries(tmp_path) == []


def test_a_folder_whose_replacement_was_killed_half_way_is_brought_back(tmp_path):
    with atomic_folder(tmp_path / "target") as new:
        (new / "file").write_text("old")
    with write("folder", tmp_path / "target", "between") as process:
        assert process.wait() == -signal.SIGKILL
    assert not (tmp_path / "target").exists()
    sweep(tmp_path)
    assert (tmp_path / "target" / "file").read_text() == "old"
    assert temporaries(tmp_path) == []


def test_a_folder_that_is_there_again_is_not_replaced_by_an_old_one(tmp_path):
    with atomic_folder(tmp_path / "target") as new:
        (new / "file").write_text("old")
    with write("folder", tmp_path / "target", "between") as process:
        process.wait()
    (tmp_path / "target").mkdir()
    (tmp_path / "target" / "file").write_text("newest")
    sweep(tmp_path)
    assert (tmp_path / "target" / "file").read_text() == "newest"
    assert temporaries(tmp_path) == []


def test_without_locks_files_are_written_and_nothing_is_swept(tmp_path, monkeypatch):
    def refuse(descriptor: int, operation: int) -> None:
        raise OSError(95, os.strerror(95))

    stale = tmp_path / f"{PREFIX}stale"
    stale.write_text("whose?")
    monkeypatch.setattr(fcntl, "flock", refuse)
    write_json(tmp_path / "other.json", 1)
    assert stale.exists()
    assert (tmp_path / "other.json").read_text() == "1\n"


def test_a_temporary_is_gone_whatever_ends_its_writer(tmp_path):
    with pytest.raises(KeyboardInterrupt), staged(tmp_path / "a.npz") as temporary:  # noqa: PT012
        assert temporary.suffix == ".npz"
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []
