"""`run_jobs`: all jobs of a command, on any executor, each one's end as it comes.

A job that fails stops no other, except those that come after it. A worker that dies, or the machine
it is on, loses its job alone, and the job is done again by another one, up to `ATTEMPTS` times.
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field
from functools import partial
from typing import Final, Protocol

from lcrl_bench.errors import ExitCode, LcrlError
from lcrl_bench.interruption import raise_if_stopped
from lcrl_bench.jobs.job import Answer, Job, Tell

ATTEMPTS: Final = 3
"""How often a job is tried whose worker dies."""
LOOK_S: Final = 0.5
"""Time between two looks at the executor, in seconds."""


class WorkerLostError(LcrlError):
    """The worker of a job died, by whatever cause."""


@dataclass(frozen=True)
class Ended:
    """How a job ended."""

    key: str
    """The job's name."""
    error: str | None
    """None if it succeeded."""
    seconds: float = 0.0
    """Wall time of its last attempt; 0 if it was found finished."""
    answer: Answer = field(default_factory=Answer)


class Watcher(Protocol):
    """Receives progress events."""

    def started(self, key: str) -> None:
        """A job was handed to a worker."""

    def advanced(self, key: str, share: float, note: str = "") -> None:
        """A fraction of a job is done, in [0, 1]; see `Tell`."""

    def ended(self, ended: Ended) -> None:
        """A job ended, successfully or not."""


class Executor(Protocol):
    """Where jobs are done. Nothing is started before the first job is submitted."""

    def has_room(self) -> bool:
        """Whether it takes another job now."""
        ...

    def submit(self, order: str, tell: Tell) -> Future[str]:
        """Take a job; the future is done when the job is, or when its worker died.

        Args:
            order: `Job.order(...)`.
            tell: Told how far it has got, where that can be known.
        """
        ...

    def look(self) -> None:
        """Take notice of what happened since."""
        ...

    def answer(self, future: Future[str]) -> str:
        """The answer of a job whose future is done.

        Raises:
            WorkerLostError: If its worker died.
        """
        ...

    def close(self) -> None:
        """End all workers, at once if they are busy."""
        ...


class Silent:
    """A watcher that does nothing."""

    def started(self, key: str) -> None:
        """A job was handed to a worker."""

    def advanced(self, key: str, share: float, note: str = "") -> None:
        """A fraction of a job is done, in [0, 1]; see `Tell`."""

    def ended(self, ended: Ended) -> None:
        """A job ended, successfully or not."""


def run_jobs(
    jobs: Sequence[Job],
    executor: Executor | None,
    watcher: Watcher | None = None,
    *,
    must_keep: bool = False,
) -> Iterator[Ended]:
    """Do jobs, in order as far as `after` allows; those with a kept value are not done again.

    Args:
        jobs: Every name in an `after` is one of them.
        executor: Where they are done; closed at the end. None does nothing: jobs without a kept
            value are reported as missing.
        watcher: Receives progress events, in this process.
        must_keep: Whether a job fails if its value can't be kept, as another command wants it.

    Yields:
        How each job ended, as soon as it has. Jobs after a failed one are not tried.
    """
    work = _Work(list(jobs), executor, watcher or Silent(), must_keep)
    try:
        yield from work.found()
        while work.waiting or work.running:
            yield from work.step()
    finally:
        if executor is not None:
            executor.close()


@dataclass
class _Attempt:
    """A job in the hands of a worker."""

    job: Job
    number: int
    since: float


@dataclass(eq=False)
class _Work:
    waiting: list[Job]
    executor: Executor | None
    watcher: Watcher
    must_keep: bool
    running: dict[Future[str], _Attempt] = field(default_factory=dict)
    done: set[str] = field(default_factory=set)
    failed: set[str] = field(default_factory=set)
    lost: dict[str, int] = field(default_factory=dict)
    command: str = field(default_factory=lambda: uuid.uuid4().hex)

    def found(self) -> Iterator[Ended]:
        """End the jobs whose values are there."""
        for job in tuple(self.waiting):
            raise_if_stopped()
            if (answer := job.finished()) is not None:
                self.waiting.remove(job)
                yield self._end(Ended(job.name, None, answer=answer))

    def step(self) -> Iterator[Ended]:
        """Hand out jobs, and end those that are done."""
        raise_if_stopped()
        yield from self._give_up()
        if self.executor is None:
            return
        self._hand_out(self.executor)
        wait(self.running, LOOK_S, FIRST_COMPLETED)
        self.executor.look()
        for future in [each for each in self.running if each.done()]:
            yield from self._finish(self.executor, future)

    def _give_up(self) -> Iterator[Ended]:
        """End the jobs whose predecessors failed; without an executor, all."""
        while hopeless := next((job for job in self.waiting if self._why_not(job)), None):
            self.waiting.remove(hopeless)
            yield self._fail(hopeless, Answer(error=self._why_not(hopeless), exit_code=1))

    def _why_not(self, job: Job) -> str:
        if self.executor is None:
            return "not done yet"
        first = min(self.failed.intersection(job.after), default=None)
        return "" if first is None else f"not tried, because '{first}' failed"

    def _hand_out(self, executor: Executor) -> None:
        while ready := [job for job in self.waiting if self.done.issuperset(job.after)]:
            if not executor.has_room():
                return
            job, since = ready[0], time.perf_counter()
            attempt = self.lost.get(job.name, 0) + 1
            if attempt == 1:
                self.watcher.started(job.name)
            order = job.order(command=self.command, attempt=attempt, must_keep=self.must_keep)
            tell = partial(self.watcher.advanced, job.name)
            self.running[executor.submit(order, tell)] = _Attempt(job, attempt, since)
            self.waiting.remove(job)

    def _finish(self, executor: Executor, future: Future[str]) -> Iterator[Ended]:
        attempt = self.running.pop(future)
        job, seconds = attempt.job, time.perf_counter() - attempt.since
        try:
            answer = Answer.read(executor.answer(future))
        except WorkerLostError as error:
            self.lost[job.name] = attempt.number
            if attempt.number < ATTEMPTS:
                self.waiting.insert(0, job)
                return
            reason = f"{error}, each of the {ATTEMPTS} times it was tried"
            answer = Answer(error=reason, exit_code=int(ExitCode.RED))
        if answer.error is not None:
            yield self._fail(job, answer, seconds)
        else:
            yield self._end(Ended(job.name, None, seconds, answer))

    def _fail(self, job: Job, answer: Answer, seconds: float = 0.0) -> Ended:
        self.failed.add(job.name)
        return self._end(Ended(job.name, answer.error, seconds, answer))

    def _end(self, ended: Ended) -> Ended:
        if ended.error is None:
            self.done.add(ended.key)
        self.watcher.ended(ended)
        return ended
