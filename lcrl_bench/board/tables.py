"""The tables of a submission: the same from the files of its runs and from re-running it.

Figures are in per cent, rounded to the decimals of a summary.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.outcome import Outcome
from lcrl_bench.evaluation.reproduction.scores import Scores, estimate
from lcrl_bench.evaluation.summary import (
    DIGITS,
    KINDS,
    failure_table,
    mean_table,
    measure_table,
    split_table,
)

OF_A_SEED: Final = ("splits", "measures", "failures", "language")
"""The tables of each seed."""


def seed_tables(
    outcomes: Sequence[Outcome], language: Mapping[str, Sequence[Outcome]]
) -> dict[str, Any]:
    """The tables of one seed, from the outcomes of its tasks under the true and other commands."""
    return {
        "splits": split_table(outcomes),
        "measures": measure_table(outcomes),
        "failures": failure_table(outcomes),
        "language": {name: split_table(rows) for name, rows in language.items()},
    }


def shared_tables(seeds: Sequence[Mapping[str, Any]], scores: Scores) -> dict[str, Any]:
    """The tables over all seeds: means, and success with its intervals.

    Args:
        seeds: The tables of each seed.
        scores: Success of each seed in each task.
    """
    means = {key: mean_table([row[key] for row in seeds]) for key in OF_A_SEED if key != "splits"}
    return {"figures": _figures(scores), **means}


def scores_of(runs: Sequence[Sequence[Outcome]]) -> Scores:
    """Success of each seed in each task, in the order of task ids."""
    ordered = [sorted(outcomes, key=lambda outcome: outcome.task.id) for outcomes in runs]
    tasks = [outcome.task for outcome in ordered[0]]
    return Scores(
        np.array([[outcome.success for outcome in row] for row in ordered], dtype=np.float64),
        tasks=tuple(task.id for task in tasks),
        houses=tuple(task.house for task in tasks),
        splits=tuple(task.split.value for task in tasks),
        kinds=tuple(task.kind.value for task in tasks),
    )


def _figures(scores: Scores) -> dict[str, Any]:
    return {
        split.value: {column: _figure(scores.column(f"{split.value}.{column}")) for column in KINDS}
        for split in Split
    }


def _figure(scores: Scores) -> dict[str, float | int] | None:
    found = estimate(scores)
    if found is None:
        return None
    bounds = {"mean": found.mean, "low": found.low, "high": found.high}
    # A sum of shares may exceed one by a rounding.
    rounded = {key: round(min(max(value, 0.0), 100.0), DIGITS) for key, value in bounds.items()}
    return {**rounded, "n": scores.success.size}
