"""The evaluation harness: what a learned reward or policy achieves, exactly.

A `Reward` is re-optimised in the house it is tested in by exact Q-iteration on dynamics that do not
end at the goal (an ending episode would tell the planner where the goal is); a `Policy` acts as it
is. Success is the exact probability that the goal predicate holds at some step within the horizon:
nothing is sampled, so a figure has no noise and repeats to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch

from lcrl_bench.benchmarks.compiled import CompiledTasks
from lcrl_bench.benchmarks.dynamics import OBJECT_STATES, ObjectState
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.q_iteration import q_iteration
from lcrl_bench.mdp.success import final_success_probability, success_probability, uniform_policy
from lcrl_bench.methods.contract import HouseViews, Policy, Reward

CHUNK = 16
"""Tasks solved at once: bounds memory at about 100 MB, whatever the house."""


@dataclass(frozen=True)
class Outcome:
    """What came of one task."""

    task: Task
    success: float
    """Probability that the goal predicate holds at some step within the horizon."""
    final_success: float
    """Probability that it holds at the last step."""


class ConstantReward(Reward):
    """Scores everything alike: a control that any leak of the goal would make succeed."""

    def score(
        self, views: HouseViews, panoramas: torch.Tensor, commands: Sequence[str]
    ) -> torch.Tensor:
        """Zero for every panorama and command."""
        return torch.zeros(panoramas.shape, device=panoramas.device)


def solve(learned: Reward | Policy, views: HouseViews, tasks: CompiledTasks) -> torch.Tensor:
    """The policy that a learned reward or policy gives in a house.

    Returns:
        float [task, horizon, state, action]: probabilities.
    """
    commands = [task.command for task in tasks.tasks]
    with torch.no_grad():
        if isinstance(learned, Reward):
            reward = learned.score(views, tasks.panoramas, commands)
            return q_iteration(tasks.batch, reward.double()).policy
        logits = learned.logits(views, tasks.panoramas, held_cells(tasks), commands)
        policy = logits.double().softmax(-1)
    policy = policy.reshape(len(commands), 1, tasks.batch.states, -1)
    return policy.expand(-1, tasks.batch.horizon, -1, -1)


def held_cells(tasks: CompiledTasks) -> torch.Tensor:
    """Where the object is in the agent's hand: bool [task, cell]."""
    held = torch.zeros_like(tasks.batch.goal)
    if tasks.tasks[0].kind == Kind.PICK:
        by_state = held.view(len(tasks.tasks), OBJECT_STATES, -1)
        by_state[:, ObjectState.HELD] = True
    return held


def evaluate(learned: Reward | Policy, problems: Sequence[Problem]) -> tuple[Outcome, ...]:
    """Evaluate on every task of every split, in the order of the compiled houses."""
    return tuple(
        outcome
        for problem in problems
        for tasks in problem.compiled.sets
        for part in chunks(tasks)
        for outcome in _outcomes(part, solve(learned, problem.views, part))
    )


def evaluate_random(problems: Sequence[Problem]) -> tuple[Outcome, ...]:
    """What uniformly random actions achieve."""
    return tuple(
        outcome
        for problem in problems
        for tasks in problem.compiled.sets
        for part in chunks(tasks)
        for outcome in _outcomes(part, uniform_policy(part.batch))
    )


def evaluate_optimal(problems: Sequence[Problem], success_reward: float) -> tuple[Outcome, ...]:
    """What the optimal policy under the true reward achieves."""
    return tuple(
        outcome
        for problem in problems
        for tasks in problem.compiled.sets
        for part in chunks(tasks)
        for outcome in _outcomes(part, expert_policy(part.batch, success_reward))
    )


def chunks(tasks: CompiledTasks, *, size: int = CHUNK) -> list[CompiledTasks]:
    """A compiled set in parts of at most `size` tasks."""
    count = len(tasks.tasks)
    return [tasks.rows(range(k, min(k + size, count))) for k in range(0, count, size)]


def _outcomes(tasks: CompiledTasks, policy: torch.Tensor) -> list[Outcome]:
    success = success_probability(tasks.batch, policy).tolist()
    final = final_success_probability(tasks.batch, policy).tolist()
    return [Outcome(*row) for row in zip(tasks.tasks, success, final, strict=True)]
