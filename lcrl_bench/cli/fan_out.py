"""The flags that spread a verb's jobs over processes, machines or a batch queue, and their work."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from lcrl_bench.cli.output import say, suggest
from lcrl_bench.cli.progress import JobBar, counting
from lcrl_bench.errors import ExitCode
from lcrl_bench.jobs.clusters import LOCAL, cluster_executor
from lcrl_bench.jobs.engine import Ended, Executor, run_jobs
from lcrl_bench.jobs.processes import InThisProcess, Processes
from lcrl_bench.jobs.shard import COLLECT, Shard

if TYPE_CHECKING:
    from lcrl_bench.jobs.job import Job


HOUSES_PER_WORKER = 4
"""Houses that are worth a process, which takes seconds to start."""


@dataclass(frozen=True)
class FanOut:
    """Where jobs are done. None of these flags changes a result."""

    cluster: str = LOCAL
    """local: processes of this machine; ray, or the address of a Ray cluster (host:port or
    ray://host:port); slurm."""
    workers: Annotated[int, tyro.conf.arg(aliases=("--jobs",))] = 0
    """Jobs at the same time, each in a process and with one thread; 0: one per core, and on a
    cluster as many as it takes."""
    shard: str = ""
    """Do only part i of n, as in 0/4; or `collect`: do nothing, and read what all parts did."""
    cluster_options: tuple[str, ...] = ()
    """What a job asks the cluster for, key=value: `num_gpus=1` (Ray) or `timeout_min=240
    slurm_partition=cpu` (Slurm)."""

    @property
    def part(self) -> Shard | None:
        """The part to do; None for all."""
        return Shard.parse(self.shard) if self.shard not in ("", COLLECT) else None

    @property
    def only_read(self) -> bool:
        """Whether to do nothing, and read what is finished."""
        return self.shard == COLLECT


@dataclass(frozen=True)
class Done:
    """What came of the jobs of a verb."""

    ended: tuple[Ended, ...]
    """In the order of the jobs."""
    part: Shard | None
    """The part that this was; None for all."""

    @property
    def failed(self) -> dict[str, str]:
        """Job -> error."""
        return {each.key: each.error for each in self.ended if each.error is not None}

    def values(self) -> dict[str, Any]:
        """Job -> value, of the jobs that succeeded."""
        return {each.key: each.answer.value for each in self.ended if each.error is None}


def do_jobs(jobs: Sequence[Job], flags: FanOut, *, label: str = "", share: int = 0) -> Done:
    """Do the jobs of a verb as its flags say.

    Args:
        jobs: All jobs of the verb.
        flags: Where, and which.
        label: What a job stands for (`"houses"`): they are counted. Empty: each one's start and
            end is shown.
        share: Jobs that are worth starting a process for, if `--workers` is not given; with one
            worker they are done in this process. 0: each worker is a process of its own.
    """
    part = flags.part
    chosen = list(jobs) if part is None else part.of(jobs)
    executor = None if flags.only_read else executor_of(flags, len(chosen), share=share)
    if label:
        with counting(label, len(chosen)) as advance:
            counter = Counter(advance)
            ended = tuple(run_jobs(chosen, executor, counter, must_keep=part is not None))
    else:
        with JobBar(len(chosen)) as bar:
            ended = tuple(run_jobs(chosen, executor, bar, must_keep=part is not None))
    order = {job.name: number for number, job in enumerate(jobs)}
    return Done(tuple(sorted(ended, key=lambda each: order[each.key])), part)


def executor_of(flags: FanOut, jobs: int, *, share: int = 0) -> Executor:
    """The executor that the flags name; nothing is started yet.

    Args:
        flags: Where jobs are done.
        jobs: How many there are.
        share: As in `do_jobs`.

    Raises:
        UsageError: If there is no such cluster or option.
        EnvironmentMissingError: If the package of the cluster is not installed.
    """
    if flags.cluster != LOCAL:
        return cluster_executor(flags.cluster, flags.cluster_options, workers=flags.workers)
    worth = jobs // share if share and not flags.workers else jobs
    workers = max(1, min(flags.workers or len(os.sched_getaffinity(0)), worth))
    return InThisProcess() if share and workers == 1 else Processes(workers)


class Counter:
    """A watcher that counts the jobs that ended."""

    def __init__(self, advance: Callable[[str], None]) -> None:
        """Count with `advance`, which is called with each job's name."""
        self._advance = advance

    def started(self, key: str) -> None:
        """A job was handed to a worker."""

    def advanced(self, key: str, share: float, note: str = "") -> None:
        """A fraction of a job is done, in [0, 1]."""

    def ended(self, ended: Ended) -> None:
        """A job ended."""
        self._advance(ended.key)


def ended_early(done: Done, command: Sequence[str]) -> int | None:
    """Say why a command can't go on from its jobs: they were one part of all, or some failed.

    Returns:
        The exit code, or None if every job is done.
    """
    if done.part is not None:
        return say_part(done, command)
    if done.failed:
        say_failed(done)
        return exit_code_of(done)
    return None


def say_part(done: Done, command: Sequence[str]) -> int:
    """Say what a shard has done, and how its work is collected; returns the exit code."""
    assert done.part is not None
    good = len(done.ended) - len(done.failed)
    say(f"part {done.part.index} of {done.part.count}: {good} of {len(done.ended)} jobs are done")
    say_failed(done)
    suggest([*_without_shard(command), "--shard", COLLECT], "once all parts are done")
    return ExitCode.RED if done.failed else ExitCode.DONE


def say_failed(done: Done) -> None:
    """Say each job that failed, and why."""
    for key, reason in done.failed.items():
        say(f"failed: {key}: {reason}", style="bold red")


def say_missing(keys: Sequence[str]) -> int:
    """Say which jobs no shard has done yet; returns the exit code."""
    for key in keys:
        say(f"failed: {key}: not done yet", style="bold red")
    return ExitCode.RED


def exit_code_of(done: Done) -> int:
    """The exit code of the first job that failed."""
    codes = [each.answer.exit_code for each in done.ended if each.error is not None]
    return codes[0] if codes else ExitCode.DONE


def command_of(*words: str) -> list[str]:
    """The words of a command of `lcrl-bench`, to repeat it."""
    return ["lcrl-bench", *words]


def _without_shard(argv: Sequence[str]) -> list[str]:
    words = list(argv)
    for number, word in enumerate(words):
        if word == "--shard":
            return words[:number] + words[number + 2 :]
        if word.startswith("--shard="):
            return words[:number] + words[number + 1 :]
    return words
