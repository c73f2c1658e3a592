"""`Results`: per-task results of one or more seeds of a method, and all tables made from them.

A value is a number per run and task; a figure is a mean in percent. All tables, files, pages and
pictures take their figures from here. Intervals are over houses and seeds: houses are resampled
first, then tasks within them, then whole runs (see `evaluation.intervals`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind, Split, Task
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.figure import COLUMNS, FAILURES, MEASURES, Figure, language_value
from lcrl_bench.evaluation.intervals import CONFIDENCE, REPLICATES, mean, stratified_bootstrap
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.evaluation.table import Tabled
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.registry import import_target

DIGITS: Final = 4
"""Decimals of a percentage: enough to compare, few enough to read."""
TABLES: Final = ("splits", "measures", "failures", "language")
"""The tables of a run; see `Results.tables`."""
BOOTSTRAP_SEED: Final = 0
"""Seed of the bootstrap: intervals are reproducible."""

SplitTable = dict[str, dict[str, float | int | None]]
"""Split -> `{"pick", "nav", "total"}` in percent, None if there is no such task, and `"n"`, the
number of tasks."""


class TaskRow(NamedTuple):
    """Facts about a task that don't depend on the evaluation."""

    task: str
    """Its id."""
    split: str
    kind: str
    house: str
    command: str
    optimal_length: int
    random_success: float

    @classmethod
    def of(cls, task: Task) -> TaskRow:
        """The facts about a task."""
        return cls(
            task.id,
            task.split.value,
            task.kind.value,
            task.house,
            task.command,
            task.proof.optimal_length,
            task.proof.random_success,
        )


