"""Progress on stderr: a bar on a terminal; elsewhere, in a pipe or a log, a line every ten seconds.

Each step also lets a stop through that was lost on its way (see `interruption`).
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final

from tqdm import tqdm

from lcrl_bench.cli.output import bars_wanted, say
from lcrl_bench.interruption import raise_if_stopped

if TYPE_CHECKING:
    from lcrl_bench.jobs.engine import Ended

PERIOD_S: Final = 10.0
"""Longest silence of a working command, in seconds."""
_LOOK_S: Final = 1.0
_FORMAT = "{percentage:3.0f} %|{bar}| {n:.1f} of {total} [{elapsed}, {remaining} left]{postfix}"


@contextmanager
def counting(label: str, total: int) -> Iterator[Callable[[str], None]]:
    """Count `total` named things (0: unknown); yields the callback for each one that is done."""
    pulse = Pulse(label, total or None)
    with tqdm(desc=label, total=total, disable=not bars_wanted(), leave=False) as bar:

        def advance(name: str) -> None:
            raise_if_stopped()
            bar.set_postfix_str(name, refresh=False)
            bar.update()
            pulse.done, pulse.note = pulse.done + 1, f"last {name}" if name else ""

        with pulsing(pulse):
            yield advance


@contextmanager
def working(label: str) -> Iterator[None]:
    """Say that uncountable work is still going on."""
    with pulsing(Pulse(label)):
        yield
    raise_if_stopped()


class JobBar:
    """A bar over jobs in several processes, running ones counted in part; an `engine.Watcher`.

    Off a terminal, a line is printed as each job starts and ends.
    """

    def __init__(self, total: int) -> None:
        """Start a bar over `total` jobs."""
        self._total, self._done, self._began = total, 0, time.perf_counter()
        self._shares: dict[str, float] = {}
        self._notes: dict[str, str] = {}
        self._wanted = bars_wanted()
        self.pulse = Pulse("jobs", total)
        self._open = ExitStack()
        self._bar: tqdm[Any] = tqdm(total=total, disable=not self._wanted, bar_format=_FORMAT)

    def __enter__(self) -> JobBar:
        self._open.enter_context(pulsing(self.pulse))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()
        self._bar.close()

    def started(self, key: str) -> None:
        """A job has started."""
        self._shares[key] = 0.0
        if not self._wanted:
            say(f"{key}: started")
        self._show()

    def advanced(self, key: str, share: float, note: str = "") -> None:
        """A job has done this share of its work, in [0, 1]; `note` is what else it tells."""
        raise_if_stopped()
        self._shares[key], self._notes[key] = share, note
        self._show()

    def ended(self, ended: Ended) -> None:
        """A job has ended; the line about it stays on screen."""
        self._shares.pop(ended.key, None)
        self._done += 1
        how = f"{ended.seconds:.0f} s" if ended.error is None else f"failed: {ended.error}"
        line = f"[{self._done}/{self._total}] {ended.key}: {how}{self._left()}"
        if self._wanted:
            self._bar.write(line)
        else:
            say(line)
        self._show()

    def _left(self) -> str:
        done = self._done + sum(self._shares.values())
        if done >= self._total:
            return ""
        elapsed = time.perf_counter() - self._began
        minutes = elapsed * (self._total - done) / done / 60
        return f" (about {minutes:.0f} min left)" if minutes >= 1 else ""

    def _show(self) -> None:
        running = [
            f"{key} {100 * share:.0f} % {self._notes.get(key, '')}".rstrip()
            for key, share in self._shares.items()
        ]
        self.pulse.done, self.pulse.note = self._done, ", ".join(running)
        self._bar.set_postfix_str(self.pulse.note, refresh=False)
        self._bar.update(self._done + sum(self._shares.values()) - self._bar.n)
        self._bar.refresh()


@dataclass
class Pulse:
    """How far a piece of work has got, and when to say so."""

    label: str
    """What is being done."""
    total: float | None = None
    """How much there is to do; None if unknown."""
    clock: Callable[[], float] = time.monotonic
    """Returns the time in seconds."""
    done: float = 0.0
    """How much of `total` is done."""
    note: str = ""
    """Anything else worth saying: the loss, the running jobs."""
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
    """Print due lines until the work has ended.

    Args:
        pulse: The work.
        ended: Waits up to the given seconds; returns whether the work has ended.
        speak: Takes a line.
    """
    while not ended(_LOOK_S):
        line = pulse.due()
        if line is not None:
            # The reader may be gone; the work goes on.
            with contextlib.suppress(OSError, ValueError):
                speak(line)


@contextmanager
def pulsing(pulse: Pulse) -> Iterator[Pulse]:
    """Print due lines from a thread while the block runs; nothing where bars are drawn."""
    if bars_wanted():
        yield pulse
        return
    ended = threading.Event()
    # A daemon never delays the exit of the process.
    thread = threading.Thread(target=beat, args=(pulse, ended.wait, say), daemon=True)
    thread.start()
    try:
        yield pulse
    finally:
        ended.set()
        thread.join()
