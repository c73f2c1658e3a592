"""Functions of jobs: module-level, so that another process finds them by name."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from lcrl_bench.errors import UsageError
from lcrl_bench.jobs.engine import Ended
from lcrl_bench.jobs.job import Job
from lcrl_bench.storage import atomic_path

TESTS = Path(__file__).parent


def word_job(folder: Path, word: str, *, after: tuple[str, ...] = (), kept: bool = True) -> Job:
    """A job that does what a word says: `"a"`, `"a:fail"`."""
    arguments = {"folder": str(folder), "word": word}
    return Job(word.partition(":")[0], "job_samples:do", arguments, after=after, kept=kept)


def do(arguments: Mapping[str, Any], tell: Callable[[float], None]) -> dict[str, Any]:
    """Do what a word says, and write down each time that it is done, and in which process."""
    folder = Path(arguments["folder"])
    name, _, act = str(arguments["word"]).partition(":")
    _note(folder / f"{name}.tried")
    _end_early(folder, name, act)
    tell(0.5)
    _take_time(folder, name, act)
    _note(folder / f"{name}.done")
    return {"name": name, "square": len(name) ** 2}


def _end_early(folder: Path, name: str, act: str) -> None:
    if act in DEADLY and _is_first(folder / f"{name}.tried", DEADLY[act]):
        with atomic_path(folder / f"{name}.half") as half:
            half.write_text("half")
            os.kill(os.getpid(), signal.SIGKILL)
    if act == "fail":
        raise UsageError(f"{name} can't be done")
    if act == "bug":
        raise ZeroDivisionError
    if act == "exit":
        os._exit(7)
    if act == "print":
        print("a word of a library on stdout")


def _take_time(folder: Path, name: str, act: str) -> None:
    if act == "long":
        with atomic_path(folder / f"{name}.half"):
            (folder / "begun").touch()
            # Longer than a test may take, and as work is: one step after the other.
            for _ in range(3600 * 20):
                time.sleep(0.05)
    if act == "wait":
        (folder / f"{name}.begun").touch()
        while not (folder / "go").exists():
            time.sleep(0.05)
    if act == "slow":
        time.sleep(0.5)


DEADLY = {"die": 100, "die-once": 1}
"""How often a word kills its worker."""


def _note(file: Path) -> None:
    """Write down, atomically, that something was done once more."""
    with file.open("a") as lines:
        lines.write(f"{os.getpid()}\n")


def _is_first(file: Path, times: int) -> bool:
    return len(file.read_text().splitlines()) <= times


def counts(folder: Path, kind: str) -> dict[str, int]:
    """How often each word was tried or done."""
    files = sorted(folder.glob(f"*.{kind}"))
    return {file.stem: len(file.read_text().splitlines()) for file in files}


class Record:
    """A watcher that keeps what it is told."""

    def __init__(self) -> None:
        self.words: list[tuple[str, str]] = []

    def started(self, key: str) -> None:
        self.words.append(("started", key))

    def advanced(self, key: str, share: float, note: str = "") -> None:
        assert share == 0.5
        self.words.append(("advanced", key))

    def ended(self, ended: Ended) -> None:
        self.words.append(("ended", ended.key))