@dataclass(frozen=True, eq=False, repr=False)
class Results(Tabled):
    """Results of one or more seeds of a method on the same tasks.

    Example:
        >>> quick = {"passes": 1, "least_steps": 1}
        >>> results = lcrl_bench.run("lcrl", "mini", settings=quick, progress=False)
        >>> results.seeds, len(results.to_pandas())
        ((0,), 237)
        >>> results.beside["optimal"].figure("test-house", "total").mean
        100.0
    """

    method: str
    seeds: tuple[int, ...]
    rows: tuple[TaskRow, ...]
    """The tasks, sorted by id."""
    values: Mapping[str, NDArray[np.float64]]
    """Name -> float64 [run, task]; NaN for tasks without that value: `"success"`, the others of
    `MEASURES` and `FAILURES`, and `"success_<control>"` under each language control."""
    optimized: Mapping[str, Results] = field(default_factory=dict)
    """Results of other optimizers on the same rewards, by row name."""
    beside: Mapping[str, Results] = field(default_factory=dict)
    """The benchmark's controls, by name."""
    learned: tuple[Reward | Policy, ...] = field(default=(), repr=False)
    """What each seed learned; empty if it was not kept."""

    def __repr__(self) -> str:
        """The method, its seeds and the number of tasks; `print` shows the table."""
        seeds = ", ".join(map(str, self.seeds))
        return f"Results({self.method}: seeds {seeds}; {len(self.rows)} tasks)"

    @classmethod
    def of(
        cls,
        method: str,
        seed: int,
        outcomes: Iterable[Outcome],
        *,
        language: Mapping[str, Sequence[Outcome]] | None = None,
    ) -> Results:
        """The results of one run.

        Args:
            method: Name of the row.
            seed: Of the run.
            outcomes: Of the tasks' own commands.
            language: Control -> outcomes under its sentences, of some of the tasks.
        """
        ordered = sorted(outcomes, key=lambda outcome: outcome.task.id)
        values = {
            "success": [outcome.success for outcome in ordered],
            "final_success": [outcome.final_success for outcome in ordered],
            "path_weighted": [outcome.path_weighted for outcome in ordered],
            "regret": [outcome.regret for outcome in ordered],
        }
        for failure in Failure:
            name = FAILURES[failure.value]
            values[name] = [outcome.failures.get(failure, math.nan) for outcome in ordered]
        for control, others in (language or {}).items():
            found = {outcome.task.id: outcome.success for outcome in others}
            name = language_value(control)
            values[name] = [found.get(outcome.task.id, math.nan) for outcome in ordered]
        arrays = {name: np.array([row], np.float64) for name, row in values.items()}
        return cls(method, (seed,), tuple(TaskRow.of(outcome.task) for outcome in ordered), arrays)

    @classmethod
    def join(cls, runs: Sequence[Results]) -> Results:
        """Combine the results of several seeds.

        Raises:
            UsageError: If there are none, or their tasks differ.
        """
        if not runs:
            raise UsageError("There are no results to join: give at least one run.")
        first = runs[0]
        if other := next((run for run in runs if run.rows != first.rows), None):
            raise UsageError(f"Seeds {first.seeds} and {other.seeds} are about different tasks.")
        names = [name for name in first.values if all(name in run.values for run in runs)]
        values = {name: np.concatenate([run.values[name] for run in runs]) for name in names}
        seeds = tuple(seed for run in runs for seed in run.seeds)
        learned = tuple(each for run in runs for each in run.learned)
        return replace(first, seeds=seeds, values=values, learned=learned)

    @classmethod
    def read(cls, method: str, files: Mapping[int, Path]) -> Results:
        """The results of finished runs, from their `episodes.parquet`.

        Args:
            method: Name of the row.
            files: Seed -> file.

        Raises:
            InvalidFileError: If a file can't be read, or has other tasks than the first.
        """
        runs = [_read(method, seed, file) for seed, file in files.items()]
        for file, run in zip(files.values(), runs, strict=True):
            if [row.task for row in run.rows] != [row.task for row in runs[0].rows]:
                reason = f"its tasks are not those of {next(iter(files.values()))}"
                raise InvalidFileError(file, reason, fix="Delete the run's folder and run again.")
        return cls.join(runs)

    def write(self, path: Path) -> None:
        """Write the results of one run as a parquet file, one row per task.

        Columns: the task; what is measured of it; its proof; success under language controls.
        """
        known = {name: [getattr(row, name) for row in self.rows] for name in TaskRow._fields}
        found = {
            name: [None if math.isnan(value) else value for value in values[0].tolist()]
            for name, values in self.values.items()
        }
        told = {language_value(control) for control in self.controls}
        measured = [name for name in found if name not in told]
        names = [*TaskRow._fields[:5], *measured, *TaskRow._fields[5:]]
        names += [name for name in found if name in told]
        pq.write_table(pa.table({name: {**known, **found}[name] for name in names}), path)

    def outcomes(self, tasks: Iterable[Task]) -> tuple[Outcome, ...]:
        """Outcomes of some tasks in the first run, in the order given."""
        place = {row.task: k for k, row in enumerate(self.rows)}
        return tuple(self._outcome(task, place[task.id]) for task in tasks)

    def _outcome(self, task: Task, k: int) -> Outcome:
        values = {name: float(found[0, k]) for name, found in self.values.items()}
        shares = {failure: values[FAILURES[failure.value]] for failure in Failure}
        return Outcome(
            task,
            *(values[name] for name in MEASURES.values()),
            failures={} if task.kind == Kind.NAV else shares,
        )

    def record(self, task: Task, path: str | Path, *, seed: int | None = None) -> Path:
        """Record what a seed does in a task as a Rerun recording; view it with `lcrl-bench view`.

        Args:
            task: A task of `load_benchmark(...).tasks`.
            path: Ends in `.rrd`.
            seed: Which of `seeds`; None is the first.

        Raises:
            UsageError: If what the seed learned was not kept, or `path` has another suffix.
        """
        seed = self.seeds[0] if seed is None else seed
        if not self.learned or seed not in self.seeds:
            kept = ", ".join(map(str, self.seeds)) if self.learned else "none"
            raise UsageError(f"What seed {seed} learned is not in these results; kept: {kept}.")
        learned = self.learned[self.seeds.index(seed)]
        record = import_target("lcrl_bench.recording.drawings:record_task")
        return record(Path(path), learned, task, method=self.method, seed=seed)

    def to_pandas(self) -> Any:  # noqa: ANN401 - pandas is imported when it is asked for
        """A pandas table with one row per task and seed, and one column per value."""
        import pandas

        parts = []
        for run, seed in enumerate(self.seeds):
            columns = {name: found[run] for name, found in self.values.items()}
            parts.append(pandas.DataFrame(self.rows).assign(seed=seed, **columns))
        return pandas.concat(parts, ignore_index=True)

    def figure(self, split: str, column: str, value: str = "success") -> Figure | None:
        """The mean of a value over tasks of a split and kind and over seeds, without interval.

        Args:
            split: `"train"`, `"test-task"` or `"test-house"`.
            column: `"pick"`, `"nav"` or `"total"`.
            value: A name in `values`.

        Returns:
            None if there is no such task.
        """
        chosen = self._chosen(split, column)
        seeds = [_percentage(run[chosen]) for run in self.values[value]]
        found = [seed for seed in seeds if seed is not None]
        if not found:
            return None
        return Figure(_rounded(math.fsum(found) / len(found)), n=len(self.seeds) * len(chosen))

    def estimate(self, split: str, column: str) -> Figure | None:
        """Mean success with its 95 % interval; None if there is no such task."""
        chosen = self._chosen(split, column)
        if not len(chosen):
            return None
        success = self.values["success"][:, chosen]
        return _estimate(success, self._houses(chosen), clip=True)

    def difference(self, other: Results, split: str, column: str) -> Figure | None:
        """Mean success minus another's, in percentage points, over the tasks that both have.

        The difference is taken per task and seed before resampling, so that the difficulty of tasks
        cancels. Runs are paired in order as far as both go; a single run is compared with each.
        None if no task is shared.
        """
        there = {row.task: k for k, row in enumerate(other.rows)}
        mine = [k for k in self._chosen(split, column) if self.rows[k].task in there]
        if not mine:
            return None
        theirs = [there[self.rows[k].task] for k in mine]
        first, second = self.values["success"][:, mine], other.values["success"][:, theirs]
        runs = min(len(first), len(second))
        if runs > 1:
            first, second = first[:runs], second[:runs]
        return _estimate(first - second, self._houses(mine))

    @cached_property
    def controls(self) -> tuple[str, ...]:
        """The language controls that were evaluated."""
        prefix = language_value("")
        names = [name.removeprefix(prefix) for name in self.values if name.startswith(prefix)]
        return tuple(name.replace("_", "-") for name in names)

    def splits(self, value: str = "success") -> SplitTable:
        """One value by split and kind."""
        return {
            split.value: {
                **{column: self._mean(split, column, value) for column in COLUMNS},
                "n": self._count(split, value),
            }
            for split in Split
        }

    def total(self) -> float | None:
        """Mean success over the tasks of all splits, in percent."""
        seeds = [_percentage(run) for run in self.values["success"]]
        found = [seed for seed in seeds if seed is not None]
        return _rounded(math.fsum(found) / len(found)) if found else None

    def tables(self) -> dict[str, Any]:
        """All tables as JSON, each a mean over seeds.

        Returns:
            `"splits"`: success, a `SplitTable`. `"measures"`: split -> measure -> kind -> percent;
            a regret of 0 is optimal, 100 is as good as random. `"failures"`: split -> failure ->
            percent of the split's PICK tasks; with success they sum to 100. `"language"`:
            control -> `SplitTable`.
        """
        return {
            "splits": self.splits(),
            "measures": {
                split.value: {
                    name: {column: self._mean(split, column, value) for column in COLUMNS}
                    for name, value in MEASURES.items()
                }
                for split in Split
            },
            "failures": {
                split.value: {
                    name: self._mean(split, "pick", value) for name, value in FAILURES.items()
                }
                for split in Split
            },
            "language": {name: self.splits(language_value(name)) for name in self.controls},
        }

    def seed_tables(self) -> dict[int, dict[str, Any]]:
        """`tables` per seed."""
        return {seed: self.seed(seed).tables() for seed in self.seeds}

    def seed(self, seed: int) -> Results:
        """The results of one seed."""
        run = self.seeds.index(seed)
        values = {name: found[run : run + 1] for name, found in self.values.items()}
        return replace(self, seeds=(seed,), values=values)

    def figures(self) -> dict[str, dict[str, Figure | None]]:
        """Success with its intervals: split -> kind -> figure."""
        return {
            split.value: {column: self.estimate(split, column) for column in COLUMNS}
            for split in Split
        }

    def _mean(self, split: str, column: str, value: str) -> float | None:
        found = self.figure(split, column, value)
        return None if found is None else found.mean

    def _count(self, split: str, value: str) -> int:
        chosen = self._chosen(split, "total")
        return int((~np.isnan(self.values[value][0, chosen])).sum())

    def _chosen(self, split: str, column: str) -> list[int]:
        """The tasks in a column of a split."""
        kinds = set(Kind) if column == "total" else {column}
        return [k for k, row in enumerate(self.rows) if row.split == split and row.kind in kinds]

    def _houses(self, chosen: Sequence[int]) -> list[str]:
        return [self.rows[k].house for k in chosen]


