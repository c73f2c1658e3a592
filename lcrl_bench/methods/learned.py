"""`Reward` and `Policy`: what a method learns, what it is given as input, and what it returns.

A state is a tile, a heading and an object state. A learned reward may depend only on what is seen
there, a learned policy also on the heading and on whether the object is held. Indices, order and
shapes could reveal the rest: in a house's own numbering, the index of a panorama tells where the
object is, so a reward for high indices would find every goal of PICK. Therefore each distinct
panorama is passed once (`Panoramas.observed`), and each distinct command once, in alphabetical
order. Outputs are mapped to the cells of the tasks here, out of the method's sight.

Source: Fu et al. (2019), section "Multi-Task IRL": rewards are functions of an observation and a
command.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Self

import torch

from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.drawn import Drawn
from lcrl_bench.drawn_array import DrawnArray
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.policy_outcome import PolicyOutcome, follow, follow_greedy
from lcrl_bench.mdp.rollouts import Trajectories, rollout
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.panoramas import ObservedHouse, Panoramas


class Reward(ABC):
    """A learned reward: scores (panorama, command) pairs.

    Example:
        >>> benchmark = lcrl_bench.load_benchmark("mini")
        >>> quick = {"passes": 1, "least_steps": 1}
        >>> results = lcrl_bench.run("lcrl", benchmark, settings=quick, progress=False)
        >>> reward = results.learned[0]
        >>> task = benchmark.tasks["test-house"][0]
        >>> reward.map(task).shape == (1, benchmark.grids[task.house].tiles)
        True
        >>> figure = reward.plan(task).plot()
    """

    @abstractmethod
    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        """Score every panorama for every command.

        A score must depend on one panorama and one command only: not on their indices or order, nor
        on what else is scored in the same call (see the module).

        Args:
            views: Panoramas, each once.
            commands: Sentences, each once; any text, including the empty string.

        Returns:
            float [command, panorama], finite.
        """

    @abstractmethod
    def save(self, folder: Path) -> None:
        """Write what `load` needs into `folder` (safetensors and JSON; no pickle).

        `config.json` is written last, so a folder that has it is complete.
        """

    @classmethod
    @abstractmethod
    def load(cls, folder: Path) -> Self:
        """Load what `save` wrote; scores are computed on the device of the views."""

    def map(self, task: Task) -> RewardMap:
        """The reward of every tile of a task's house: float64 [object state, tile].

        Args:
            task: A task of `load_benchmark(...).tasks`.
        """
        planned = self.plan(task)
        assert planned.reward is not None
        shape = (planned.tasks.object_states, planned.tasks.tiles)
        return RewardMap(planned.reward[0].view(shape).cpu().numpy(), planned)

    def plan(self, task: Task) -> Plan:
        """What an agent does in a task for this reward; see the function `plan`."""
        return plan(self, task.single())


class Policy(ABC):
    """A learned policy: action logits for (panorama, heading, held, command).

    Example:
        >>> benchmark = lcrl_bench.load_benchmark("mini")
        >>> quick = {"passes": 1, "least_steps": 1}
        >>> results = lcrl_bench.run("cloning", benchmark, settings=quick, progress=False)
        >>> policy = results.learned[0]
        >>> policy.plan(benchmark.tasks["train"][0]).states.shape
        torch.Size([1, 31])
    """

    @abstractmethod
    def logits(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        """Logits of the four actions in every situation; arguments as for `Reward.score`.

        Returns:
            float [command, panorama, held, heading, action], finite; `held` is 0 or 1: whether the
            object is in the agent's hand.
        """

    @abstractmethod
    def save(self, folder: Path) -> None:
        """Write what `load` needs into `folder`; see `Reward.save`."""

    @classmethod
    @abstractmethod
    def load(cls, folder: Path) -> Self:
        """Load what `save` wrote; logits are computed on the device of the views."""

    def plan(self, task: Task) -> Plan:
        """What the policy does in a task of `load_benchmark(...).tasks`."""
        return plan(self, task.single())


@dataclass(frozen=True, eq=False)
class Answers:
    """Outputs of a learned reward or policy for all panoramas of a house and some commands."""

    values: torch.Tensor
    """float [command, panorama] of a reward, [command, panorama, held, heading, action] of a
    policy."""
    rows: dict[str, int]
    """Command -> its row in `values`."""
    place: torch.Tensor
    """int64 [panorama of the house]; see `ObservedHouse.place`."""

    @property
    def of_reward(self) -> bool:
        """Whether these are the outputs of a reward rather than a policy."""
        return self.values.ndim == 2

    def reward(self, panoramas: torch.Tensor, commands: Sequence[str]) -> torch.Tensor:
        """The reward of each cell: float64 [task, cell].

        Args:
            panoramas: int64 [task, cell], in the house's own numbering.
            commands: One per task, among those asked.
        """
        return self.values[self._row(commands), self.place[panoramas]].double()

    def reward_of(self, tasks: TaskSet) -> torch.Tensor:
        """The reward of each cell under the tasks' own commands: float64 [task, cell]."""
        return self.reward(tasks.panoramas, tasks.commands)

    def policy(
        self, panoramas: torch.Tensor, held: torch.Tensor, commands: Sequence[str]
    ) -> torch.Tensor:
        """The action probabilities in each state: float64 [task, state, action].

        Args:
            panoramas: int64 [task, cell], in the house's own numbering.
            held: bool [task, cell]: whether the object is in the agent's hand.
            commands: One per task, among those asked.
        """
        logits = self.values[self._row(commands), self.place[panoramas], held.long()]
        return logits.double().softmax(-1).flatten(1, 2)

    def _row(self, commands: Sequence[str]) -> torch.Tensor:
        rows = [self.rows[command] for command in commands]
        return torch.tensor(rows, device=self.place.device)[:, None]


