"""Interrupting is normal: Ctrl-C and SIGTERM unwind a command, which says how to go on.

A verb that keeps its state works inside `resumable("lcrl-bench run ...")`. A stop inside that block
carries the command as a note on the exception, and `cli.main` prints it.
"""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from types import FrameType

from lcrl_bench.errors import ExitCode


class Terminated(BaseException):
    """SIGTERM arrived; like KeyboardInterrupt, no handler of ordinary errors catches it."""


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Turn SIGTERM into `Terminated` inside the block (in the main thread; elsewhere, nothing)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = signal.signal(signal.SIGTERM, _terminate)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)


def _terminate(number: int, frame: FrameType | None) -> None:
    raise Terminated


@contextlib.contextmanager
def resumable(command: str) -> Iterator[None]:
    """Say, if the block is stopped, that its state is saved and that `command` goes on from it."""
    try:
        yield
    except (KeyboardInterrupt, Terminated) as stop:
        stop.add_note(f"State is saved. Resume with: {command}")
        raise


def stop_message(stop: BaseException) -> str:
    """What to print about a stop: which signal, and the resume commands it carries."""
    word = "Terminated." if isinstance(stop, Terminated) else "Interrupted."
    return " ".join([word, *getattr(stop, "__notes__", ())])


def stop_code(stop: BaseException) -> ExitCode:
    """The exit code of a stop: 143 for SIGTERM, 130 for Ctrl-C."""
    return ExitCode.TERMINATED if isinstance(stop, Terminated) else ExitCode.INTERRUPTED
