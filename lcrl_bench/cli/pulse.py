"""A line about long work every ten seconds, for whoever sees no bar: a pipe, a log file."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final

from lcrl_bench.cli.output import bars_wanted, say

PERIOD_S: Final = 10.0
"""Longest silence of a command that is at work, in seconds."""
_LOOK_S: Final = 1.0


@dataclass
class Pulse:
    """How far a piece of work is, and when that is to be said."""

    label: str
    """What is being done."""
    total: float | None = None
    """How much there is to do; None if that is not known."""
    clock: Callable[[], float] = time.monotonic
    """Tells the time in seconds."""
    done: float = 0.0
    """How much of `total` is done."""
    note: str = ""
    """What else there is to say: the loss, what is at work."""
    _began: float = field(init=False)
    _last: float = field(init=False)

    def __post_init__(self) -> None:
        """Start the clock."""
        self._began = self._last = self.clock()

    def due(self) -> str | None:
        """The line to print now; None if the last one was less than `PERIOD_S` ago."""
        now = self.clock()
        if now - self._last < PERIOD_S:
            return None
        self._last = now
        known = self.total is not None and self.total > 0
        parts = [f"{self.done:g} of {self.total:g}"] if known else []
        parts += [self.note] if self.note else []
        return f"{self.label}: {', '.join(parts) or 'at work'} ({now - self._began:.0f} s)"


def beat(pulse: Pulse, ended: Callable[[float], bool], speak: Callable[[str], None]) -> None:
    """Print what is due until the work has ended.

    Args:
        pulse: The work.
        ended: Waits so many seconds at most; whether the work has ended.
        speak: Takes a line.
    """
    while not ended(_LOOK_S):
        line = pulse.due()
        if line is not None:
            # Whoever read it may have left, and the work goes on.
            with contextlib.suppress(OSError, ValueError):
                speak(line)


@contextlib.contextmanager
def pulsing(pulse: Pulse) -> Iterator[Pulse]:
    """Print what is due while the block is at work, from a thread; nothing where bars are drawn."""
    if bars_wanted():
        yield pulse
        return
    ended = threading.Event()
    # A daemon: it never keeps a process that is on its way out.
    thread = threading.Thread(target=beat, args=(pulse, ended.wait, say), daemon=True)
    thread.start()
    try:
        yield pulse
    finally:
        ended.set()
        thread.join()
