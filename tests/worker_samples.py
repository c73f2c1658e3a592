"""Jobs for worker processes: module-level, so that a spawned process finds them."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from lcrl_bench.errors import UsageError


class Diary:
    """Does what a job's word says, and writes down in which process."""

    def __init__(self, folder: Path) -> None:
        (folder / f"made-by-{os.getpid()}").touch()
        self.folder = folder

    def __call__(self, word: str, tell: Callable[[float], None]) -> None:
        name, _, act = word.partition(":")
        if act == "fail":
            raise UsageError(f"{name} can't be done")
        if act == "bug":
            raise ZeroDivisionError
        if act == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        if act == "exit":
            os._exit(7)
        if act == "print":
            print("a word of a library on stdout")
        tell(0.5)
        if act == "long":
            (self.folder / "begun").touch()
            time.sleep(3600)
        (self.folder / name).write_text(str(os.getpid()))


class Broken:
    """Can't be set up."""

    def __init__(self) -> None:
        raise UsageError("no such benchmark")
