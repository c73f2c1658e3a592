"""Which episodes of a run are recorded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal, get_args

from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.recording.rollout import SOLVED, choose_showcase

Selection = Literal["none", "showcase", "first", "failures", "all"]
SELECTIONS: Final[tuple[Selection, ...]] = get_args(Selection)
MOST_FAILURES: Final = 20
"""Failures recorded of a run."""


def choose(selection: Selection, outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """The outcomes of the tasks that a selection records.

    Args:
        selection: `"showcase"`: a NAV success, a PICK success and a failure; `"first"`: the first
            task of each split and kind; `"failures"`: see `choose_failures`; `"all"`; `"none"`.
        outcomes: Of all tasks, in order.
    """
    if selection == "showcase":
        return choose_showcase(outcomes)
    if selection == "first":
        return choose_first(outcomes)
    if selection == "failures":
        return choose_failures(outcomes)
    return tuple(outcomes) if selection == "all" else ()


def choose_first(outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """The first task of each split and kind, whatever came of it."""
    first: dict[tuple[Split, Kind], Outcome] = {}
    for outcome in outcomes:
        first.setdefault((outcome.task.split, outcome.task.kind), outcome)
    return tuple(first[split, kind] for split in Split for kind in Kind if (split, kind) in first)


def choose_failures(
    outcomes: Sequence[Outcome], *, most: int = MOST_FAILURES
) -> tuple[Outcome, ...]:
    """Tasks that failed, spread evenly over splits, kinds and ways to fail.

    Of each split, kind and likeliest way to fail one is taken in turn, the shortest task first,
    until none is left or there are enough.

    Args:
        outcomes: Of all tasks.
        most: How many are enough.
    """
    groups: dict[tuple[Split, Kind, Failure | None], list[Outcome]] = {}
    for outcome in outcomes:
        if outcome.success < SOLVED:
            key = (outcome.task.split, outcome.task.kind, likeliest_failure(outcome))
            groups.setdefault(key, []).append(outcome)
    queues = [sorted(group, key=_shortest_first) for group in groups.values()]
    rounds = max(map(len, queues), default=0)
    turns = [queue[turn] for turn in range(rounds) for queue in queues if turn < len(queue)]
    return tuple(turns[:most])


def likeliest_failure(outcome: Outcome) -> Failure | None:
    """The way in which a PICK task fails most often; None for NAV."""
    if not outcome.failures:
        return None
    return max(Failure, key=lambda failure: outcome.failures.get(failure, 0.0))


def _shortest_first(outcome: Outcome) -> tuple[int, str]:
    return outcome.task.proof.optimal_length, outcome.task.id
