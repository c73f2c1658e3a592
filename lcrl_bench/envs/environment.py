"""`HouseEnvironment`: the tasks of a benchmark as a Gymnasium environment.

It steps through the same tables as the exact solvers, so results are exactly comparable with the
optimum; an agent gets only observations and rewards. The reward of a step is that of the state it
leads to, r(s'): the start's reward, the same for every policy, is left out.
"""

from __future__ import annotations

import logging
import os
import reprlib
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any, ClassVar, Final, SupportsFloat, SupportsIndex, TypeVar

import gymnasium
import torch
from gymnasium.envs.registration import EnvSpec

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import TaskSets, task_named
from lcrl_bench.envs.arguments import (
    check_count,
    check_flag,
    check_name,
    check_seed,
    check_task_id,
    check_task_ids,
    whole_number,
)
from lcrl_bench.envs.frame import FramePainter
from lcrl_bench.envs.observation import make_observer
from lcrl_bench.envs.reward_table import LearnedReward, RewardTable, TrueReward
from lcrl_bench.envs.spec import HouseSpec
from lcrl_bench.envs.text_map import text_map
from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.evaluation.finished_runs import read_reward
from lcrl_bench.forking import is_forked
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.methods.contract import Reward
from lcrl_bench.scenes.panoramas.backends import BACKENDS
from lcrl_bench.semantics import DEFAULT_SEMANTICS

TRUE: Final = "true"
"""Selects the environment's own reward."""
_logger = logging.getLogger(__name__)
_Name = TypeVar("_Name", bound=StrEnum)


