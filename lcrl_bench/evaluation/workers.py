"""Worker processes that stay: each is set up once and takes job after job.

A job that fails, or that takes its process with it, ends alone: the others go on in other
processes. A worker ignores Ctrl-C, which the parent turns into an orderly end; if the parent is
gone, its workers notice at the next word they want to say to it.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Any, Final, Protocol

from lcrl_bench.interruption import raise_if_stopped

Perform = Callable[[Any, Callable[[float], None]], None]
"""Does a job; is to say now and then which share of it is done, 0 .. 1."""

WORD_S: Final = 0.5
"""Least time between two words of a worker about its progress, in seconds."""
_PATIENCE_S: Final = 60.0


@dataclass(frozen=True)
class Item:
    """A job as the pool sees it."""

    key: str
    """Its name among all jobs."""
    value: Any
    """What the worker is handed; must survive being sent to a process."""
    after: Collection[str] = ()
    """Keys of jobs that must have ended well before."""
    affinity: str = ""
    """A worker that has just done a job of this kind takes another one of it first."""


@dataclass(frozen=True)
class Ended:
    """How a job ended."""

    key: str
    error: str | None
    """None if it ended well."""
    seconds: float


class Watcher(Protocol):
    """Is told how the work goes."""

    def started(self, key: str) -> None:
        """A worker took a job."""

    def advanced(self, key: str, share: float) -> None:
        """A share of a job is done, 0 .. 1."""

    def ended(self, ended: Ended) -> None:
        """A job ended, well or not."""


def work_through(
    items: Sequence[Item], factory: Callable[[], Perform], *, workers: int, watcher: Watcher
) -> tuple[Ended, ...]:
    """Do all jobs, in order as far as `after` lets them, on several processes.

    Args:
        items: The jobs; every key of an `after` is one of them.
        factory: Called once in each worker, at its first job; makes what does jobs there. It must
            survive being sent to a process.
        workers: How many processes at most.
        watcher: Told how it goes, in this process.

    Returns:
        How each job ended, in the order they ended. A job after one that failed is not tried.
    """
    pool = _Pool(list(items), factory, workers, watcher)
    try:
        while pool.step():
            pass
    finally:
        pool.close()
    return tuple(pool.ended)


@dataclass(eq=False)
class _Worker:
    process: Any
    pipe: Connection
    item: Item | None = None
    affinity: str = ""
    since: float = 0.0


@dataclass(eq=False)
class _Pool:
    waiting: list[Item]
    factory: Callable[[], Perform]
    limit: int
    watcher: Watcher
    ended: list[Ended] = field(default_factory=list)
    workers: list[_Worker] = field(default_factory=list)

    def step(self) -> bool:
        """Hand out what can be done and hear what is said; whether anything is left."""
        raise_if_stopped()
        self._give_up()
        self._hand_out()
        busy = [worker for worker in self.workers if worker.item is not None]
        if not busy:
            return False
        pipes = {worker.pipe: worker for worker in busy}
        for pipe in wait(list(pipes), timeout=1.0):
            self._hear(pipes[pipe])  # type: ignore[index]
        return True

    def _give_up(self) -> None:
        """End the jobs whose predecessors failed."""
        failed = {ended.key for ended in self.ended if ended.error is not None}
        for item in [item for item in self.waiting if failed.intersection(item.after)]:
            self.waiting.remove(item)
            first = sorted(failed.intersection(item.after))[0]
            self._end(Ended(item.key, f"not tried, because '{first}' failed", 0.0))
            self._give_up()
            return

    def _hand_out(self) -> None:
        well = {ended.key for ended in self.ended if ended.error is None}
        while ready := [item for item in self.waiting if well.issuperset(item.after)]:
            worker = self._idle()
            if worker is None:
                return
            at_hand = worker.affinity
            item = min(ready, key=lambda each: each.affinity != at_hand)
            try:
                worker.pipe.send(item.value)
            except OSError:
                # It died while it had nothing to do; the job goes to another one.
                self._dismiss(worker)
                continue
            self.waiting.remove(item)
            worker.item, worker.affinity, worker.since = item, item.affinity, time.perf_counter()
            self.watcher.started(item.key)

    def _idle(self) -> _Worker | None:
        for worker in self.workers:
            if worker.item is None:
                return worker
        if len(self.workers) >= self.limit:
            return None
        # Spawned, not forked: OpenGL, OpenMP and threads do not survive a fork.
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs, self.factory), daemon=True)
        process.start()
        theirs.close()
        self.workers.append(_Worker(process, ours))
        return self.workers[-1]

    def _hear(self, worker: _Worker) -> None:
        item = worker.item
        assert item is not None
        seconds = time.perf_counter() - worker.since
        try:
            kind, value = worker.pipe.recv()
        except (EOFError, OSError):
            self._dismiss(worker)
            self._end(Ended(item.key, _death(worker.process.exitcode), seconds))
            return
        if kind == "share":
            self.watcher.advanced(item.key, value)
            return
        worker.item = None
        self._end(Ended(item.key, value, seconds))

    def _end(self, ended: Ended) -> None:
        self.ended.append(ended)
        self.watcher.ended(ended)

    def _dismiss(self, worker: _Worker) -> None:
        self.workers.remove(worker)
        worker.pipe.close()
        worker.process.join(_PATIENCE_S)

    def close(self) -> None:
        """End every worker, at once if it is at work."""
        for worker in self.workers:
            if worker.item is not None:
                worker.process.terminate()
            worker.pipe.close()
        for worker in self.workers:
            worker.process.join(_PATIENCE_S)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()


def _death(code: int | None) -> str:
    """What is known of a process that ended in the middle of a job."""
    if code is not None and code < 0:
        name = signal.Signals(-code).name
        memory = " (out of memory?)" if -code == signal.SIGKILL else ""
        return f"its process was ended by {name}{memory}"
    return f"its process ended with status {code}"


def _serve(pipe: Connection, factory: Callable[[], Perform]) -> None:
    """The life of a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    # A worker's stdout is its parent's, which may be a JSON object being written.
    sys.stdout.flush()
    os.dup2(sys.__stderr__.fileno() if sys.__stderr__ else 2, 1)
    perform: Perform | None = None
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            value = pipe.recv()
            try:
                if perform is None:
                    perform = factory()
                perform(value, _Teller(pipe))
                error = None
            except (BrokenPipeError, ConnectionResetError):
                raise
            except Exception as caught:
                error = str(caught) or type(caught).__name__
            pipe.send(("ended", error))


def _leave(number: int, frame: FrameType | None) -> None:
    # An exception, not the default end: files half written are removed on the way out.
    raise SystemExit(128 + number)


class _Teller:
    """Sends the share done, but not more often than anybody reads."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._last = pipe, 0.0

    def __call__(self, share: float) -> None:
        now = time.perf_counter()
        if now - self._last >= WORD_S:
            self._last = now
            self._pipe.send(("share", share))
