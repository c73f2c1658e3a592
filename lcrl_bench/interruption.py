"""Handling of Ctrl-C and SIGTERM: they unwind a command, which prints how to resume.

A verb that keeps its state works inside `resumable("lcrl-bench run ...")`. A stop inside that block
adds the command to the exception as a note, and `cli.main` prints it.

A signal's exception is raised wherever the program happens to be, and some places swallow it: a
finalizer, an import that catches all errors, a callback from C. So the handler also records the
stop, and loops and waits call `raise_if_stopped`.
"""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from types import FrameType
from typing import Final

from lcrl_bench.errors import ExitCode


class Terminated(BaseException):
    """Raised on SIGTERM; like KeyboardInterrupt, it is not caught by `except Exception`."""


STOPS: Final[dict[int, type[BaseException]]] = {
    signal.SIGTERM: Terminated,
    signal.SIGINT: KeyboardInterrupt,
}
"""Signal → the exception it raises."""


@dataclass
class _Note:
    """The stop recorded by the handlers. It is global, as signals are per process."""

    asked: type[BaseException] | None = None
    postponed: bool = False


_note: Final = _Note()


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Turn SIGTERM and Ctrl-C into `Terminated` and `KeyboardInterrupt` inside the block.

    A swallowed stop is raised at the end of the block. Outside the main thread, and for signals
    that the caller ignores, nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in STOPS}
    taken = {number for number, handler in before.items() if handler != signal.SIG_IGN}
    _note.asked, _note.postponed = None, False
    for number in taken:
        signal.signal(number, _stop)
    try:
        with _lost_stop_raised():
            yield
    finally:
        for number in taken:
            signal.signal(number, before[number])
        _note.asked = None


def raise_if_stopped() -> None:
    """Raise the recorded stop, if any: for loops and waits, in the main thread.

    Raises:
        Terminated: If SIGTERM arrived.
        KeyboardInterrupt: If Ctrl-C was pressed.
    """
    if _note.asked is None or threading.current_thread() is not threading.main_thread():
        return
    raise _note.asked


def forget_stop() -> None:
    """Forget the recorded stop, once it has been handled."""
    _note.asked = None


@contextlib.contextmanager
def _lost_stop_raised() -> Iterator[None]:
    """Raise a stop swallowed in the block at its end.

    An error in the block may be a consequence: a half-imported module does not work.
    """
    try:
        yield
    except Exception as error:
        if _note.asked is not None:
            raise _note.asked from error
        raise
    raise_if_stopped()


@contextlib.contextmanager
def stops_postponed() -> Iterator[None]:
    """Postpone stops to the end of a short block.

    For work that must not be interrupted, such as starting a process and storing its handle.
    """
    _note.postponed = True
    try:
        yield
    finally:
        _note.postponed = False
    raise_if_stopped()


def _stop(number: int, frame: FrameType | None) -> None:
    _note.asked = STOPS[number]
    if not _note.postponed:
        raise _note.asked


@contextlib.contextmanager
def resumable(command: str) -> Iterator[None]:
    """If the block is stopped, note that its state is saved and that `command` resumes it."""
    try:
        with _lost_stop_raised():
            yield
    except (KeyboardInterrupt, Terminated) as stop:
        stop.add_note(f"State is saved. Resume with: {command}")
        raise


def stop_message(stop: BaseException) -> str:
    """The message for a stop: which signal, and the commands that resume."""
    word = "Terminated." if isinstance(stop, Terminated) else "Interrupted."
    return " ".join([word, *getattr(stop, "__notes__", ())])


def stop_code(stop: BaseException) -> ExitCode:
    """The exit code of a stop: 143 for SIGTERM, 130 for Ctrl-C."""
    return ExitCode.TERMINATED if isinstance(stop, Terminated) else ExitCode.INTERRUPTED