class HouseEnvironment(gymnasium.Env[Any, Any]):
    """One task per episode, in one or many houses; at most `horizon` steps, four actions.

    An episode ends (`truncated`) after the benchmark's horizon of 30 steps and, with
    `terminate_at_goal`, at success (`terminated`).
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array", "ansi"], "render_fps": 4}

    def __init__(
        self,
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
    ) -> None:
        """Open a benchmark; a house is loaded when one of its tasks is first played.

        Args:
            benchmark: A shipped benchmark's name, a folder, or a shared `Benchmark`.
            split: `"train"`, `"test-task"` or `"test-house"`; None means all.
            kind: `"nav"` or `"pick"`; None means both.
            tasks: Ids of the tasks to play; overrides `split` and `kind`.
            reward: `"true"`; a run directory, `runs/<benchmark>/<method>/seed<k>`, for its learned
                reward (its method's code is imported); or a learned reward itself.
            terminate_at_goal: Whether success ends the episode. None means yes with the true reward
                and no with a learned one, as ending an episode at the goal would reveal where the
                goal is.
            observation: `"panorama"` (a dictionary), `"tabular"` (a vector) or `"state"` (an
                integer); see `lcrl_bench.envs.observation`.
            one_hot: Whether the panorama in the dictionary is one-hot.
            text: Whether the dictionary includes the command as text, which Stable-Baselines3 does
                not support.
            position: Whether the dictionary includes the agent's tile.
            renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not cached.
            houses_kept: Number of houses kept in memory; one takes about a megabyte.
            render_mode: `"rgb_array"`, `"ansi"` or None.

        Raises:
            UnknownNameError: If the benchmark, the split, the kind, the observation, the renderer
                or the render mode is unknown.
            UsageError: If an argument has the wrong type, a task is not in the benchmark, or the
                run learned a policy.
            NothingSelectedError: If no task has that split and kind.
            InvalidFileError: If the run directory has no run, or its model is damaged.
        """
        _compute_alone_if_forked()
        if render_mode is not None:
            check_name("render_mode", render_mode, self.metadata["render_modes"])
        check_name("renderer", renderer, BACKENDS)
        houses_kept = check_count("houses_kept", houses_kept)
        if terminate_at_goal is not None:
            check_flag("terminate_at_goal", terminate_at_goal)
        self.render_mode = render_mode
        self.benchmark = _benchmark(benchmark)
        self.tasks = self._select(split, kind, tasks)
        true = isinstance(reward, str) and reward == TRUE
        self.terminate_at_goal = true if terminate_at_goal is None else bool(terminate_at_goal)
        if terminate_at_goal and not true:
            _logger.warning("notice: episodes end at the true goal, which a learned reward hides")
        self._reward = _reward_table(reward, self.benchmark)
        self._observer = make_observer(
            observation, self.benchmark, one_hot=one_hot, text=text, position=position
        )
        self.observation_space = self._observer.space
        self.action_space = gymnasium.spaces.Discrete(ACTIONS)
        self._sets = TaskSets(self.benchmark, renderer=renderer, houses_kept=houses_kept)
        self._played: TaskSet | None = None
        self._states: list[int] = []
        self._over = False
        self._painter: FramePainter | None = None
        self._spec: EnvSpec | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode of a task drawn uniformly; the same seed gives the same episodes.

        Args:
            seed: Seed of the draws, from 0; None continues the current sequence.
            options: `{"task": id}` plays that task of the benchmark instead of drawing one.

        Raises:
            UsageError: If the seed or an option is invalid, or the task unknown.
        """
        _compute_alone_if_forked()
        chosen = self._asked_for(options)
        super().reset(seed=check_seed(seed))
        task = chosen or self.tasks[int(self.np_random.integers(len(self.tasks)))]
        tasks, row = self._sets.of(task)
        one = self._played = tasks.rows([row])
        self._next_state, self._goal = one.next_state[0].numpy(), one.goal[0].numpy()
        self._table = self._reward.table(tasks, row)
        self._states = [int(one.start[0])]
        self._over = False
        return self._observer.observe(one, self.state), self._info()

    def step(self, action: SupportsIndex) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Take an action: 0 forward, 1 left, 2 right, 3 interact.

        Args:
            action: A Python, NumPy or torch integer.

        Raises:
            UsageError: If it is not a valid action, or the episode is over.
        """
        number = whole_number(action, most=ACTIONS - 1)
        if number is None:
            raise UsageError(
                f"{reprlib.repr(action)} is not an action. Valid: integers 0 .. {ACTIONS - 1}."
            )
        one = self.played
        if self._over:
            raise UsageError("The episode is over: call reset.")
        self._states.append(int(self._next_state[self.state, number]))
        cell = self.state // HEADINGS
        terminated = self.terminate_at_goal and bool(self._goal[cell])
        truncated = not terminated and self.steps == self.benchmark.semantics.horizon
        self._over = terminated or truncated
        seen = self._observer.observe(one, self.state)
        return seen, float(self._table[cell]), terminated, truncated, self._info()

    def render(self) -> Any:  # noqa: ANN401 - as the render mode says
        """The current state as uint8 [row, column, 3] RGB or text; None without a render mode."""
        if self.render_mode is None:
            gymnasium.logger.warn("No render mode: gymnasium.make(..., render_mode='rgb_array').")
            return None
        if self.render_mode == "ansi":
            return text_map(self.played, self.states, horizon=self.benchmark.semantics.horizon)
        if self._painter is None:
            self._painter = FramePainter(horizon=self.benchmark.semantics.horizon)
        return self._painter.paint(self.played, self.states)

    def close(self) -> None:
        """Free houses, scored rewards and drawings."""
        self._sets.clear()
        self._reward.clear()
        self._played = self._painter = None

    @property
    def spec(self) -> EnvSpec | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The arguments of `gymnasium.make`; None without it. `spec.to_json()` serialises them."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        self._spec = None if spec is None else HouseSpec.of(spec)
        horizon = self.benchmark.semantics.horizon
        if spec is not None and horizon > DEFAULT_SEMANTICS.horizon:
            _logger.warning(
                "notice: gymnasium.make ends episodes after %d steps; for the %d of %s, pass it "
                "max_episode_steps=%d",
                *(DEFAULT_SEMANTICS.horizon, horizon, self.benchmark.name, horizon),
            )

    @property
    def played(self) -> TaskSet:
        """The current task, as a set of one.

        Raises:
            UsageError: Before the first reset.
        """
        if self._played is None:
            raise UsageError("No episode has been started: call reset.")
        return self._played

    @property
    def task(self) -> Task:
        """The current task."""
        return self.played.task

    @property
    def state(self) -> int:
        """The current state, as in `mdp.task_batch`."""
        return self._states[-1]

    @property
    def states(self) -> tuple[int, ...]:
        """All states of the episode so far."""
        return tuple(self._states)

    @property
    def steps(self) -> int:
        """Number of actions taken in the episode so far."""
        return len(self._states) - 1

    def _info(self) -> dict[str, Any]:
        task = self.task
        return {
            "success": bool(self._goal[self.state // HEADINGS]),
            "task": task.id,
            "split": task.split.value,
            "kind": task.kind.value,
            "optimal_length": task.proof.optimal_length,
            "optimal_value": task.proof.value,
        }

    def _asked_for(self, options: object) -> Task | None:
        """The task named in the options of a reset."""
        if options is None:
            return None
        if not isinstance(options, Mapping):
            raise UsageError(
                f"options is {reprlib.repr(options)}. Valid: a dictionary, "
                'such as {"task": "<id of a task>"}.'
            )
        unknown = [key for key in options if key != "task"]
        if unknown:
            raise UsageError(f"Unknown option '{unknown[0]}' of reset. Valid: task.")
        if options.get("task") is None:
            return None
        return task_named(self.benchmark, check_task_id("options['task']", options["task"]))

    def _select(
        self, split: str | None, kind: str | None, tasks: Sequence[str] | None
    ) -> tuple[Task, ...]:
        if tasks is not None:
            ids = check_task_ids("tasks", tasks)
            chosen = tuple(task_named(self.benchmark, name) for name in ids)
        else:
            chosen = self.benchmark.select(
                split=_member(Split, "split", split), kind=_member(Kind, "kind", kind)
            )
        if not chosen:
            what = "tasks=()" if tasks is not None else f"split={split!r}, kind={kind!r}"
            raise NothingSelectedError(f"{self.benchmark.name} has no task of {what}.")
        return chosen


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


def _compute_alone_if_forked() -> None:
    """Keep torch on one thread in a forked process, where its parent's pool of threads hangs."""
    if is_forked() and torch.get_num_threads() > 1:
        torch.set_num_threads(1)
