"""The evaluation harness: what a learned reward or policy achieves, exactly.

A `Reward` is re-optimised in the house it is tested in by exact Q-iteration on dynamics that do not
end at the goal (an ending episode would tell the planner where the goal is); a `Policy` acts as it
is. What is measured is an exact probability or expectation: nothing is sampled, so a figure has no
noise and repeats to the bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import torch

from lcrl_bench.benchmarks.compiled import CompiledTasks
from lcrl_bench.benchmarks.task import Task
from lcrl_bench.evaluation.outcome import Outcome, outcomes_of
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.policy_outcome import PolicyOutcome, follow, follow_greedy
from lcrl_bench.mdp.success import uniform_policy
from lcrl_bench.methods.contract import HouseViews, Policy, Reward
from lcrl_bench.methods.observed_house import Answers, ask
from lcrl_bench.methods.tensors import TensorReward

Sentences = Callable[[Task], str | None]
"""The sentence a task is given; None leaves the task out."""


class ConstantReward(TensorReward):
    """Scores everything alike: a control that any leak of the goal would make succeed."""

    def score(self, views: HouseViews, commands: Sequence[str]) -> torch.Tensor:
        """Zero for every command and panorama."""
        return torch.zeros(len(commands), len(views.panorama_views), device=views.views.device)


def own_command(task: Task) -> str:
    """The sentence of the task itself."""
    return task.command


def evaluate(
    learned: Reward | Policy, problems: Sequence[Problem], *, commands: Sentences = own_command
) -> tuple[Outcome, ...]:
    """Evaluate on every task of every split, in the order of the compiled houses.

    Args:
        learned: A reward is re-optimised exactly in each house; a policy acts as it is.
        problems: The houses and their tasks.
        commands: The sentence that each task is given in place of its own. Success is success at
            the task's own goal, whatever is said.
    """
    return evaluate_each(learned, problems, {"": commands})[""]


def evaluate_each(
    learned: Reward | Policy, problems: Sequence[Problem], commands: Mapping[str, Sentences]
) -> dict[str, tuple[Outcome, ...]]:
    """Evaluate under several choices of sentences: `evaluate` of each, by name.

    A house is looked at once for all of them, with all that is said in it at once.
    """
    outcomes: dict[str, list[Outcome]] = {name: [] for name in commands}
    for problem in problems:
        said = [
            (name, part, {task.id: sentence_of(task) for task in part.tasks})
            for part in problem.parts
            for name, sentence_of in commands.items()
        ]
        sentences = [text for *_, row in said for text in row.values() if text is not None]
        answers = ask(learned, problem.observed, sentences)
        for name, part, row in said:
            outcomes[name] += _evaluate_part(answers, part, row)
    return {name: tuple(rows) for name, rows in outcomes.items()}


def evaluate_random(problems: Sequence[Problem]) -> tuple[Outcome, ...]:
    """What uniformly random actions achieve."""

    def wander(part: CompiledTasks) -> PolicyOutcome:
        policy = uniform_policy(part.batch, dtype=torch.float64)
        return follow(part.batch, policy, waypoint=part.held)

    return _evaluate_with(wander, problems)


def evaluate_optimal(problems: Sequence[Problem], success_reward: float) -> tuple[Outcome, ...]:
    """What the optimal policy under the true reward achieves."""

    def excel(part: CompiledTasks) -> PolicyOutcome:
        reward = true_reward(part.batch, success_reward, dtype=torch.float64)
        return follow_greedy(part.batch, reward, waypoint=part.held)

    return _evaluate_with(excel, problems)


def _evaluate_part(
    answers: Answers, part: CompiledTasks, sentences: Mapping[str, str | None]
) -> list[Outcome]:
    given = [row for row, task in enumerate(part.tasks) if sentences[task.id] is not None]
    if not given:
        return []
    tasks = part if len(given) == len(part.tasks) else part.rows(given)
    commands = [text for text in sentences.values() if text is not None]
    return outcomes_of(tasks, _journey(answers, tasks, commands))


def _journey(answers: Answers, tasks: CompiledTasks, commands: Sequence[str]) -> PolicyOutcome:
    """What comes of tasks, exactly: a reward is re-optimised, a policy acts as it is."""
    if answers.of_reward:
        reward = answers.reward(tasks.panoramas, commands)
        return follow_greedy(tasks.batch, reward, waypoint=tasks.held)
    policy = answers.policy(tasks.panoramas, tasks.held, commands)
    policy = policy[:, None].expand(-1, tasks.batch.horizon, -1, -1)
    return follow(tasks.batch, policy, waypoint=tasks.held)


def _evaluate_with(
    go: Callable[[CompiledTasks], PolicyOutcome], problems: Sequence[Problem]
) -> tuple[Outcome, ...]:
    return tuple(
        outcome
        for problem in problems
        for part in problem.parts
        for outcome in outcomes_of(part, go(part))
    )
