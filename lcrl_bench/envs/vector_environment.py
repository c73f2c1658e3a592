"""`HouseVectorEnvironment`: many `HouseEnvironment`s in one, stepped by gathers over shared tables.

Its episodes are those of single environments under the same seeds, with the same observations,
rewards, flags and infos as in Gymnasium's `SyncVectorEnv`. Only the start of an episode takes
Python code per sub-environment.
"""

from __future__ import annotations

import reprlib
from collections.abc import Mapping, Sequence
from typing import Any, Final

import gymnasium
import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_sets import TaskSets
from lcrl_bench.envs.arguments import (
    check_actions,
    check_count,
    check_flag,
    check_name,
    check_seeds,
)
from lcrl_bench.envs.draws import Draws
from lcrl_bench.envs.setup import (
    METADATA,
    Setup,
    check_options,
    compute_alone_if_forked,
    task_asked_for,
)
from lcrl_bench.envs.spec import HouseSpec
from lcrl_bench.envs.table_pool import Segment, TablePool
from lcrl_bench.envs.vector_info import VectorInfo
from lcrl_bench.envs.vector_pictures import VectorPictures
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS

_OWN: Final = ("num_envs", "max_episode_steps", "autoreset_mode", "copy")
# As arrays: NumPy takes as long to convert a Python number as to compute with it.
_ACTIONS, _HEADINGS = np.array(ACTIONS), np.array(HEADINGS)
_MODES: Final = {mode.value: mode for mode in AutoresetMode}


