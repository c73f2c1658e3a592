"""`HouseEnvironment`: the tasks of a benchmark as a Gymnasium environment.

It steps through the same tables that the exact solvers use, so whatever is learned in it is
comparable with the optimum to the bit; an agent is told observations and rewards only. The reward
of a step is that of the state it leads to, r(s'): the start pays nothing, which is the same for
every policy.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any, ClassVar, Final, SupportsFloat, SupportsInt, TypeVar

import gymnasium

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.envs.frame import FramePainter
from lcrl_bench.envs.observation import (
    OBSERVATIONS,
    Observer,
    PanoramaObserver,
    StateObserver,
    TabularObserver,
)
from lcrl_bench.envs.reward_table import LearnedReward, RewardTable, TrueReward
from lcrl_bench.envs.text_map import text_map
from lcrl_bench.envs.world import World, Worlds, task_named
from lcrl_bench.errors import NothingSelectedError, UnknownNameError, UsageError
from lcrl_bench.evaluation.learned import load_reward
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.methods.contract import Reward

TRUE: Final = "true"
"""The reward of the environment itself."""
_logger = logging.getLogger(__name__)
_Name = TypeVar("_Name", bound=StrEnum)


class HouseEnvironment(gymnasium.Env[Any, Any]):
    """One task an episode, of one or many houses; at most `horizon` steps, four actions.

    An episode ends (`truncated`) after the benchmark's horizon of 30 steps and, where
    `terminate_at_goal` says so, at success (`terminated`).
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
        """Open a benchmark; no house is compiled before one of its tasks is played.

        Args:
            benchmark: A shipped benchmark's name, a folder, or one that was read already: many
                environments can share it.
            split: `"train"`, `"test-task"` or `"test-house"`; None means all.
            kind: `"nav"` or `"pick"`; None means both.
            tasks: Ids of the only tasks to play, whatever `split` and `kind` say.
            reward: `"true"`; a run directory, `runs/<benchmark>/<method>/seed<k>`, whose learned
                reward is paid (its method's code is imported); or a learned reward itself.
            terminate_at_goal: Whether success ends the episode. None means yes with the true reward
                and no with a learned one: an episode that ends at the goal would tell the agent
                where the goal is.
            observation: `"panorama"` (a dictionary), `"tabular"` (a vector) or `"state"` (a
                number); see `lcrl_bench.envs.observation`.
            one_hot: Whether the panorama of the dictionary is one-hot.
            text: Whether the dictionary holds the command as text, which Stable-Baselines3 does not
                take.
            position: Whether the dictionary holds the tile the agent is in.
            renderer: `"auto"`, `"gl"` or `"rays"`, for views that are not in the cache.
            houses_kept: How many compiled houses stay in memory; one takes about a megabyte.
            render_mode: `"rgb_array"`, `"ansi"` or None.

        Raises:
            UnknownNameError: If the benchmark, the split, the kind, the observation or the render
                mode is none there is.
            UsageError: If a task is none of the benchmark, or the run learned a policy.
            NothingSelectedError: If no task is of that split and kind.
            InvalidFileError: If the run directory holds no run, or its model is damaged.
        """
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise UnknownNameError("render mode", render_mode, self.metadata["render_modes"])
        if houses_kept < 1:
            raise UsageError(f"houses_kept is {houses_kept}; at least one house is played in.")
        self.render_mode = render_mode
        self.benchmark = (
            benchmark
            if isinstance(benchmark, Benchmark)
            else read_benchmark(benchmark_folder(str(benchmark)))
        )
        self.tasks = self._select(split, kind, tasks)
        true = isinstance(reward, str) and reward == TRUE
        self.terminate_at_goal = true if terminate_at_goal is None else terminate_at_goal
        if terminate_at_goal and not true:
            _logger.warning("notice: episodes end at the true goal, which a learned reward hides")
        self._reward = _reward_table(reward, self.benchmark)
        self._observer = _observer(
            observation, self.benchmark, one_hot=one_hot, text=text, position=position
        )
        self.observation_space = self._observer.space
        self.action_space = gymnasium.spaces.Discrete(ACTIONS)
        self._worlds = Worlds(self.benchmark, renderer=renderer, houses_kept=houses_kept)
        self._world: World | None = None
        self._states: list[int] = []
        self._over = False
        self._painter: FramePainter | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode of a task drawn uniformly; equal seeds give equal episodes.

        Args:
            seed: Of the draws; None goes on with those before.
            options: `{"task": id}` plays that task of the benchmark instead of drawing one.

        Raises:
            UsageError: If there is no such option or no such task.
        """
        super().reset(seed=seed)
        chosen = dict(options or {})
        name = chosen.pop("task", None)
        if chosen:
            raise UsageError(f"Unknown option '{next(iter(chosen))}' of reset. Valid: task.")
        if name is None:
            task = self.tasks[int(self.np_random.integers(len(self.tasks)))]
        else:
            task = task_named(self.benchmark, name)
        self._world = self._worlds.of(task)
        self._table = self._reward.table(self._world)
        self._states = [self._world.start]
        self._over = False
        return self._observer.observe(self._world, self.state), self._info()

    def step(self, action: SupportsInt) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Take an action: 0 forward, 1 left, 2 right, 3 interact.

        Raises:
            UsageError: If it is no action, or the episode is over.
        """
        number = int(action)
        if not 0 <= number < ACTIONS:
            raise UsageError(f"{number} is no action. Valid: 0 .. {ACTIONS - 1}.")
        world = self.world
        if self._over:
            raise UsageError("The episode is over: call reset.")
        self._states.append(int(world.next_state[self.state, number]))
        cell = self.state // HEADINGS
        terminated = self.terminate_at_goal and bool(world.goal[cell])
        truncated = not terminated and self.steps == self.benchmark.semantics.horizon
        self._over = terminated or truncated
        seen = self._observer.observe(world, self.state)
        return seen, float(self._table[cell]), terminated, truncated, self._info()

    def render(self) -> Any:  # noqa: ANN401 - as the render mode says
        """The present state: uint8 [row, column, 3] RGB of one size, or text; None without mode."""
        if self.render_mode is None:
            gymnasium.logger.warn("No render mode: gymnasium.make(..., render_mode='rgb_array').")
            return None
        if self.render_mode == "ansi":
            return text_map(self.world, self.states, horizon=self.benchmark.semantics.horizon)
        if self._painter is None:
            self._painter = FramePainter(horizon=self.benchmark.semantics.horizon)
        return self._painter.paint(self.world, self.states)

    def close(self) -> None:
        """Let go of compiled houses, scored rewards and drawings."""
        self._worlds.clear()
        self._reward.clear()
        self._world = self._painter = None

    @property
    def world(self) -> World:
        """The task that is played, with its house.

        Raises:
            UsageError: Before the first reset.
        """
        if self._world is None:
            raise UsageError("No episode has begun: call reset.")
        return self._world

    @property
    def task(self) -> Task:
        """The task that is played."""
        return self.world.task

    @property
    def state(self) -> int:
        """The present state, as in `mdp.task_batch`."""
        return self._states[-1]

    @property
    def states(self) -> tuple[int, ...]:
        """All states of the episode so far."""
        return tuple(self._states)

    @property
    def steps(self) -> int:
        """Actions taken in the episode so far."""
        return len(self._states) - 1

    def _info(self) -> dict[str, Any]:
        task = self.task
        return {
            "success": bool(self.world.goal[self.state // HEADINGS]),
            "task": task.id,
            "split": task.split.value,
            "kind": task.kind.value,
            "optimal_length": task.proof.optimal_length,
            "optimal_value": task.proof.value,
        }

    def _select(
        self, split: str | None, kind: str | None, tasks: Sequence[str] | None
    ) -> tuple[Task, ...]:
        if tasks is not None:
            chosen = tuple(task_named(self.benchmark, name) for name in tasks)
        else:
            chosen = self.benchmark.select(
                split=_member(Split, "split", split), kind=_member(Kind, "kind", kind)
            )
        if not chosen:
            what = "tasks=()" if tasks is not None else f"split={split!r}, kind={kind!r}"
            raise NothingSelectedError(f"{self.benchmark.name} has no task of {what}.")
        return chosen


def _reward_table(reward: str | Path | Reward, benchmark: Benchmark) -> RewardTable:
    if isinstance(reward, Reward):
        return LearnedReward(reward)
    if reward == TRUE:
        return TrueReward(benchmark.semantics.success_reward)
    return LearnedReward(load_reward(Path(reward)))


def _observer(
    observation: str, benchmark: Benchmark, *, one_hot: bool, text: bool, position: bool
) -> Observer:
    if observation == "panorama":
        return PanoramaObserver(benchmark, one_hot=one_hot, text=text, position=position)
    if observation == "tabular":
        return TabularObserver(benchmark)
    if observation == "state":
        return StateObserver(benchmark)
    raise UnknownNameError("observation", observation, OBSERVATIONS)


def _member(names: type[_Name], kind: str, name: str | None) -> _Name | None:
    if name is None:
        return None
    if name not in set(names):
        raise UnknownNameError(kind, name, [each.value for each in names])
    return names(name)
