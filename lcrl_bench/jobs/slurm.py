"""Jobs through submitit: each is a job of Slurm's own queue.

Submitit's files (submissions, logs) are in `slurm/` of the cache, which the nodes must see.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, Final

from lcrl_bench.errors import EnvironmentMissingError, UsageError
from lcrl_bench.interruption import stops_postponed
from lcrl_bench.jobs.engine import WorkerLostError
from lcrl_bench.jobs.job import Tell
from lcrl_bench.jobs.performance import perform_elsewhere
from lcrl_bench.storage import cache_dir

_DEFAULTS: Final = {"name": "lcrl-bench", "cpus_per_task": 1, "timeout_min": 24 * 60}
"""What a job asks for if nothing else is said."""
_PATIENCE_S: Final = 60.0
"""Longest time that cancelled jobs may take to end, in seconds."""


class SlurmExecutor:
    """An executor of submitit jobs."""

    def __init__(self, options: Mapping[str, Any], *, workers: int, cluster: str = "slurm") -> None:
        """Check that submitit and the queue are there.

        Args:
            options: What a job asks for, as `submitit.AutoExecutor` calls it:
                `{"timeout_min": 240, "slurm_partition": "cpu"}`.
            workers: Most jobs in the queue at the same time; 0 for all.
            cluster: `"slurm"`, or `"local"` for processes of this machine.

        Raises:
            EnvironmentMissingError: If submitit or Slurm is not installed.
            UsageError: If submitit knows no such option.
        """
        submitit = _import_submitit()
        self._lost = (submitit.core.utils.UncompletedJobError, submitit.core.utils.FailedJobError)
        self._workers = workers
        self._running: dict[Future[str], Any] = {}
        try:
            self._queue = submitit.AutoExecutor(cache_dir().resolve() / "slurm", cluster=cluster)
            self._queue.update_parameters(**{**_DEFAULTS, **options})
        except (NameError, TypeError, ValueError) as error:
            raise UsageError(f"--cluster-options: {error}") from error
        except RuntimeError as error:
            raise EnvironmentMissingError(f"--cluster {cluster}: {error}") from error

    def has_room(self) -> bool:
        """Whether another job may be queued."""
        return not self._workers or len(self._running) < self._workers

    def submit(self, order: str, tell: Tell) -> Future[str]:
        """Queue a job."""
        future: Future[str] = Future()
        with stops_postponed():
            self._running[future] = self._queue.submit(perform_elsewhere, order)
        return future

    def look(self) -> None:
        """Ask the queue which jobs have ended; they tell nothing before."""
        for future, job in self._running.items():
            if not future.done() and job.done():
                future.set_result("")

    def answer(self, future: Future[str]) -> str:
        """The answer of a job that has ended.

        Raises:
            WorkerLostError: If it ended without one.
        """
        job = self._running.pop(future)
        try:
            return str(job.result())
        except self._lost as error:
            raise WorkerLostError(f"job {job.job_id} of the queue ended as {job.state}") from error

    def close(self) -> None:
        """Cancel what is queued or running, and wait for it to end."""
        jobs = list(self._running.values())
        for job in jobs:
            with suppress(Exception):
                job.cancel()
        until = time.monotonic() + _PATIENCE_S
        while time.monotonic() < until and not all(job.done(force_check=True) for job in jobs):
            time.sleep(0.1)
        self._running.clear()


def _import_submitit() -> Any:  # noqa: ANN401 - the module
    try:
        import submitit
    except ModuleNotFoundError as error:
        raise EnvironmentMissingError(
            "submitit is not installed here. Install it (the extra [slurm]): pip install submitit"
        ) from error
    return submitit
