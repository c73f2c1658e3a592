"""Which episodes are recorded: a showcase, the first of each part, failures spread evenly."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.recording.run_recording import (
    choose,
    choose_failures,
    choose_first,
    choose_showcase,
    likeliest_failure,
)


def outcome(benchmark: Benchmark, number: int, kind: Kind, split: Split, way: int) -> Outcome:
    """A task that fails in a way of PICK, or succeeds for `way` -1."""
    task = next(task for task in benchmark.tasks if task.kind == kind)
    proof = replace(task.proof, optimal_length=number % 7)
    success = 1.0 if way < 0 else 0.0
    ways = {failure: float(k == way) for k, failure in enumerate(Failure)}
    task = replace(task, id=f"task-{number}", split=split, proof=proof)
    measures = (success, success, success, 1 - success)
    return Outcome(task, *measures, failures=ways if kind == Kind.PICK else {})


PARTS = st.tuples(st.sampled_from(Kind), st.sampled_from(Split), st.integers(-1, 5))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(parts=st.lists(PARTS, max_size=40), most=st.integers(1, 12))
def test_failures_are_spread_evenly_over_parts(
    parts: list[tuple[Kind, Split, int]], most: int, benchmark_sample: Benchmark
):
    rows = [outcome(benchmark_sample, number, *part) for number, part in enumerate(parts)]
    failed = [row for row in rows if row.success == 0]
    chosen = choose_failures(rows, most=most)
    assert len(chosen) == min(most, len(failed))
    assert len({row.task.id for row in chosen}) == len(chosen)
    there, taken = Counter(map(part_of, failed)), Counter(map(part_of, chosen))
    left = [taken[part] for part in there if taken[part] < there[part]]
    assert not left or max(taken.values()) <= min(left) + 1


def part_of(row: Outcome) -> tuple[Split, Kind, Failure | None]:
    return row.task.split, row.task.kind, likeliest_failure(row)


def test_the_first_of_each_split_and_kind_is_taken(benchmark_sample: Benchmark):
    parts = [
        (Kind.PICK, Split.TRAIN, -1),
        (Kind.NAV, Split.TEST_HOUSE, 0),
        (Kind.NAV, Split.TRAIN, 0),
        (Kind.PICK, Split.TRAIN, 2),
        (Kind.NAV, Split.TEST_HOUSE, -1),
    ]
    rows = [outcome(benchmark_sample, number, *part) for number, part in enumerate(parts)]
    assert sorted(row.task.id for row in choose_first(rows)) == ["task-0", "task-1", "task-2"]
    assert choose("all", rows) == tuple(rows)
    assert choose("none", rows) == ()


def test_the_shortest_failure_of_a_part_is_taken(benchmark_sample: Benchmark):
    rows = [outcome(benchmark_sample, number, Kind.NAV, Split.TRAIN, 0) for number in (6, 2, 4)]
    assert [row.task.id for row in choose_failures(rows, most=2)] == ["task-2", "task-4"]


def result_of(
    benchmark: Benchmark, kind: Kind, split: Split, length: int, success: float
) -> Outcome:
    task = next(task for task in benchmark.tasks if task.kind == kind)
    proof = replace(task.proof, optimal_length=length)
    name = f"{kind}-{split}-{length}-{success}"
    measures = (success, success, success, 1 - success)
    return Outcome(replace(task, id=name, split=split, proof=proof), *measures, failures={})


def test_a_showcase_has_a_success_of_each_kind_and_a_failure(benchmark_sample: Benchmark):
    nav, pick = Kind.NAV, Kind.PICK
    rows = [
        result_of(benchmark_sample, nav, Split.TRAIN, 29, 1.0),
        result_of(benchmark_sample, nav, Split.TEST_HOUSE, 4, 1.0),
        result_of(benchmark_sample, nav, Split.TEST_HOUSE, 9, 1.0),
        result_of(benchmark_sample, pick, Split.TEST_TASK, 20, 1.0),
        result_of(benchmark_sample, pick, Split.TRAIN, 25, 1.0),
        result_of(benchmark_sample, pick, Split.TEST_HOUSE, 22, 0.0),
        result_of(benchmark_sample, nav, Split.TEST_HOUSE, 7, 0.0),
    ]
    chosen = [(o.task.kind, o.task.proof.optimal_length) for o in choose_showcase(rows)]
    assert chosen == [(nav, 9), (pick, 20), (nav, 7)]


def test_a_showcase_leaves_out_what_did_not_occur(benchmark_sample: Benchmark):
    solved = [result_of(benchmark_sample, Kind.NAV, Split.TRAIN, 5, 1.0)]
    assert choose_showcase(solved) == tuple(solved)
    assert choose_showcase([]) == ()
