"""Persistent worker processes: each is set up once and does job after job.

Each worker is a `ProcessPoolExecutor` of one process, so that a dying process loses only its own
job, and jobs that need the same data run one after another in one process. Workers ignore Ctrl-C,
which the parent turns into an orderly shutdown, and exit when the parent is gone.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any, Final, Protocol

from lcrl_bench.interruption import raise_if_stopped, stops_postponed

Perform = Callable[[Any, Callable[[float], None]], None]
"""Does a job; calls its second argument now and then with the fraction done, in [0, 1]."""

WORD_S: Final = 0.5
"""Minimum time between two progress reports of a worker, in seconds."""
_PATIENCE_S: Final = 60.0
"""Maximum time for a worker to exit when told to, in seconds."""


@dataclass(frozen=True)
class Item:
    """A job as the pool sees it."""

    key: str
    """Unique name of the job."""
    value: Any
    """Argument of the job; pickled."""
    after: Collection[str] = ()
    """Keys of jobs that must succeed first."""
    affinity: str = ""
    """Kind of job; workers prefer the kind they did last."""


@dataclass(frozen=True)
class Ended:
    """How a job ended."""

    key: str
    error: str | None
    """None if it succeeded."""
    seconds: float


class Watcher(Protocol):
    """Receives progress events."""

    def started(self, key: str) -> None:
        """A worker took a job."""

    def advanced(self, key: str, share: float) -> None:
        """A fraction of a job is done, in [0, 1]."""

    def ended(self, ended: Ended) -> None:
        """A job ended, successfully or not."""


def work_through(
    items: Sequence[Item], factory: Callable[[], Perform], *, workers: int, watcher: Watcher
) -> tuple[Ended, ...]:
    """Do all jobs in several processes, in order as far as `after` allows.

    Args:
        items: The jobs; every key in an `after` is one of them.
        factory: Called once per worker, at its first job; returns what does the jobs. Pickled.
        workers: Maximum number of processes.
        watcher: Receives progress events, in this process.

    Returns:
        How each job ended, in the order they ended. Jobs after a failed one are not tried.
    """
    crew = _Crew(list(items), factory, workers, watcher)
    try:
        while crew.step():
            pass
    finally:
        crew.close()
    return tuple(crew.ended)


class _Worker:
    """A process and its current job."""

    def __init__(self, factory: Callable[[], Perform]) -> None:
        # Spawned, not forked: OpenGL, OpenMP and threads do not survive a fork.
        context = multiprocessing.get_context("spawn")
        self.reports, theirs = context.Pipe(duplex=False)
        self.pool = ProcessPoolExecutor(1, context, _begin, (factory, theirs))
        self.process: Any = None
        self.item: Item | None = None
        self.affinity = ""

    def take(self, item: Item) -> None:
        """Start a job; raises BrokenProcessPool if the process died while idle."""
        with stops_postponed():
            before = multiprocessing.active_children()
            self.job: Future[str | None] = self.pool.submit(_perform, item.value)
            if self.process is None:
                (self.process,) = set(multiprocessing.active_children()).difference(before)
            self.item, self.affinity, self.since = item, item.affinity, time.perf_counter()

    def error(self) -> str | None:
        """The error of the finished job, or None."""
        failure = self.job.exception()
        if failure is None:
            return self.job.result()
        if isinstance(failure, SystemExit):
            return f"its process ended with status {failure.code}"
        if not isinstance(failure, BrokenProcessPool):
            return str(failure) or type(failure).__name__
        self.pool.shutdown()
        code = self.process.exitcode
        if code is None or code >= 0:
            return f"its process ended with status {code}"
        memory = " (out of memory?)" if code == -signal.SIGKILL else ""
        return f"its process was ended by {signal.Signals(-code).name}{memory}"


@dataclass(eq=False)
class _Crew:
    waiting: list[Item]
    factory: Callable[[], Perform]
    limit: int
    watcher: Watcher
    ended: list[Ended] = field(default_factory=list)
    workers: list[_Worker] = field(default_factory=list)

    def step(self) -> bool:
        """Hand out jobs and process events; return whether anything is left."""
        raise_if_stopped()
        self._give_up()
        self._hand_out()
        busy = [worker for worker in self.workers if worker.item is not None]
        done, _ = wait([worker.job for worker in busy], WORD_S, FIRST_COMPLETED)
        for worker in busy:
            assert worker.item is not None
            while worker.reports.poll():
                self.watcher.advanced(worker.item.key, worker.reports.recv())
            if worker.job in done:
                self._finish(worker, worker.item)
        return bool(busy)

    def _give_up(self) -> None:
        """End the jobs whose predecessors failed."""
        failed = {ended.key for ended in self.ended if ended.error is not None}
        while hopeless := next((i for i in self.waiting if failed.intersection(i.after)), None):
            self.waiting.remove(hopeless)
            first = min(failed.intersection(hopeless.after))
            failed.add(hopeless.key)
            self._end(Ended(hopeless.key, f"not tried, because '{first}' failed", 0.0))

    def _hand_out(self) -> None:
        done = {ended.key for ended in self.ended}
        while ready := [item for item in self.waiting if done.issuperset(item.after)]:
            worker = self._idle()
            if worker is None:
                return
            at_hand = worker.affinity
            item = min(ready, key=lambda each: each.affinity != at_hand)
            try:
                worker.take(item)
            except BrokenProcessPool:  # It died while idle: another one takes the job.
                self.workers.remove(worker)
                continue
            self.waiting.remove(item)
            self.watcher.started(item.key)

    def _idle(self) -> _Worker | None:
        idle = next((worker for worker in self.workers if worker.item is None), None)
        if idle is None and len(self.workers) < self.limit:
            idle = _Worker(self.factory)
            self.workers.append(idle)
        return idle

    def _finish(self, worker: _Worker, item: Item) -> None:
        seconds, error = time.perf_counter() - worker.since, worker.error()
        worker.item = None
        if isinstance(worker.job.exception(), BrokenProcessPool):
            self.workers.remove(worker)
        self._end(Ended(item.key, error, seconds))

    def _end(self, ended: Ended) -> None:
        self.ended.append(ended)
        self.watcher.ended(ended)

    def close(self) -> None:
        """Stop all workers, at once if they are busy."""
        for worker in self.workers:
            if worker.item is not None:
                worker.process.terminate()
            worker.pool.shutdown(wait=False, cancel_futures=True)
        for worker in self.workers:
            if worker.process is not None:
                worker.process.join(_PATIENCE_S)
                if worker.process.is_alive():
                    worker.process.kill()
            worker.pool.shutdown()


class _Desk:
    """A worker process's state between jobs."""

    def __init__(self, factory: Callable[[], Perform], reports: Connection) -> None:
        self._factory, self._reports = factory, reports
        self._perform: Perform | None = None
        self._idle = threading.Event()
        self._idle.set()
        threading.Thread(target=self._leave_with_parent, daemon=True).start()

    def perform(self, value: Any) -> str | None:  # noqa: ANN401 - whatever a job is
        """Do a job; return the error as text, as exceptions may not unpickle."""
        self._idle.clear()
        self._reported = 0.0
        try:
            if self._perform is None:
                self._perform = self._factory()
            self._perform(value, self._report)
        except Exception as error:
            return str(error) or type(error).__name__
        finally:
            self._idle.set()
        return None

    def _report(self, share: float) -> None:
        """Send the fraction done, but no more often than it is read."""
        now = time.perf_counter()
        if now - self._reported >= WORD_S:
            self._reported = now
            self._reports.send(share)

    def _leave_with_parent(self) -> None:
        """Exit when the parent is gone, which an idle worker would not notice otherwise."""
        parent = multiprocessing.parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        self._idle.wait(_PATIENCE_S)
        os._exit(128 + signal.SIGTERM)


_desks: Final[list[_Desk]] = []
"""The state of a worker process; empty elsewhere."""


def _begin(factory: Callable[[], Perform], reports: Connection) -> None:
    """Set a worker process up."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    # Workers share stdout with the parent, which may be writing a JSON object.
    sys.stdout.flush()
    os.dup2(sys.__stderr__.fileno() if sys.__stderr__ else 2, 1)
    _desks.append(_Desk(factory, reports))


def _perform(value: Any) -> str | None:  # noqa: ANN401 - whatever a job is
    return _desks[0].perform(value)


def _leave(number: int, frame: FrameType | None) -> None:
    # An exception rather than immediate exit, so that partial files are removed.
    raise SystemExit(128 + number)
