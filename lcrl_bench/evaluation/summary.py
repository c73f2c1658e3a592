"""Outcomes folded into tables by split and kind, in per cent.

Every figure is a mean over tasks. `docs/metrics.md` says what each one is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.evaluation.reproduction.scores import Scores, estimate, read_scores

DIGITS = 4
"""Decimals of a percentage in a summary: enough to compare, few enough to read."""


KINDS: dict[str, frozenset[Kind]] = {
    "pick": frozenset({Kind.PICK}),
    "nav": frozenset({Kind.NAV}),
    "total": frozenset(Kind),
}
"""The columns of a split."""

MEASURES: dict[str, Callable[[Outcome], float]] = {
    "success": lambda outcome: outcome.success,
    "final": lambda outcome: outcome.final_success,
    "path_weighted": lambda outcome: outcome.path_weighted,
    "regret": lambda outcome: outcome.regret,
}
"""What is measured of every task."""


def split_table(outcomes: Iterable[Outcome]) -> dict[str, dict[str, float | int | None]]:
    """Success by split and kind.

    Returns:
        Split → `{"pick", "nav", "total"}` in per cent (None where the split has no such task) and
        `"n"`, the number of tasks.
    """
    table: dict[str, dict[str, float | int | None]] = {}
    for split, rows in _by_split(outcomes).items():
        table[split] = {**_columns(rows, MEASURES["success"]), "n": len(rows)}
    return table


def measure_table(outcomes: Iterable[Outcome]) -> dict[str, dict[str, dict[str, float | None]]]:
    """All measures by split and kind.

    Returns:
        Split → measure → `{"pick", "nav", "total"}` in per cent, None where there is no such task.
        A regret of 0 is optimal, of 100 as good as random.
    """
    return {
        split: {name: _columns(rows, measure) for name, measure in MEASURES.items()}
        for split, rows in _by_split(outcomes).items()
    }


def failure_table(outcomes: Iterable[Outcome]) -> dict[str, dict[str, float | None]]:
    """How PICK tasks fail, by split.

    Returns:
        Split → failure → per cent of the split's PICK tasks; with success they make 100.
    """
    return {
        split: {
            failure.value: percentage(
                row.failures[failure] for row in rows if row.task.kind == Kind.PICK
            )
            for failure in Failure
        }
        for split, rows in _by_split(outcomes).items()
    }


def _by_split(outcomes: Iterable[Outcome]) -> dict[str, list[Outcome]]:
    every = list(outcomes)
    return {split.value: [row for row in every if row.task.split == split] for split in Split}


def _columns(
    rows: Sequence[Outcome], measure: Callable[[Outcome], float]
) -> dict[str, float | None]:
    return {
        column: percentage(measure(row) for row in rows if row.task.kind in kinds)
        for column, kinds in KINDS.items()
    }


def percentage(successes: Iterable[float]) -> float | None:
    """Mean success in per cent; None for no task.

    `math.fsum` makes the mean independent of the order of the tasks.
    """
    values = list(successes)
    return round(100 * math.fsum(values) / len(values), DIGITS) if values else None


def mean_table(tables: Sequence[Any]) -> Any:  # noqa: ANN401 - a table of any depth
    """The mean over seeds of tables of the same tasks, figure by figure; counts stay counts."""
    first = tables[0]
    if isinstance(first, Mapping):
        return {key: mean_table([table[key] for table in tables]) for key in first}
    if isinstance(first, int):
        return first
    known = [value for value in tables if value is not None]
    return round(math.fsum(known) / len(known), DIGITS) if known else None


def interval_table(episodes: Sequence[Path]) -> dict[str, dict[str, list[float] | None]]:
    """The 95 % intervals of success, for new houses and new seeds.

    Args:
        episodes: `episodes.parquet` of the runs of each seed.

    Returns:
        Split → `{"pick", "nav", "total"}`: [low, high] in per cent, None where there is no task.
        A single seed's interval is about new houses alone.
    """
    scores = read_scores(episodes)
    return {
        split.value: {column: _bounds(scores, f"{split.value}.{column}") for column in KINDS}
        for split in Split
    }


def _bounds(scores: Scores, column: str) -> list[float] | None:
    found = estimate(scores.column(column))
    return None if found is None else [round(found.low, DIGITS), round(found.high, DIGITS)]