def _read(method: str, seed: int, file: Path) -> Results:
    try:
        table = pq.read_table(file).sort_by("task")
        columns = table.to_pydict()
        rows = tuple(map(TaskRow, *(columns[name] for name in TaskRow._fields)))
        others = [name for name in table.column_names if name not in TaskRow._fields]
        values = {name: np.array([columns[name]], np.float64) for name in others}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InvalidFileError(file, f"can't be read: {error}", fix="Run it again.") from error
    return Results(method, (seed,), rows, values)


def _percentage(values: NDArray[np.float64]) -> float | None:
    """The mean of the values that are not NaN, in percent; None if there are none.

    `math.fsum` makes it independent of the order of tasks.
    """
    known = values[~np.isnan(values)].tolist()
    return _rounded(100 * math.fsum(known) / len(known)) if known else None


def _rounded(value: float) -> float:
    return round(value, DIGITS)


def _estimate(values: NDArray[np.float64], houses: Sequence[str], *, clip: bool = False) -> Figure:
    interval = stratified_bootstrap(
        values,
        mean,
        rng=np.random.default_rng(BOOTSTRAP_SEED),
        replicates=REPLICATES,
        confidence=CONFIDENCE,
        clusters=houses,
        shared_runs=True,
    )
    found = [float(100 * x) for x in (values.mean(), interval.low, interval.high)]
    # A sum of fractions may exceed 1 by rounding.
    bounded = [min(max(x, 0.0), 100.0) if clip else x for x in found]
    return Figure(*map(_rounded, bounded), n=values.size)
