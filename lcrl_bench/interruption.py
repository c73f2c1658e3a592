"""Interrupting is normal: Ctrl-C and SIGTERM unwind a command, which says how to go on.

A verb that keeps its state works inside `resumable("lcrl-bench run ...")`. A stop inside that block
carries the command as a note on the exception, and `cli.main` prints it.

A signal's exception is raised wherever the program happens to be, and some places lose it: a
finalizer, an import that guards against every error, a callback from C. So the handler also takes
a note, and whatever loops or waits asks `raise_if_stopped`.
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
    """SIGTERM arrived; like KeyboardInterrupt, no handler of ordinary errors catches it."""


STOPS: Final[dict[int, type[BaseException]]] = {
    signal.SIGTERM: Terminated,
    signal.SIGINT: KeyboardInterrupt,
}
"""Signal → what it raises."""


@dataclass
class _Note:
    """What the handlers noted. Signals belong to the whole process, and so does this."""

    asked: type[BaseException] | None = None
    postponed: bool = False


_note: Final = _Note()


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Turn SIGTERM and Ctrl-C into `Terminated` and `KeyboardInterrupt` inside the block.

    A stop that was lost on its way is raised at the end of the block. Outside the main thread, and
    for a signal that the caller ignores, nothing changes.
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
    """Raise the stop that was asked for, if any: for loops and waits, in the main thread.

    Raises:
        Terminated: If SIGTERM arrived.
        KeyboardInterrupt: If Ctrl-C did.
    """
    if _note.asked is None or threading.current_thread() is not threading.main_thread():
        return
    raise _note.asked


def forget_stop() -> None:
    """Take a stop for dealt with: whoever caught it goes on as if it were the usual end."""
    _note.asked = None


@contextlib.contextmanager
def _lost_stop_raised() -> Iterator[None]:
    """Raise, at the end of the block, a stop that was lost in it.

    An error in the block may be its doing: a module that was imported by half does not work.
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
    """Let a short block come to its end: a stop is raised after it.

    For what must not be torn, such as starting a process and keeping hold of it.
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
    """Say, if the block is stopped, that its state is saved and that `command` goes on from it."""
    try:
        with _lost_stop_raised():
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