def ask(learned: Reward | Policy, house: ObservedHouse, commands: Sequence[str]) -> Answers:
    """Call a learned reward or policy on all panoramas of a house, once for all its tasks.

    Args:
        learned: What `Method.fit` returned.
        house: The panoramas it is given.
        commands: Sentences in any order, repetitions allowed.

    Raises:
        UsageError: If an output is not finite, or the shape is wrong.
    """
    distinct = sorted(set(commands))
    sizes = {"command": len(distinct), "panorama": len(house.views)}
    with torch.no_grad():
        if isinstance(learned, Reward):
            values = learned.score(house.show(), distinct)
        else:
            values = learned.logits(house.show(), distinct)
            sizes |= {"held": 2, "heading": HEADINGS, "action": ACTIONS}
    name, shape = type(learned).__name__, list(sizes.values())
    found = list(values.shape) if isinstance(values, torch.Tensor) else type(values).__name__
    if found != shape:
        raise UsageError(f"{name} answered {found}; wanted is [{', '.join(sizes)}] = {shape}.")
    if not bool(torch.isfinite(values).all()):
        command = next(c for c, row in zip(distinct, values, strict=True) if not _finite(row))
        raise UsageError(f"{name} answered {command!r} with a number that is not finite.")
    values = values.detach().to(house.place.device)
    return Answers(values, {command: row for row, command in enumerate(distinct)}, house.place)


def _finite(values: torch.Tensor) -> bool:
    return bool(torch.isfinite(values).all())


class RewardMap(DrawnArray):
    """A learned reward over a house: float64 [object state, tile]; its subject is a `Plan`."""

    drawing = "lcrl_bench.recording.drawings:draw_reward_map"


@dataclass(frozen=True, eq=False)
class Plan(Drawn):
    """What a learned reward or policy does in some tasks; plans of one task have a figure."""

    drawing = "lcrl_bench.recording.drawings:draw_plan"

    learned: Reward | Policy
    tasks: TaskSet
    reward: torch.Tensor | None
    """float64 [task, cell]; None for a policy."""
    value: torch.Tensor | None
    """float64 [task, state]: V_0 of the reward, re-optimised; None for a policy."""
    policy: torch.Tensor
    """float64 [task, horizon, state, action]."""

    @cached_property
    def trajectories(self) -> Trajectories:
        """Trajectories that take the most likely action in every step."""
        return rollout(self.tasks, self.policy)

    @property
    def states(self) -> torch.Tensor:
        """The states of `trajectories`: int64 [task, horizon + 1]."""
        return self.trajectories.states[:, 0]

    @property
    def actions(self) -> torch.Tensor:
        """The actions of `trajectories`: int64 [task, horizon]."""
        return self.trajectories.actions[:, 0]


def plan(learned: Reward | Policy, tasks: TaskSet) -> Plan:
    """The plan of a learned reward or policy under the tasks' own commands.

    A reward is re-optimised exactly, on dynamics that do not end at the goal, since ending there
    would reveal the goal to the planner. A policy acts as it is.
    """
    answers = ask(learned, tasks.views.observed, tasks.commands)
    if answers.of_reward:
        reward = answers.reward(tasks.panoramas, tasks.commands)
        solution = q_iteration(tasks, reward)
        return Plan(learned, tasks, reward, solution.values[:, 0], solution.policy)
    return Plan(learned, tasks, None, None, _timed(answers, tasks, tasks.commands))


def follow_answers(answers: Answers, tasks: TaskSet, commands: Sequence[str]) -> PolicyOutcome:
    """The outcome of planning on answers to any commands, without keeping the plan.

    Args:
        answers: From `ask`, in the house of the tasks.
        tasks: The tasks.
        commands: One per task, among those asked.
    """
    if answers.of_reward:
        reward = answers.reward(tasks.panoramas, commands)
        return follow_greedy(tasks, reward, waypoint=tasks.held)
    return follow(tasks, _timed(answers, tasks, commands), waypoint=tasks.held)


def _timed(answers: Answers, tasks: TaskSet, commands: Sequence[str]) -> torch.Tensor:
    """The policy of answers, the same at every step: float64 [task, horizon, state, action]."""
    policy = answers.policy(tasks.panoramas, tasks.held, commands)
    return policy[:, None].expand(-1, tasks.horizon, -1, -1)
