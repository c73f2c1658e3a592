"""`HouseEnvironment`: the tasks of a benchmark as a Gymnasium environment.

It steps through the same tables as the exact solvers, so results are exactly comparable with the
optimum; an agent gets only observations and rewards. The reward of a step is that of the state it
leads to, r(s'): the start's reward, the same for every policy, is left out.
"""

from __future__ import annotations

import logging
import reprlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar, SupportsFloat, SupportsIndex

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.envs.arguments import check_seed, whole_number
from lcrl_bench.envs.frame import FramePainter
from lcrl_bench.envs.played_tasks import PlayedTask, PlayedTasks
from lcrl_bench.envs.setup import (
    METADATA,
    TRUE,
    Setup,
    check_options,
    compute_alone_if_forked,
    task_asked_for,
)
from lcrl_bench.envs.spec import HouseSpec
from lcrl_bench.envs.text_map import text_map
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.methods.contract import Reward
from lcrl_bench.semantics import DEFAULT_SEMANTICS

_logger = logging.getLogger(__name__)


class HouseEnvironment(gymnasium.Env[Any, Any]):
    """One task per episode, in one or many houses; at most `horizon` steps, four actions.

    An episode ends (`truncated`) after the benchmark's horizon of 30 steps and, with
    `terminate_at_goal`, at success (`terminated`).
    """

    metadata: ClassVar[dict[str, Any]] = dict(METADATA)

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
            renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for views that are not cached.
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
        setup = Setup.of(
            benchmark=benchmark,
            split=split,
            kind=kind,
            tasks=tasks,
            reward=reward,
            terminate_at_goal=terminate_at_goal,
            observation=observation,
            one_hot=one_hot,
            text=text,
            position=position,
            renderer=renderer,
            houses_kept=houses_kept,
            render_mode=render_mode,
        )
        self.render_mode = setup.render_mode
        self.benchmark = setup.benchmark
        self.tasks = setup.tasks
        self.terminate_at_goal = setup.terminate_at_goal
        self.observation_space = setup.observer.space
        self.action_space = gymnasium.spaces.Discrete(ACTIONS)
        self._reward = setup.reward
        self._sets = PlayedTasks(setup)
        self._horizon = setup.benchmark.semantics.horizon
        self._current: PlayedTask | None = None
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
        chosen = None
        if options is not None:
            asked = check_options(options, valid=("task",)).get("task")
            chosen = task_asked_for(self.benchmark, asked, where="options['task']")
        if seed is not None:
            super().reset(seed=check_seed(seed))
        task = chosen or self.tasks[int(self.np_random.integers(len(self.tasks)))]
        current = self._current = self._sets.of(task)
        self._played = None
        start = current.start
        self._states = [start]
        self._over = False
        info = current.facts.copy()
        info["success"] = current.goal[start // HEADINGS]
        return current.observe(start), info

    def step(self, action: SupportsIndex) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Take an action: 0 forward, 1 left, 2 right, 3 interact.

        Args:
            action: A Python, NumPy or torch integer.

        Raises:
            UsageError: If it is not a valid action, or the episode is over.
        """
        # Two types are nearly all that occur, and Python's is compared several times faster.
        number = action if type(action) is int else int(action) if type(action) is np.int64 else -1
        if not 0 <= number < ACTIONS:
            number = _action(action)
        current = self._current
        if current is None:
            raise _not_started()
        if self._over:
            raise UsageError("The episode is over: call reset.")
        states = self._states
        state = current.next_state[states[-1] * ACTIONS + number]
        states.append(state)
        cell = state // HEADINGS
        info = current.facts.copy()
        terminated = truncated = False
        if current.goal[cell]:
            info["success"] = True
            terminated = self._over = self.terminate_at_goal
        if len(states) > self._horizon and not terminated:
            truncated = self._over = True
        return current.observe(state), current.reward[cell], terminated, truncated, info

    def render(self) -> Any:  # noqa: ANN401 - as the render mode says
        """The current state as uint8 [row, column, 3] RGB or text; None without a render mode."""
        if self.render_mode is None:
            gymnasium.logger.warn("No render mode: gymnasium.make(..., render_mode='rgb_array').")
            return None
        if self.render_mode == "ansi":
            return text_map(self.played, self.states, horizon=self._horizon)
        if self._painter is None:
            self._painter = FramePainter(horizon=self._horizon)
        return self._painter.paint(self.played, self.states)

    def close(self) -> None:
        """Free houses, scored rewards and drawings."""
        self._sets.clear()
        self._reward.clear()
        self._current = self._played = self._painter = None

    @property
    def spec(self) -> EnvSpec | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The arguments of `gymnasium.make`; None without it. `spec.to_json()` serialises them."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        self._spec = None if spec is None else HouseSpec.of(spec)
        horizon = self._horizon
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
        if self._current is None:
            raise _not_started()
        if self._played is None:
            compute_alone_if_forked()
            self._played = self._current.tasks.rows([self._current.row])
        return self._played

    @property
    def task(self) -> Task:
        """The current task."""
        if self._current is None:
            raise _not_started()
        return self._current.tasks.tasks[self._current.row]

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


def _action(action: object) -> int:
    number = whole_number(action, most=ACTIONS - 1)
    if number is None:
        raise UsageError(
            f"{reprlib.repr(action)} is not an action. Valid: integers 0 .. {ACTIONS - 1}."
        )
    return number


def _not_started() -> UsageError:
    return UsageError("No episode has been started: call reset.")
