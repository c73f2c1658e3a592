"""Scores of finished runs, task by task, and what is said of them: means, intervals, differences.

Every interval is about new houses and new seeds: houses are resampled first, then tasks in them,
then whole runs (see `evaluation.intervals`). A difference of two rows is taken task by task and
seed by seed before it is resampled, so that what both rows find hard or easy cancels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow.parquet as pq
from numpy.typing import NDArray

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.evaluation.intervals import CONFIDENCE, REPLICATES, mean, stratified_bootstrap

BOOTSTRAP_SEED: Final = 0
"""Intervals are the same each time a table is written."""
TOTAL: Final = "total"


@dataclass(frozen=True)
class Estimate:
    """A mean in per cent with its interval."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Scores:
    """What the runs of a row achieved."""

    success: NDArray[np.float64]
    """float [run, task], 0 .. 1."""
    tasks: tuple[str, ...]
    """Ids, in order."""
    houses: tuple[str, ...]
    """The house of each task."""
    splits: tuple[str, ...]
    kinds: tuple[str, ...]

    def column(self, name: str) -> Scores:
        """The tasks of a column, `<split>.<pick|nav|total>`."""
        split, _, kind = name.partition(".")
        rows = [
            row
            for row in range(len(self.tasks))
            if self.splits[row] == split and kind in (TOTAL, self.kinds[row])
        ]
        return self._rows(rows)

    def shared_with(self, other: Scores) -> Scores:
        """The tasks that the other has scores of too."""
        known = set(other.tasks)
        return self._rows([row for row, task in enumerate(self.tasks) if task in known])

    def _rows(self, rows: Sequence[int]) -> Scores:
        return Scores(
            self.success[:, rows],
            *(
                tuple(values[row] for row in rows)
                for values in (self.tasks, self.houses, self.splits, self.kinds)
            ),
        )


def read_scores(files: Sequence[Path]) -> Scores:
    """The scores of runs of one row, from their `episodes.parquet`, in the order of task ids.

    Raises:
        InvalidFileError: If a file can't be read, or is about other tasks than the first.
    """
    tables = [_read(file) for file in files]
    tasks = tables[0]["task"]
    for file, table in zip(files, tables, strict=True):
        if table["task"] != tasks:
            reason = f"its tasks are not those of {files[0]}"
            raise InvalidFileError(file, reason, fix="Delete the run's folder and run it again.")
    return Scores(
        np.array([table["success"] for table in tables], dtype=np.float64),
        *(tuple(tables[0][column]) for column in ("task", "house", "split", "kind")),
    )


def _read(file: Path) -> dict[str, list[Any]]:
    try:
        table = pq.read_table(file, columns=["task", "house", "split", "kind", "success"])
    except (OSError, ValueError) as error:
        raise InvalidFileError(file, f"can't be read: {error}", fix="Run it again.") from error
    return table.sort_by("task").to_pydict()


def estimate(scores: Scores) -> Estimate | None:
    """Mean success in per cent over runs and tasks, with its interval; None for no task."""
    if not scores.tasks:
        return None
    return _estimate(scores.success, scores.houses)


def difference(first: Scores, second: Scores) -> Estimate | None:
    """Mean of first minus second in points of per cent, over the tasks that both have.

    Runs are paired in order, as far as both go; a row without seeds is the same against each.
    None where no task is shared.
    """
    first, second = first.shared_with(second), second.shared_with(first)
    if not first.tasks:
        return None
    runs = min(len(scores.success) for scores in (first, second))
    if runs == 1:
        return _estimate(first.success - second.success, first.houses)
    return _estimate(first.success[:runs] - second.success[:runs], first.houses)


def _estimate(values: NDArray[np.float64], houses: Sequence[str]) -> Estimate:
    interval = stratified_bootstrap(
        values,
        mean,
        rng=np.random.default_rng(BOOTSTRAP_SEED),
        replicates=REPLICATES,
        confidence=CONFIDENCE,
        clusters=houses,
        shared_runs=True,
    )
    return Estimate(*(float(100 * x) for x in (values.mean(), interval.low, interval.high)))
