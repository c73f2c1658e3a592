"""Confidence intervals of aggregate scores: the bootstrap over runs, tasks and houses.

A resample is represented by counts: how often each (run, task) score occurs in it. A statistic
takes the scores once and the counts of many resamples, so thousands of them are array arithmetic.

The intervals in the suite's tables are for **new houses**: `stratified_bootstrap` with
`clusters=houses, shared_runs=True`. A resample draws houses with replacement, then as many tasks
from each drawn house as it has, then runs. Tasks of one house are correlated, and so are all tasks
of one run, so resampling single scores would give intervals that are too narrow.

Source: Agarwal et al., "Deep Reinforcement Learning at the Edge of the Statistical Precipice"
(NeurIPS 2021): interquartile mean, stratified percentile bootstrap. Resampling houses first, and
whole runs, is our addition.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import UsageError

CONFIDENCE = 0.95
"""Share of resamples inside an interval."""
REPLICATES = 2_000
"""Number of resamples per interval in the tables."""
TRIMMED = 0.25
"""Share of scores that the interquartile mean drops at each end."""
_AT_ONCE = 200

Statistic = Callable[[NDArray[np.float64], NDArray[np.int64]], NDArray[np.float64]]
"""Scores [item] and how often each occurs [resample, item] -> the statistic of each [resample]."""


@dataclass(frozen=True)
class Interval:
    """A percentile confidence interval."""

    low: float
    high: float


def mean(scores: NDArray[np.float64], counts: NDArray[np.int64]) -> NDArray[np.float64]:
    """The mean of each resample; a `Statistic`."""
    return counts @ scores / counts.sum(-1)


def interquartile_mean(
    scores: NDArray[np.float64], counts: NDArray[np.int64] | None = None
) -> NDArray[np.float64]:
    """The mean of the middle half of all scores, without a quarter at each end; a `Statistic`.

    For graded scores. For outcomes of 0 or 1 the mean is better: with a share p of successes, this
    is `clip((p - 1/4) / (1/2), 0, 1)`, so it hides any change below a quarter or above three
    quarters.

    Args:
        scores: float [...]; flattened, as runs and tasks count equally.
        counts: int [resample, item]; None: each score once.

    Returns:
        float64 [resample]; without `counts` float64 [].
    """
    flat = np.asarray(scores, np.float64).reshape(-1)
    given = np.ones((1, flat.size), np.int64) if counts is None else counts
    order = flat.argsort(kind="stable")
    last = given[:, order].cumsum(-1)
    total = last[:, -1:]
    # Only whole scores are trimmed: a count of 5 loses 1 at each end.
    cut = (TRIMMED * total).astype(np.int64)
    inside = np.clip(last, cut, total - cut)
    kept = np.diff(inside, axis=-1, prepend=cut)
    means = kept @ flat[order] / (total - 2 * cut)[:, 0]
    return means if counts is not None else means[0]


def stratified_bootstrap(
    scores: NDArray[np.float64],
    statistic: Statistic,
    *,
    rng: np.random.Generator,
    replicates: int = REPLICATES,
    confidence: float = CONFIDENCE,
    tasks: bool = False,
    clusters: Sequence[str] | None = None,
    shared_runs: bool = False,
) -> Interval:
    """The percentile interval of a statistic of runs x tasks.

    By default only runs are resampled, with replacement and independently within each task: the
    published interval, for the same tasks under new seeds.

    Args:
        scores: float [run, task].
        statistic: `mean`, `interquartile_mean` or another `Statistic`.
        rng: Source of the resamples.
        replicates: Number of resamples.
        confidence: Share of resamples inside, in (0, 1).
        tasks: Whether to resample tasks too, before their runs.
        clusters: One name per task, such as its house: clusters are resampled first, then their
            tasks, then runs. Implies `tasks`.
        shared_runs: Whether a resample uses the same runs for all tasks, because all scores of a
            run come from one training.

    Raises:
        UsageError: If `scores` is not a finite, non-empty [run, task], `clusters` has another
            length, or a number is out of range.
    """
    matrix = np.asarray(scores, np.float64)
    _check(matrix, clusters, replicates, confidence)
    runs, width = matrix.shape
    groups = _groups(clusters, width) if tasks or clusters is not None else None
    values = [
        statistic(
            matrix.reshape(-1),
            _counts(rng, min(_AT_ONCE, replicates - first), runs, width, groups, shared_runs),
        )
        for first in range(0, replicates, _AT_ONCE)
    ]
    tail = (1 - confidence) / 2
    low, high = np.quantile(np.concatenate(values), [tail, 1 - tail])
    return Interval(float(low), float(high))


@dataclass(frozen=True, eq=False)
class _Groups:
    """Tasks by cluster: cluster k is `members[first[k] : first[k] + size[k]]`."""

    members: NDArray[np.int64]
    first: NDArray[np.int64]
    size: NDArray[np.int64]
    is_one: bool
    """Whether there is a single cluster, so that tasks are drawn from all."""


def _groups(clusters: Sequence[str] | None, width: int) -> _Groups:
    names = np.zeros(width, np.int64) if clusters is None else np.asarray(clusters)
    _, number = np.unique(names, return_inverse=True)
    size = np.bincount(number)
    members = number.argsort(kind="stable")
    return _Groups(members, size.cumsum() - size, size, clusters is None)


def _counts(
    rng: np.random.Generator,
    replicates: int,
    runs: int,
    width: int,
    groups: _Groups | None,
    shared_runs: bool,
) -> NDArray[np.int64]:
    """How often each score occurs in each resample: int64 [resample, run * task]."""
    row, task = _drawn_tasks(rng, replicates, width, groups)
    if shared_runs:
        of_task = _histogram(row, task, replicates, width)
        drawn = rng.integers(runs, size=(replicates, runs))
        of_run = _histogram(np.repeat(np.arange(replicates), runs), drawn.ravel(), replicates, runs)
        return (of_run[:, :, None] * of_task[:, None, :]).reshape(replicates, runs * width)
    drawn = rng.integers(runs, size=(len(task), runs))
    place = (drawn * width + task[:, None]).ravel()
    return _histogram(np.repeat(row, runs), place, replicates, runs * width)


def _drawn_tasks(
    rng: np.random.Generator, replicates: int, width: int, groups: _Groups | None
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The tasks of all resamples, flattened: resample and task of each draw, int64 [draw]."""
    if groups is None:
        every = np.arange(replicates * width)
        return every // width, every % width
    if groups.is_one:
        cluster = np.zeros((replicates, 1), np.int64)
    else:
        cluster = rng.integers(len(groups.size), size=(replicates, len(groups.size)))
    size = groups.size[cluster.ravel()]
    row = np.repeat(np.arange(replicates), size.reshape(replicates, -1).sum(1))
    first = np.repeat(groups.first[cluster.ravel()], size)
    return row, groups.members[first + rng.integers(np.repeat(size, size))]


def _histogram(
    row: NDArray[np.int64], column: NDArray[np.int64], rows: int, columns: int
) -> NDArray[np.int64]:
    flat = np.bincount(row * columns + column, minlength=rows * columns)
    return flat.reshape(rows, columns)


def _check(
    matrix: NDArray[np.float64], clusters: Sequence[str] | None, replicates: int, confidence: float
) -> None:
    if matrix.ndim != 2 or not matrix.size or not np.isfinite(matrix).all():
        found = f"found {list(matrix.shape)}"
        raise UsageError(f"scores must be finite and non-empty [run, task], {found}")
    if clusters is not None and len(clusters) != matrix.shape[1]:
        found = f"found {len(clusters)} for {matrix.shape[1]} tasks"
        raise UsageError(f"clusters must name one cluster per task, {found}")
    if replicates < 1 or not 0 < confidence < 1:
        found = f"found {replicates} and {confidence}"
        raise UsageError(f"replicates must be at least 1, confidence between 0 and 1, {found}")