class HouseVectorEnvironment(VectorEnv[Any, Any, Any]):
    """One task per sub-environment and episode; `gymnasium.make_vec` makes it by default."""

    def __init__(
        self,
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        **arguments: Any,  # noqa: ANN401 - those of `HouseEnvironment`
    ) -> None:
        """Open a benchmark; a house is loaded when one of its tasks is first played.

        Args:
            num_envs: Number of sub-environments.
            max_episode_steps: Steps after which an episode is truncated, if the benchmark's horizon
                isn't reached before; None means the horizon. `gymnasium.make_vec` passes 30.
            autoreset_mode: When a sub-environment whose episode is over starts the next:
                `"NextStep"` (at the next step, whose action it ignores), `"SameStep"` (at once; the
                last observation and info are in `final_obs` and `final_info`) or `"Disabled"` (when
                `reset` is told to).
            copy: Whether each observation is newly allocated; if not, its arrays are overwritten by
                the next.
            arguments: Those of `HouseEnvironment`; they hold for all sub-environments, which share
                `houses_kept`. Houses being played are kept in any case.

        Raises:
            UnknownNameError: If the name of an argument, or a name in one, is unknown.
            UsageError: If an argument has the wrong type, or can't be carried out.
            NothingSelectedError: If no task is selected.
            InvalidFileError: If the run directory has no run, or its model is damaged.
        """
        # Gymnasium closes what is deleted, even if it was never whole.
        self.closed = True
        self.num_envs = check_count("num_envs", num_envs)
        if max_episode_steps == -1:
            max_episode_steps = None
        if max_episode_steps is not None:
            max_episode_steps = check_count("max_episode_steps", max_episode_steps)
        if isinstance(autoreset_mode, AutoresetMode):
            autoreset_mode = autoreset_mode.value
        self._mode = _MODES[check_name("autoreset_mode", autoreset_mode, _MODES)]
        check_flag("copy", copy)
        setup = Setup.of_any(arguments, own=_OWN)
        self.metadata = {**METADATA, "autoreset_mode": self._mode}
        self.render_mode = setup.render_mode
        self.benchmark = setup.benchmark
        self.tasks = setup.tasks
        self.terminate_at_goal = setup.terminate_at_goal
        self.single_observation_space = setup.observer.space
        self.single_action_space = gymnasium.spaces.Discrete(ACTIONS)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._horizon = setup.benchmark.semantics.horizon
        limit = self._horizon if max_episode_steps is None else max_episode_steps
        self._longest = min(limit, self._horizon)
        # Unlike the horizon, a limit from outside also truncates an episode that terminates there.
        self._limit_is_outer = max_episode_steps is not None and limit <= self._horizon
        self._reward = setup.reward
        # Tables are copied to the pool, so a house that was loaded is of no further use.
        self._sets = TaskSets(setup.benchmark, renderer=setup.renderer, houses_kept=1)
        self._pool = TablePool(self._sets, setup.reward, setup.tasks, houses_kept=setup.houses_kept)
        self._batch = setup.observer.batch(self.num_envs, copy=copy)
        self._info = VectorInfo(self.num_envs)
        self._positions = np.zeros(self.num_envs, np.int64)
        self._clock = 0
        self._ends = np.zeros(self.num_envs, np.int64)
        self._over = np.zeros(self.num_envs, np.bool_)
        self._places: list[tuple[Segment, int] | None] = [None] * self.num_envs
        self._firsts = [0] * self.num_envs
        self._pictures: VectorPictures | None = None
        if setup.render_mode is not None:
            self._pictures = VectorPictures(self._sets, self.num_envs, setup.render_mode)
        self._draws = Draws(self.num_envs)
        self._started = False
        self._spec: EnvSpec | None = None
        self.closed = False

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode in each sub-environment, or in those of a mask.

        Args:
            seed: Seed of the first sub-environment, the next ones count on from it; or one seed per
                sub-environment. None continues the current sequences.
            options: `{"task": id}` plays that task everywhere, `{"task": [id, ...]}` one per
                sub-environment (None draws); `{"reset_mask": bool [sub-environment]}` resets only
                those that are True.

        Raises:
            UsageError: If a seed or an option is invalid, a task unknown, or a sub-environment that
                the mask leaves out has not been reset before.
        """
        compute_alone_if_forked()
        given = check_options(options, valid=("task", "reset_mask"))
        seeds = check_seeds(seed, self.num_envs)
        asked = self._asked_for(given.get("task"))
        mask = self._mask(given.get("reset_mask"))
        numbers = list(range(self.num_envs)) if mask is None else np.flatnonzero(mask).tolist()
        for number in numbers:
            if seeds[number] is not None:
                self._draws.seed(number, seeds[number])
        self._begin(numbers, asked)
        self._over[numbers] = False
        self._started = True
        cells = self._positions // _HEADINGS
        success = self._pool.goal.rows.take(cells)
        infos = self._info.whole(success) if mask is None else self._info.some(success, mask)
        return self._batch.observe(self._pool, self._positions, cells), infos

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:  # noqa: ANN401
        """Take an action in each sub-environment: 0 forward, 1 left, 2 right, 3 interact.

        Args:
            actions: Integers [sub-environment], as a NumPy array, a torch tensor or a list.

        Returns:
            Observations; float64 rewards, bool terminations and truncations [sub-environment]; and
            infos as arrays with their masks.

        Raises:
            UsageError: If an action is invalid, or an episode has not been started, or is over and
                resetting is disabled.
        """
        if not self._started:
            raise _not_started()
        again = np.flatnonzero(self._over).tolist() if np.count_nonzero(self._over) else []
        if again and self._mode is AutoresetMode.DISABLED:
            raise UsageError(
                f"The episodes of sub-environments {reprlib.repr(again)} are over, and autoreset "
                'is disabled: call reset(options={"reset_mask": terminations | truncations}).'
            )
        checked = check_actions(actions, self.num_envs, ACTIONS - 1, ignored=again)
        pool = self._pool
        moved = pool.next_state.rows.take(self._positions * _ACTIONS + checked)
        self._positions = moved.astype(np.int64)
        self._clock += 1
        if again:
            self._begin(again, {})
        cells = self._positions // _HEADINGS
        success, rewards = pool.goal.rows.take(cells), pool.reward.rows.take(cells)
        terminated = success.copy() if self.terminate_at_goal else np.zeros_like(success)
        truncated = self._truncated(terminated)
        if again:
            rewards[again], terminated[again], truncated[again] = 0.0, False, False
        if self._pictures is not None:
            self._pictures.extend(self.states, fresh=again)
        self._over = terminated | truncated
        infos: dict[str, Any] = {}
        if self._mode is AutoresetMode.SAME_STEP and np.count_nonzero(self._over):
            infos = self._final(success)
            self._begin(np.flatnonzero(self._over).tolist(), {})
            self._over[:] = False
            cells = self._positions // _HEADINGS
            success = pool.goal.rows.take(cells)
        seen = self._batch.observe(pool, self._positions, cells)
        infos |= self._info.whole(success)
        return seen, rewards, terminated, truncated, infos

    def render(self) -> tuple[Any, ...]:
        """A frame per sub-environment, as `HouseEnvironment.render` returns."""
        if self._pictures is None:
            gymnasium.logger.warn(
                "No render mode: gymnasium.make_vec(..., render_mode='rgb_array')."
            )
            return (None,) * self.num_envs
        return tuple(map(self._pictures.frame, range(self.num_envs), self.played))

    def close_extras(self, **kwargs: Any) -> None:  # noqa: ANN401 - as the base class
        """Free houses, scored rewards and drawings."""
        self._pool.clear()
        self._reward.clear()
        if self._pictures is not None:
            self._pictures.clear()
        self._places = [None] * self.num_envs
        self._started = False

    @property
    def spec(self) -> EnvSpec | None:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The arguments of `gymnasium.make_vec`; None without it."""
        return self._spec

    @spec.setter
    def spec(self, spec: EnvSpec | None) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        self._spec = None if spec is None else HouseSpec.of(spec)

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The generator of each sub-environment."""
        return self._draws.generators

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The seed of each sub-environment."""
        return self._draws.seeds

    @property
    def played(self) -> tuple[Task, ...]:
        """The current task of each sub-environment.

        Raises:
            UsageError: Before the first reset.
        """
        places = map(self._place, range(self.num_envs))
        return tuple(segment.tasks[row] for segment, row in places)

    @property
    def states(self) -> NDArray[np.int64]:
        """The current state of each sub-environment, as in `mdp.task_batch`: int64.

        Raises:
            UsageError: Before the first reset.
        """
        if not self._started:
            raise _not_started()
        return self._positions - self._pool.first_state.rows.take(self._positions // HEADINGS)

    def _begin(self, numbers: Sequence[int], asked: Mapping[int, Task]) -> None:
        """Start an episode in some sub-environments: of the tasks asked for, or drawn."""
        pool, compactions = self._pool, self._pool.compactions
        found: dict[int, tuple[Segment, int]] = {}

        def playing() -> set[str]:
            others = [place for k, place in enumerate(self._places) if place and k not in numbers]
            return {segment.tasks[0].house for segment, _ in (*found.values(), *others)}

        for number in numbers:
            task = asked.get(number)
            if task is None:
                task = self.tasks[self._draws.below(number, len(self.tasks))]
            found[number] = pool.find(task, playing)
        if pool.compactions != compactions:
            self._follow_tables()
        end = self._clock + self._longest
        for number, (segment, row) in found.items():
            task, start = segment.tasks[row], segment.starts[row]
            self._places[number] = (segment, row)
            self._firsts[number] = segment.first
            self._positions[number] = segment.first + start
            self._ends[number] = end
            if self._pictures is not None:
                self._pictures.begin(number, start - row * segment.states)
            self._batch.begin(number, task)
            self._info.begin(number, task)

    def _follow_tables(self) -> None:
        """Correct the positions after tables have moved."""
        for number, place in enumerate(self._places):
            if place is not None:
                self._positions[number] += place[0].first - self._firsts[number]
                self._firsts[number] = place[0].first

    def _truncated(self, terminated: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """As the environment itself and Gymnasium's `TimeLimit` around it together say."""
        late = self._ends == self._clock
        return late if self._limit_is_outer else late & ~terminated

    def _final(self, success: NDArray[np.bool_]) -> dict[str, Any]:
        """The last observations and infos of the episodes that are over."""
        over = self._over
        seen = np.full(self.num_envs, None)
        for number in np.flatnonzero(over).tolist():
            seen[number] = self._batch.single(self._pool, number, int(self._positions[number]))
        return {
            "final_obs": seen,
            "_final_obs": over.copy(),
            "final_info": self._info.some(success, over),
            "_final_info": over.copy(),
        }

    def _place(self, number: int) -> tuple[Segment, int]:
        place = self._places[number]
        if place is None:
            raise _not_started()
        return place

    def _asked_for(self, tasks: object) -> dict[int, Task]:
        """The task that each sub-environment is to play, of those that are told one."""
        names = [tasks] * self.num_envs if tasks is None or isinstance(tasks, str) else tasks
        if not isinstance(names, (list, tuple)) or len(names) != self.num_envs:
            raise UsageError(
                f"options['task'] is {reprlib.repr(tasks)}. Valid: the id of a task, or a list of "
                f"{self.num_envs} ids, one per sub-environment."
            )
        asked = {
            number: task_asked_for(self.benchmark, name, where=f"options['task'][{number}]")
            for number, name in enumerate(names)
        }
        return {number: task for number, task in asked.items() if task is not None}

    def _mask(self, mask: object) -> NDArray[np.bool_] | None:
        """The mask of a reset; None for all sub-environments."""
        if mask is None:
            return None
        shape = (self.num_envs,)
        if not isinstance(mask, np.ndarray) or (mask.dtype, mask.shape) != (np.bool_, shape):
            found = f"{mask.dtype}{list(mask.shape)}" if isinstance(mask, np.ndarray) else mask
            raise UsageError(
                f"options['reset_mask'] is {reprlib.repr(found)}. Valid: a NumPy array of "
                f"{self.num_envs} booleans."
            )
        if not mask.any():
            raise UsageError("options['reset_mask'] is False everywhere: nothing is to be reset.")
        for number in np.flatnonzero(~mask).tolist():
            self._place(number)
        return mask


def _not_started() -> UsageError:
    return UsageError("No episode has been started: call reset.")
