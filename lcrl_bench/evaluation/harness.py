"""The evaluation harness: exact evaluation of a learned reward or policy.

A `Reward` is re-optimised in each test house by exact Q-iteration on dynamics that don't end at the
goal (ending episodes would tell the planner where the goal is); a `Policy` acts unchanged. All
measures are exact probabilities or expectations: nothing is sampled, so results have no noise and
are reproducible to the bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import torch

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.outcome import Outcome, outcomes_of
from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.policy_outcome import PolicyOutcome, follow, follow_greedy
from lcrl_bench.mdp.success import uniform_policy
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.methods.learned import Answers, ask, follow_answers
from lcrl_bench.methods.tensors import TensorReward
from lcrl_bench.panoramas import Panoramas

Sentences = Callable[[Task], str | None]
"""Maps a task to its command; None leaves the task out."""


class ConstantReward(TensorReward):
    """Scores everything equally: a control that succeeds only if the goal leaks."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        """Zero for every command and panorama."""
        return torch.zeros(len(commands), len(views), device=views.views.device)


def own_command(task: Task) -> str:
    """The task's own command."""
    return task.command


def evaluate(
    learned: Reward | Policy, sets: Sequence[TaskSet], *, commands: Sentences = own_command
) -> tuple[Outcome, ...]:
    """Evaluate on every task, in the order of the sets.

    Args:
        learned: A reward is re-optimised exactly in each house; a policy acts unchanged.
        sets: The tasks.
        commands: Maps each task to its command. Success always means the task's own goal,
            whatever the command.
    """
    return evaluate_each(learned, sets, {"": commands})[""]


def evaluate_each(
    learned: Reward | Policy, sets: Sequence[TaskSet], commands: Mapping[str, Sentences]
) -> dict[str, tuple[Outcome, ...]]:
    """Evaluate under several sets of commands: `evaluate` for each, by name.

    Each house is encoded once for all of them, with all commands in it at once.
    """
    outcomes: dict[str, list[Outcome]] = {name: [] for name in commands}
    for house in by_house(sets):
        said = [
            (name, part, {task.id: sentence_of(task) for task in part.tasks})
            for tasks in house
            for part in tasks.parts
            for name, sentence_of in commands.items()
        ]
        sentences = [text for *_, row in said for text in row.values() if text is not None]
        answers = ask(learned, house[0].views.observed, sentences)
        for name, part, row in said:
            outcomes[name] += _evaluate_part(answers, part, row)
    return {name: tuple(rows) for name, rows in outcomes.items()}


def evaluate_random(sets: Sequence[TaskSet]) -> tuple[Outcome, ...]:
    """Outcomes of uniformly random actions."""

    def wander(part: TaskSet) -> PolicyOutcome:
        policy = uniform_policy(part, dtype=torch.float64)
        return follow(part, policy, waypoint=part.held)

    return _evaluate_with(wander, sets)


def evaluate_optimal(sets: Sequence[TaskSet], success_reward: float) -> tuple[Outcome, ...]:
    """Outcomes of the optimal policy under the true reward."""

    def excel(part: TaskSet) -> PolicyOutcome:
        reward = true_reward(part, success_reward, dtype=torch.float64)
        return follow_greedy(part, reward, waypoint=part.held)

    return _evaluate_with(excel, sets)


def _evaluate_part(
    answers: Answers, part: TaskSet, sentences: Mapping[str, str | None]
) -> list[Outcome]:
    given = [row for row, task in enumerate(part.tasks) if sentences[task.id] is not None]
    if not given:
        return []
    tasks = part if len(given) == len(part.tasks) else part.rows(given)
    commands = [text for text in sentences.values() if text is not None]
    return outcomes_of(tasks, follow_answers(answers, tasks, commands))


def _evaluate_with(
    go: Callable[[TaskSet], PolicyOutcome], sets: Sequence[TaskSet]
) -> tuple[Outcome, ...]:
    return tuple(
        outcome for tasks in sets for part in tasks.parts for outcome in outcomes_of(part, go(part))
    )
