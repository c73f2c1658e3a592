"""Re-optimise a learned reward by DQN in place of exact planning: the paper's second table.

The reward is scored in each house, and an agent a task learns from it by acting. What comes of its
greedy policy is then computed exactly, as for every policy: only learning is random.

Source: Fu et al. (2019), section "Experimental Procedure" and table "results_dqn".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import torch

from lcrl_bench.benchmarks.compiled import CompiledTasks
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.outcome import Outcome, outcomes_of
from lcrl_bench.evaluation.problems import Problem
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.solve import solve_seeded
from lcrl_bench.mdp.policy_outcome import follow
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.methods.observed_house import ask

TASKS_AT_ONCE = 128
"""Agents that learn side by side: bounds memory at about 150 MB with default settings."""


@dataclass(frozen=True, eq=False)
class _Part:
    """Tasks of one kind in one house, what is paid in them, and their seeds."""

    tasks: CompiledTasks
    reward: torch.Tensor
    seeds: torch.Tensor


def sample_tasks(
    problems: Sequence[Problem], per_split: int, generator: torch.Generator
) -> tuple[str, ...]:
    """Draw tasks of every split, without replacement.

    Args:
        problems: The houses and their tasks.
        per_split: How many of each split; all of a split that has fewer.
        generator: A CPU generator: its seed names the subset.

    Returns:
        Ids, in the order of the houses.

    Raises:
        UsageError: If `per_split` is below 1.
    """
    if per_split < 1:
        raise UsageError(f"A subset has at least 1 task of each split, found {per_split}.")
    every = [
        task for problem in problems for tasks in problem.compiled.sets for task in tasks.tasks
    ]
    drawn: set[str] = set()
    for split in Split:
        ids = [task.id for task in every if task.split == split]
        order = torch.randperm(len(ids), generator=generator)[:per_split]
        drawn.update(ids[k] for k in order.tolist())
    return tuple(task.id for task in every if task.id in drawn)


def evaluate_with_dqn(
    learned: Reward | Policy,
    problems: Sequence[Problem],
    config: DqnConfig,
    *,
    generator: torch.Generator,
    chosen: Collection[str] | None = None,
    progress: Callable[[int, int], None] = lambda _done, _total: None,
) -> tuple[Outcome, ...]:
    """Re-optimise a reward by DQN, and evaluate the greedy policies exactly.

    What comes of a task does not depend on which others are chosen.

    Args:
        learned: The reward.
        problems: The houses and their tasks.
        config: Settings of the agents.
        generator: A CPU generator: a seed is drawn for every task, chosen or not.
        chosen: Ids of the tasks to solve; None for all.
        progress: Told how many steps of learning are done, of all.

    Raises:
        UsageError: If `learned` is a policy, or no task is chosen.
    """
    if isinstance(learned, Policy):
        reason = "A policy acts as it is: there is no reward that DQN could optimise."
        raise UsageError(f"{reason} Evaluate it without an optimizer.")
    parts = _score(learned, problems, generator, chosen)
    if not parts:
        raise UsageError("No task of this benchmark is chosen: there is nothing to solve by DQN.")
    groups = _groups(parts)
    outcomes: list[Outcome] = []
    for number, group in enumerate(groups):

        def tell(done: int, rounds: int, before: int = number) -> None:
            progress(before * rounds + done, len(groups) * rounds)

        policies = solve_seeded(
            [part.tasks.batch for part in group],
            [part.reward for part in group],
            config,
            seeds=torch.cat([part.seeds for part in group]),
            progress=tell,
        )
        for part, policy in zip(group, policies, strict=True):
            journey = follow(part.tasks.batch, policy.double(), waypoint=part.tasks.held)
            outcomes += outcomes_of(part.tasks, journey)
    return tuple(outcomes)


def _score(
    learned: Reward,
    problems: Sequence[Problem],
    generator: torch.Generator,
    chosen: Collection[str] | None,
) -> list[_Part]:
    """Score the chosen tasks, and give each the seed of its place among all."""
    wanted = None if chosen is None else set(chosen)
    parts = []
    for problem in problems:
        chosen_parts = []
        for tasks in problem.parts:
            seeds = torch.randint(1 << 62, (len(tasks.tasks),), generator=generator)
            kept = [k for k, t in enumerate(tasks.tasks) if wanted is None or t.id in wanted]
            if kept:
                chosen_parts.append((tasks.rows(kept), seeds[kept]))
        if not chosen_parts:
            continue
        commands = [[task.command for task in some.tasks] for some, _ in chosen_parts]
        answers = ask(learned, problem.observed, [c for row in commands for c in row])
        for (some, seeds), row in zip(chosen_parts, commands, strict=True):
            parts.append(_Part(some, answers.reward(some.panoramas, row), seeds))
    return parts


def _groups(parts: Sequence[_Part]) -> list[list[_Part]]:
    """Consecutive parts, of about `TASKS_AT_ONCE` tasks."""
    groups: list[list[_Part]] = [[]]
    for part in parts:
        size = sum(len(other.tasks.tasks) for other in groups[-1])
        if groups[-1] and size + len(part.tasks.tasks) > TASKS_AT_ONCE:
            groups.append([])
        groups[-1].append(part)
    return groups
