"""Jobs on a Ray cluster: each is a Ray task of one core, tried again elsewhere if its worker dies.

The nodes need the same environment and the same files under the same paths (a shared file system).
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from lcrl_bench.errors import EnvironmentMissingError, UsageError
from lcrl_bench.interruption import stops_postponed
from lcrl_bench.jobs.engine import WorkerLostError
from lcrl_bench.jobs.job import Tell
from lcrl_bench.jobs.performance import perform_elsewhere

if TYPE_CHECKING:
    # At run time it is imported when a cluster is named.
    from ray import ObjectRef

_PATIENCE_S: Final = 60.0
"""Longest time that cancelled jobs may take to end, in seconds."""


class RayExecutor:
    """An executor of Ray tasks."""

    def __init__(self, address: str | None, options: Mapping[str, Any], *, workers: int) -> None:
        """Check that Ray is there; the cluster is joined at the first job.

        Args:
            address: `"host:port"` or `"ray://host:port"`. None: the cluster of `RAY_ADDRESS`, else
                one that is started on this machine.
            options: What a job asks for beside one core: `{"num_gpus": 1}`.
            workers: Most jobs at the same time; 0 for as many as the cluster takes.

        Raises:
            EnvironmentMissingError: If Ray is not installed.
            UsageError: If Ray knows no such option.
        """
        self._ray = _import_ray()
        self._address, self._workers = address, workers
        self._running: dict[Future[str], ObjectRef] = {}
        self._joined = False
        # The engine counts attempts, so that the same law holds everywhere.
        asked = {"num_cpus": 1, **options, "max_retries": 0}
        try:
            self._task = self._ray.remote(**asked)(perform_elsewhere)
        except (TypeError, ValueError) as error:
            raise UsageError(f"--cluster-options: {error}") from error

    def has_room(self) -> bool:
        """Whether another task may be submitted; Ray itself keeps what has to wait."""
        return not self._workers or len(self._running) < self._workers

    def submit(self, order: str, tell: Tell) -> Future[str]:
        """Submit a task."""
        self._join()
        with stops_postponed():
            reference = self._task.remote(order)
            future = reference.future()
            self._running[future] = reference
        return future

    def look(self) -> None:
        """Ray tasks tell nothing before they end."""

    def answer(self, future: Future[str]) -> str:
        """The answer of a task that is done.

        Raises:
            WorkerLostError: If its worker or its node died.
        """
        self._running.pop(future)
        try:
            return future.result()
        except self._ray.exceptions.RayError as error:
            lines = str(error).strip().splitlines()
            raise WorkerLostError(lines[0] if lines else type(error).__name__) from error

    def close(self) -> None:
        """Cancel what is running, and leave the cluster."""
        if not self._joined:
            return
        ray = self._ray
        left = list(self._running.values())
        # First as Ctrl-C in the task, so that partial files are removed.
        for force in (False, True):
            for reference in left:
                with suppress(Exception):
                    ray.cancel(reference, force=force)
            if left and not force:
                with suppress(Exception):
                    _, left = ray.wait(left, num_returns=len(left), timeout=_PATIENCE_S)
        self._running.clear()
        self._joined = False
        ray.shutdown()

    def _join(self) -> None:
        if self._joined:
            return
        try:
            self._init()
        except ImportError as error:
            reason = f"Ray can't join {self._address}: {error}"
            raise EnvironmentMissingError(f'{reason}. Try: pip install "ray[client]"') from error
        except (ConnectionError, RuntimeError) as error:
            where = self._address or "this machine"
            raise EnvironmentMissingError(f"No Ray cluster at {where}: {error}") from error
        self._joined = True

    def _init(self) -> None:
        try:
            # Without a log to the driver, whose stdout is for the answer.
            self._ray.init(self._address, log_to_driver=False, include_dashboard=False)
        except ValueError:
            # A cluster that runs already has its dashboard or not, and refuses to be told.
            self._ray.init(self._address, log_to_driver=False)


def _import_ray() -> Any:  # noqa: ANN401 - the module
    try:
        import ray
        import ray.exceptions
    except ModuleNotFoundError as error:
        raise EnvironmentMissingError(
            "Ray is not installed here. Install it (the extra [ray]): pip install ray"
        ) from error
    return ray
