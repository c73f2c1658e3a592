"""`Outcome`: all measures of one task, computed exactly from a policy's outcome.

Letters: l optimal length, t step of the first arrival, H horizon, J expected true return.

    success        P(the goal predicate holds at some step t <= H)
    final success  P(it holds at step H)
    path-weighted  E[S l / max(t, l)], S = 1 if the goal is met, else 0
    regret         (J* - J) / (J* - J_random): 0 is optimal, 1 is random, more is worse than random

Lengths count actions, including turns and interactions: *path-weighted* is SPL in actions, not the
published SPL in metres. Returns are discounted sums over the whole episode, so regret also
penalises arriving late and leaving again.

Source: Anderson et al., "On Evaluation of Embodied Navigation Agents" (2018), for SPL.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import torch

from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.dynamics import spread_cells
from lcrl_bench.mdp.policy_outcome import PolicyOutcome
from lcrl_bench.mdp.task_batch import HEADINGS, OBJECT_STATES, ObjectState, TaskBatch

ROUNDING = 1e-9
"""Tolerance for probabilities that should be zero."""


class Failure(StrEnum):
    """How an unsolved PICK task ends: each failed episode is exactly one of these."""

    WAITS_AT_A = "waits_at_a"
    """Never took the object, and ends where it could have taken it."""
    AT_B_WITHOUT_OBJECT = "at_b_without_object"
    """Never took the object, and ends at its destination."""
    ELSEWHERE = "elsewhere"
    """Never took the object, and ends somewhere else."""
    PUT_BACK = "put_back"
    """Took the object, and put it back."""
    HELD_AT_B = "held_at_b"
    """Ends at the destination, still holding the object."""
    HELD_ELSEWHERE = "held_elsewhere"
    """Ends somewhere else, still holding the object."""


NEVER_PICKED = (Failure.WAITS_AT_A, Failure.AT_B_WITHOUT_OBJECT, Failure.ELSEWHERE)
"""The failures in which the object was never taken."""


@dataclass(frozen=True)
class Outcome:
    """The measures of one task."""

    task: Task
    success: float
    """Probability that the goal predicate holds at some step within the horizon."""
    final_success: float
    """Probability that it holds at the last step."""
    path_weighted: float
    """Expected success weighted by optimal over actual length in actions; at most success."""
    regret: float
    """Normalised regret: 0 for the optimal return, 1 for the random one."""
    failures: Mapping[Failure, float]
    """PICK: probability of each failure, summing to 1 - success; empty for NAV."""


def outcomes_of(tasks: TaskSet, outcome: PolicyOutcome) -> list[Outcome]:
    """The outcome of each task.

    Args:
        tasks: Tasks of one kind in one house.
        outcome: The outcome of following a policy in `tasks`, with `waypoint=tasks.held`.

    Raises:
        ValueError: If the outcome doesn't track whether the object was ever held.
    """
    lengths = torch.tensor([task.proof.optimal_length for task in tasks.tasks])
    lengths = lengths.to(tasks.start.device)
    best, floor = best_goal_value(tasks, lengths), tasks.random_goal_value
    gap = best - floor
    # If random actions do as well as the optimum, there is no regret.
    regret = torch.where(gap > 0, (best - outcome.goal_value) / gap, 0.0)
    columns = {
        "success": outcome.success,
        "final_success": (outcome.final * spread_cells(tasks.goal)).sum(-1).clamp(0.0, 1.0),
        "path_weighted": _path_weighted(outcome.arrival, lengths),
        "regret": regret,
    }
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    failures = failure_shares(tasks, outcome) if tasks.kind == Kind.PICK else None
    return [
        Outcome(task, *row, failures={} if failures is None else failures[k])
        for k, (task, row) in enumerate(zip(tasks.tasks, rows, strict=True))
    ]


def best_goal_value(batch: TaskBatch, lengths: torch.Tensor) -> torch.Tensor:
    """J* in units of the success reward: arrive at step l and stay.

    Args:
        batch: The tasks.
        lengths: int64 [task]: l, for tasks whose goal can be stayed in.

    Returns:
        float64 [task]: sum_{t=l..H} gamma^t.
    """
    steps = torch.arange(batch.horizon + 1, device=lengths.device)
    weights = batch.discount ** steps.double()
    return (weights * (steps >= lengths[:, None])).sum(-1)


def failure_shares(tasks: TaskSet, outcome: PolicyOutcome) -> list[dict[Failure, float]]:
    """Probability of each failure for each PICK task; they sum to 1 - success.

    Raises:
        ValueError: If the outcome doesn't track whether the object was ever held.
    """
    at_a, at_b = tasks.object_tiles, tasks.target_tiles
    lost = _by_place(outcome.lost)
    untouched = _by_place(outcome.missed)
    if bool((untouched[:, ObjectState.HELD].sum(-1) > ROUNDING).any()):
        raise ValueError("the outcome was not followed with waypoint=tasks.held")
    never = untouched[:, ObjectState.AT_A]
    held = lost[:, ObjectState.HELD]
    shares = {
        Failure.WAITS_AT_A: never * at_a,
        Failure.AT_B_WITHOUT_OBJECT: never * (at_b & ~at_a),
        Failure.ELSEWHERE: never * ~(at_a | at_b),
        Failure.PUT_BACK: lost[:, ObjectState.AT_A] - never,
        Failure.HELD_AT_B: held * at_b,
        Failure.HELD_ELSEWHERE: held * ~at_b,
    }
    columns = [share.sum(-1).clamp(0.0, 1.0).tolist() for share in shares.values()]
    return [dict(zip(shares, row, strict=True)) for row in zip(*columns, strict=True)]


def _path_weighted(arrival: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
    """E[S l / max(t, l)]: float64 [task]; S if the start is the goal."""
    steps = torch.arange(arrival.shape[1], device=arrival.device)
    longest = torch.maximum(steps, lengths[:, None])
    # Integers divide in single precision by default.
    ratio = torch.where(longest > 0, lengths[:, None].double() / longest, 1.0)
    return (arrival * ratio).sum(-1).clamp(0.0, 1.0)


def _by_place(mass: torch.Tensor) -> torch.Tensor:
    """Fold states of PICK tasks: [task, state] -> [task, object state, tile]."""
    return mass.view(len(mass), OBJECT_STATES, -1, HEADINGS).sum(-1)
