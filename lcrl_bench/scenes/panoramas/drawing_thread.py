"""A dedicated thread for an OpenGL context, which works only in the thread that opened it."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from concurrent.futures import Future
from queue import SimpleQueue
from typing import Any, TypeVar

from lcrl_bench.errors import UsageError

_Result = TypeVar("_Result")
_Job = tuple["Future[Any]", Callable[..., Any], tuple[Any, ...]]


class DrawingThread:
    """Runs functions one at a time in one thread, whichever thread calls.

    It is a daemon, so that `atexit`, which runs after all other threads have ended but before
    daemons do, can close what is still open.
    """

    def __init__(self) -> None:
        """Start the thread."""
        self._process = os.getpid()
        self._jobs: SimpleQueue[_Job | None] = SimpleQueue()
        self._thread = threading.Thread(
            target=_work, args=(self._jobs,), name="lcrl-drawing", daemon=True
        )
        self._thread.start()

    @property
    def is_here(self) -> bool:
        """Whether the thread exists in this process: forked children don't inherit it."""
        return os.getpid() == self._process

    def run(self, function: Callable[..., _Result], *arguments: Any) -> _Result:  # noqa: ANN401
        """Call `function` in the thread, and wait for its result or exception.

        Raises:
            UsageError: If this process was forked from the one that started the thread.
        """
        if not self.is_here:
            raise UsageError(
                "An OpenGL renderer can't be used in a forked process. Open one in each process, "
                'start processes with context="spawn", or use --renderer rays.'
            )
        # The garbage collector may close another renderer, or this one, from inside the thread.
        if threading.current_thread() is self._thread:
            return function(*arguments)
        future: Future[_Result] = Future()
        self._jobs.put((future, function, arguments))
        return future.result()

    def stop(self) -> None:
        """End the thread once all earlier calls are done."""
        if self.is_here:
            self._jobs.put(None)


def _work(jobs: SimpleQueue[_Job | None]) -> None:
    while (job := jobs.get()) is not None:
        future, function, arguments = job
        try:
            future.set_result(function(*arguments))
        except BaseException as error:
            future.set_exception(error)
        # Waiting for the next job must not keep the last one's objects alive.
        del job, future, function, arguments
