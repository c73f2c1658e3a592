"""Intervals: the published definitions, scipy's trimmed mean, and every resample of tiny data."""

import itertools
from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.intervals import (
    Interval,
    interquartile_mean,
    mean,
    stratified_bootstrap,
)

SCORES = st.lists(st.floats(-5, 5), min_size=1, max_size=30)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


@given(SCORES)
def test_the_interquartile_mean_is_scipy_s_trimmed_mean(values):
    expected = stats.trim_mean(np.array(values), proportiontocut=0.25)
    assert interquartile_mean(np.array(values)) == pytest.approx(expected, abs=1e-9)


@given(SCORES, st.integers(0, 1000))
def test_a_score_counted_twice_is_a_score_that_stands_twice(values, seed):
    counts = rng(seed).integers(0, 4, size=(3, len(values)))
    counts[:, 0] += 1
    found = interquartile_mean(np.array(values), counts)
    averages = mean(np.array(values), counts)
    for row, value, average in zip(counts, found, averages, strict=True):
        written_out = np.repeat(values, row)
        assert value == pytest.approx(stats.trim_mean(written_out, 0.25), abs=1e-9)
        assert average == pytest.approx(written_out.mean(), abs=1e-9)


@pytest.mark.parametrize("successes", [0, 10, 25, 40, 50, 75, 90, 100])
def test_on_outcomes_of_0_and_1_the_interquartile_mean_is_a_clipped_mean(successes):
    outcomes = np.arange(100) < successes
    expected = np.clip((successes / 100 - 0.25) / 0.5, 0, 1)
    assert interquartile_mean(outcomes.astype(float)) == pytest.approx(expected)


def drawn(scores: np.ndarray, **options) -> Counter:
    """How often each resample came up, as counts of the flattened scores."""
    seen: Counter = Counter()

    def note(values, counts):
        seen.update(map(tuple, counts.tolist()))
        return mean(values, counts)

    stratified_bootstrap(scores, note, rng=rng(7), replicates=40_000, **options)
    return seen


def counted(places: list[int], size: int) -> tuple[int, ...]:
    return tuple(np.bincount(places, minlength=size).tolist())


def within_tasks(tasks: tuple[int, ...], runs: int, width: int) -> list[tuple[int, ...]]:
    """Every resample of runs for the given tasks, each drawn independently."""
    choices = itertools.product(itertools.product(range(runs), repeat=runs), repeat=len(tasks))
    return [
        counted([r * width + t for t, own in zip(tasks, c, strict=True) for r in own], runs * width)
        for c in choices
    ]


def whole_runs(tasks: tuple[int, ...], runs: int, width: int) -> list[tuple[int, ...]]:
    return [
        counted([r * width + t for r in own for t in tasks], runs * width)
        for own in itertools.product(range(runs), repeat=runs)
    ]


def house_draws(houses: dict[str, list[int]]) -> list[tuple[tuple[int, ...], float]]:
    """Every draw of houses and then of their tasks, with its probability."""
    draws = []
    for names in itertools.product(houses, repeat=len(houses)):
        options = list(
            itertools.product(*(itertools.product(houses[n], repeat=len(houses[n])) for n in names))
        )
        weight = len(houses) ** -len(houses) / len(options)
        draws += [(tuple(itertools.chain(*option)), weight) for option in options]
    return draws


HOUSES = {"a": [0], "b": [1, 2]}
CLUSTERS = ("a", "b", "b")


@pytest.mark.parametrize(
    ("options", "task_draws", "of_runs"),
    [
        ({}, [((0, 1, 2), 1.0)], within_tasks),
        ({"shared_runs": True}, [((0, 1, 2), 1.0)], whole_runs),
        (
            {"tasks": True},
            [(draw, 1 / 27) for draw in itertools.product(range(3), repeat=3)],
            within_tasks,
        ),
        ({"clusters": CLUSTERS, "shared_runs": True}, house_draws(HOUSES), whole_runs),
        ({"clusters": CLUSTERS}, house_draws(HOUSES), within_tasks),
    ],
)
def test_resamples_come_up_as_often_as_all_of_them_written_out(options, task_draws, of_runs):
    runs, width = 2, 3
    expected: Counter = Counter()
    for tasks, weight in task_draws:
        resamples = of_runs(tasks, runs, width)
        for counts in resamples:
            expected[counts] += weight / len(resamples)
    seen = drawn(np.zeros((runs, width)), **options)
    assert sum(expected.values()) == pytest.approx(1)
    assert set(seen) <= set(expected)
    for counts, probability in expected.items():
        assert seen[counts] / 40_000 == pytest.approx(probability, abs=0.011)


def test_the_interval_is_made_of_the_quantiles_of_all_resamples():
    scores = np.array([[0.0, 1.0], [3.0, 10.0]])
    every = within_tasks((0, 1), 2, 2)
    means = np.sort([np.dot(counts, scores.ravel()) / 4 for counts in every])
    found = stratified_bootstrap(scores, mean, rng=rng(), replicates=20_000, confidence=0.75)
    # An eighth of 16 resamples lies between two that tie, so chance can't tip the quantile.
    assert means[1] == means[2] == found.low
    assert means[13] == means[14] == found.high


def test_scores_that_do_not_vary_have_no_width():
    same = stratified_bootstrap(np.full((3, 5), 0.25), interquartile_mean, rng=rng(), tasks=True)
    assert same == Interval(0.25, 0.25)


def test_an_interval_about_new_houses_is_wider_than_one_about_new_seeds():
    houses = [f"house-{k // 10}" for k in range(200)]
    level = np.repeat(rng(3).random(20), 10)
    scores = (level + 0.05 * rng(4).random((3, 200))).clip(0, 1)
    seeds = stratified_bootstrap(scores, mean, rng=rng())
    new = stratified_bootstrap(scores, mean, rng=rng(), clusters=houses, shared_runs=True)
    assert new.low < seeds.low <= scores.mean() <= seeds.high < new.high
    assert new.high - new.low > 5 * (seeds.high - seeds.low)


def test_about_95_of_100_intervals_hold_the_truth():
    source = rng(11)
    held = 0
    for _ in range(200):
        level = source.random(25)
        scores = (level[None, :] + 0.1 * source.standard_normal((4, 25))).repeat(2, axis=1)
        clusters = [f"h{k // 2}" for k in range(50)]
        found = stratified_bootstrap(
            scores, mean, rng=source, replicates=300, clusters=clusters, shared_runs=True
        )
        held += found.low <= 0.5 <= found.high
    assert 0.88 <= held / 200 <= 0.99


def test_the_same_generator_gives_the_same_interval():
    scores = rng(5).random((3, 40))
    one, other = (stratified_bootstrap(scores, mean, rng=rng(9), tasks=True) for _ in range(2))
    assert one == other


@pytest.mark.parametrize(
    ("scores", "options", "message"),
    [
        (np.zeros((0, 3)), {}, r"found \[0, 3\]"),
        (np.zeros(3), {}, r"found \[3\]"),
        (np.array([[np.nan]]), {}, "finite"),
        (np.zeros((1, 2)), {"clusters": ["a"]}, "found 1 for 2 tasks"),
        (np.zeros((1, 2)), {"replicates": 0}, "replicates must be at least 1"),
        (np.zeros((1, 2)), {"confidence": 1.0}, "confidence between 0 and 1"),
    ],
)
def test_what_can_not_be_resampled_is_refused(scores, options, message):
    with pytest.raises(UsageError, match=message):
        stratified_bootstrap(scores, mean, rng=rng(), **options)
