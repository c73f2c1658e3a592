"""Jobs on processes of this machine, or in this very process.

Each worker is a `ProcessPoolExecutor` of one process, so that a dying process loses only its own
job. Workers ignore Ctrl-C, which the parent turns into an orderly shutdown, and exit when the
parent is gone.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any, Final

from lcrl_bench.interruption import stops_postponed
from lcrl_bench.jobs.engine import LOOK_S, WorkerLostError
from lcrl_bench.jobs.job import Tell, untold
from lcrl_bench.jobs.performance import perform

_PATIENCE_S: Final = 60.0
"""Longest time that a worker may take to exit when told to, in seconds."""
_TERMINATED: Final = 128 + signal.SIGTERM


class Processes:
    """An executor of spawned processes on this machine."""

    def __init__(self, workers: int) -> None:
        """Start nothing yet.

        Args:
            workers: Maximum number of processes.
        """
        self._limit = workers
        self._workers: list[_Worker] = []

    def has_room(self) -> bool:
        """Whether a worker is idle, or may be started."""
        return len(self._workers) < self._limit or any(not each.busy for each in self._workers)

    def submit(self, order: str, tell: Tell) -> Future[str]:
        """Hand a job to an idle worker, or to a new one."""
        while True:
            worker = next((each for each in self._workers if not each.busy), None)
            if worker is None:
                worker = _Worker()
                self._workers.append(worker)
            try:
                return worker.take(order, tell)
            except BrokenProcessPool:  # It died while idle: another one takes the job.
                self._workers.remove(worker)

    def look(self) -> None:
        """Pass on what workers have told."""
        for worker in self._workers:
            while worker.busy and worker.reports.poll():
                try:
                    told = worker.reports.recv()
                except (EOFError, OSError):  # It died.
                    break
                worker.tell(*told)

    def answer(self, future: Future[str]) -> str:
        """The answer of a job that is done.

        Raises:
            WorkerLostError: If its process died.
        """
        worker = next(each for each in self._workers if each.job is future)
        worker.job = None
        failure = future.exception()
        if failure is None:
            return future.result()
        if isinstance(failure, BrokenProcessPool):
            self._workers.remove(worker)
        raise WorkerLostError(worker.cause_of(failure)) from failure

    def close(self) -> None:
        """Stop all workers, at once if they are busy."""
        for worker in self._workers:
            if worker.busy:
                worker.process.terminate()
            worker.pool.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            if worker.process is not None:
                worker.process.join(_PATIENCE_S)
                if worker.process.is_alive():
                    worker.process.kill()
            worker.pool.shutdown()
        self._workers.clear()


class InThisProcess:
    """An executor that does each job at once, here: for one job, or one at a time."""

    def has_room(self) -> bool:
        """It always has."""
        return True

    def submit(self, order: str, tell: Tell) -> Future[str]:
        """Do the job."""
        future: Future[str] = Future()
        future.set_result(perform(order, tell))
        return future

    def look(self) -> None:
        """Nothing happens between jobs."""

    def answer(self, future: Future[str]) -> str:
        """The answer of a job."""
        return future.result()

    def close(self) -> None:
        """There is nothing to end."""


class _Worker:
    """A process and its current job."""

    def __init__(self) -> None:
        # Spawned, not forked: OpenGL, OpenMP and threads do not survive a fork.
        context = multiprocessing.get_context("spawn")
        self.reports, theirs = context.Pipe(duplex=False)
        self.pool = ProcessPoolExecutor(1, context, _begin, (theirs,))
        self.process: Any = None
        self.job: Future[str] | None = None
        self.tell: Tell = untold

    @property
    def busy(self) -> bool:
        return self.job is not None

    def take(self, order: str, tell: Tell) -> Future[str]:
        """Start a job; raises BrokenProcessPool if the process died while idle."""
        self.tell = tell
        with stops_postponed():
            before = multiprocessing.active_children()
            self.job = self.pool.submit(_perform, order)
            if self.process is None:
                (self.process,) = set(multiprocessing.active_children()).difference(before)
        return self.job

    def cause_of(self, failure: BaseException) -> str:
        """Why the process died, in words."""
        if isinstance(failure, SystemExit):
            return f"its process ended with status {failure.code}"
        self.pool.shutdown()
        code = self.process.exitcode
        if code is None or code >= 0:
            return f"its process ended with status {code}"
        memory = " (out of memory?)" if code == -signal.SIGKILL else ""
        return f"its process was ended by {signal.Signals(-code).name}{memory}"


class _Desk:
    """A worker process's state between jobs."""

    def __init__(self, reports: Connection) -> None:
        self._reports = reports
        self._reported = 0.0
        self._idle = threading.Event()
        self._idle.set()
        threading.Thread(target=self._leave_with_parent, daemon=True).start()

    def perform(self, order: str) -> str:
        """Do a job; returns the answer as text, as exceptions may not unpickle."""
        self._idle.clear()
        try:
            return perform(order, self._report)
        finally:
            self._idle.set()

    def _report(self, share: float, note: str = "") -> None:
        """Send how far the job has got, but no more often than it is read."""
        now = time.perf_counter()
        if now - self._reported >= LOOK_S:
            self._reported = now
            self._reports.send((share, note))

    def _leave_with_parent(self) -> None:
        """Exit when the parent is gone, which an idle worker would not notice otherwise."""
        parent = multiprocessing.parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        self._idle.wait(_PATIENCE_S)
        os._exit(_TERMINATED)


_desks: Final[list[_Desk]] = []
"""The state of a worker process; empty elsewhere."""


def _begin(reports: Connection) -> None:
    """Set a worker process up."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    # Workers share stdout with the parent, which may be writing a JSON object.
    sys.stdout.flush()
    os.dup2(sys.__stderr__.fileno() if sys.__stderr__ else 2, 1)
    _desks.append(_Desk(reports))


def _perform(order: str) -> str:
    return _desks[0].perform(order)


def _leave(number: int, frame: FrameType | None) -> None:
    # An exception rather than immediate exit, so that partial files are removed.
    raise SystemExit(128 + number)
