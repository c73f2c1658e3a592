"""`Setup`: the checked arguments of an environment, single or vector."""

from __future__ import annotations

import inspect
import logging
import os
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, Final, TypeVar

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.benchmarks.task_sets import task_named
from lcrl_bench.envs.arguments import (
    check_count,
    check_flag,
    check_name,
    check_task_id,
    check_task_ids,
)
from lcrl_bench.envs.observation import Observer, make_observer
from lcrl_bench.envs.reward_table import LearnedReward, RewardTable, TrueReward
from lcrl_bench.errors import NothingSelectedError, UnknownNameError, UsageError
from lcrl_bench.evaluation.finished_runs import read_reward
from lcrl_bench.forking import is_forked
from lcrl_bench.methods.contract import Reward
from lcrl_bench.scenes.panoramas.backends import BACKENDS

TRUE: Final = "true"
"""Selects the environment's own reward."""
METADATA: Final[Mapping[str, Any]] = {"render_modes": ["rgb_array", "ansi"], "render_fps": 4}
"""What Gymnasium is told of rendering."""
_logger = logging.getLogger(__name__)
_Name = TypeVar("_Name", bound=StrEnum)


@dataclass(frozen=True, kw_only=True, eq=False)
class Setup:
    """What an environment plays, what it shows and what it pays."""

    benchmark: Benchmark
    tasks: tuple[Task, ...]
    """The tasks drawn from."""
    reward: RewardTable
    terminate_at_goal: bool
    observer: Observer
    renderer: str
    houses_kept: int
    render_mode: str | None

    @classmethod
    def of(
        cls,
        *,
        benchmark: str | Path | Benchmark = "lcrl-v1",
        split: str | None = "train",
        kind: str | None = None,
        tasks: Sequence[str] | None = None,
        reward: str | Path | Reward = TRUE,
        terminate_at_goal: bool | None = None,
        observation: str = "panorama",
        one_hot: bool = False,
        text: bool = True,
        position: bool = False,
        renderer: str = "auto",
        houses_kept: int = 128,
        render_mode: str | None = None,
    ) -> Setup:
        """Check the arguments of `HouseEnvironment`, which documents them, and open the benchmark.

        Raises:
            UnknownNameError: If the benchmark, the split, the kind, the observation, the renderer
                or the render mode is unknown.
            UsageError: If an argument has the wrong type, a task is not in the benchmark, or the
                run learned a policy.
            NothingSelectedError: If no task has that split and kind.
            InvalidFileError: If the run directory has no run, or its model is damaged.
        """
        compute_alone_if_forked()
        if render_mode is not None:
            check_name("render_mode", render_mode, METADATA["render_modes"])
        check_name("renderer", renderer, BACKENDS)
        houses_kept = check_count("houses_kept", houses_kept)
        if terminate_at_goal is not None:
            check_flag("terminate_at_goal", terminate_at_goal)
        opened = _benchmark(benchmark)
        selection = _select(opened, split, kind, tasks)
        true = isinstance(reward, str) and reward == TRUE
        if terminate_at_goal and not true:
            _logger.warning("notice: episodes end at the true goal, which a learned reward hides")
        return cls(
            benchmark=opened,
            tasks=selection,
            reward=_reward_table(reward, opened),
            terminate_at_goal=true if terminate_at_goal is None else bool(terminate_at_goal),
            observer=make_observer(
                observation, opened, one_hot=one_hot, text=text, position=position
            ),
            renderer=renderer,
            houses_kept=houses_kept,
            render_mode=render_mode,
        )

    @classmethod
    def of_any(cls, arguments: Mapping[str, Any], *, own: Sequence[str]) -> Setup:
        """The same for arguments by name.

        Args:
            arguments: Those of `of`.
            own: Names of arguments that are valid too, but the caller's business.

        Raises:
            UnknownNameError: If there is no such argument, and whenever `of` does.
        """
        valid = inspect.signature(cls.of).parameters
        for name in arguments:
            if name not in valid:
                raise UnknownNameError("argument", name, (*valid, *own))
        return cls.of(**arguments)


def check_options(options: object, *, valid: Sequence[str]) -> Mapping[str, Any]:
    """Check the options of a reset; None means none.

    Raises:
        UsageError: If they are not a dictionary, or an option is unknown.
    """
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise UsageError(
            f"options is {reprlib.repr(options)}. Valid: a dictionary, "
            'such as {"task": "<id of a task>"}.'
        )
    unknown = [key for key in options if key not in valid]
    if unknown:
        raise UsageError(f"Unknown option '{unknown[0]}' of reset. Valid: {', '.join(valid)}.")
    return options


def task_asked_for(benchmark: Benchmark, name: object, *, where: str) -> Task | None:
    """The task named in the options of a reset; None if none is.

    Args:
        benchmark: The benchmark.
        name: The id of a task, or None.
        where: Which option it is, for the error.

    Raises:
        UsageError: If it is no string, or the id of no task.
    """
    return None if name is None else task_named(benchmark, check_task_id(where, name))


def facts_of(task: Task) -> dict[str, Any]:
    """What `info` says of an episode beside `success`; the same at every step."""
    return {
        "task": task.id,
        "split": task.split.value,
        "kind": task.kind.value,
        "optimal_length": task.proof.optimal_length,
        "optimal_value": task.proof.value,
    }


def compute_alone_if_forked() -> None:
    """Keep torch on one thread in a forked process, where its parent's pool of threads hangs."""
    if is_forked() and torch.get_num_threads() > 1:
        torch.set_num_threads(1)


def _select(
    benchmark: Benchmark, split: str | None, kind: str | None, tasks: Sequence[str] | None
) -> tuple[Task, ...]:
    if tasks is not None:
        ids = check_task_ids("tasks", tasks)
        chosen = tuple(task_named(benchmark, name) for name in ids)
    else:
        chosen = benchmark.select(
            split=_member(Split, "split", split), kind=_member(Kind, "kind", kind)
        )
    if not chosen:
        what = "tasks=()" if tasks is not None else f"split={split!r}, kind={kind!r}"
        raise NothingSelectedError(f"{benchmark.name} has no task of {what}.")
    return tuple(chosen)


def _benchmark(benchmark: object) -> Benchmark:
    if isinstance(benchmark, Benchmark):
        return benchmark
    if not isinstance(benchmark, (str, os.PathLike)):
        raise UsageError(
            f"benchmark is {reprlib.repr(benchmark)}. Valid: a name, a folder, or a Benchmark."
        )
    return read_benchmark(benchmark_folder(str(benchmark)))


def _reward_table(reward: object, benchmark: Benchmark) -> RewardTable:
    if isinstance(reward, Reward):
        return LearnedReward(reward)
    if not isinstance(reward, (str, os.PathLike)):
        raise UsageError(
            f"reward is {reprlib.repr(reward)}. Valid: '{TRUE}', the folder of a run, or a Reward "
            "(lcrl_bench.methods.contract)."
        )
    if reward == TRUE:
        return TrueReward(benchmark.semantics.success_reward)
    return LearnedReward(read_reward(Path(reward)))


def _member(names: type[_Name], argument: str, name: str | None) -> _Name | None:
    if name is None:
        return None
    return names(check_name(argument, name, [each.value for each in names]))
