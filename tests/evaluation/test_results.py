"""Results: tables by split and kind, figures with intervals, differences, files."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from results_samples import outcome, results_of, success_results

from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.evaluation.results import (
    COLUMNS,
    FAILURES,
    MEASURES,
    TABLES,
    Figure,
    Results,
    language_value,
)

PICK = Kind.PICK


def mixed(seed: int = 0, shift: float = 0.0) -> Results:
    """A run of five tasks of both kinds and two splits, with two language controls."""
    rows = [outcome(0.1 * k + shift, task=f"t{k}") for k in range(1, 3)]
    rows += [outcome(0.3 * k + shift, task=f"p{k}", kind=PICK) for k in range(1, 3)]
    rows += [outcome(1 / 3 + shift, task="h", kind=PICK, split=Split.TEST_HOUSE)]
    language = {
        "wrong-target": [outcome(0.7, task="t1")],
        "blank": [outcome(0.05, task=row.task.id) for row in rows],
    }
    return Results.of("lcrl", seed, rows, language=language)


def test_a_split_s_total_is_the_mean_over_its_tasks_not_over_its_kinds():
    found = results_of(outcome(1.0), outcome(1.0), outcome(0.0, kind=PICK), outcome(1.0))
    assert found.splits()["train"] == {"pick": 0.0, "nav": 100.0, "total": 75.0, "n": 4}


def test_a_split_without_tasks_has_no_percentages():
    empty = {"pick": None, "nav": None, "total": None, "n": 0}
    found = results_of(outcome(1.0))
    assert found.splits()["test-house"] == empty
    assert found.figure("test-house", "total") is None
    assert found.estimate("test-house", "total") is None


def test_a_table_does_not_depend_on_the_order_of_the_tasks():
    rows = [outcome(0.1 * k, task=f"t{k}") for k in range(10)]
    assert results_of(*rows).tables() == results_of(*reversed(rows)).tables()


def test_every_measure_has_the_columns_of_the_table():
    found = results_of(outcome(1.0), outcome(0.0), outcome(0.5, kind=PICK)).tables()
    measures = found["measures"]["train"]
    columns = {key: value for key, value in found["splits"]["train"].items() if key != "n"}
    assert list(measures) == list(MEASURES)
    assert measures["success"] == columns == {"pick": 50.0, "nav": 50.0, "total": 50.0}
    assert measures["final"] == {"pick": 25.0, "nav": 25.0, "total": 25.0}
    assert measures["path_weighted"] == {"pick": 12.5, "nav": 12.5, "total": 12.5}
    assert measures["regret"] == {"pick": 50.0, "nav": 50.0, "total": 50.0}
    assert found["measures"]["test-house"]["regret"]["total"] is None


def test_failures_are_shares_of_the_pick_tasks_and_make_100_with_success():
    rows = [outcome(0.0), outcome(0.25, kind=PICK), outcome(0.75, kind=PICK)]
    found = results_of(*rows).tables()
    failures = found["failures"]["train"]
    assert failures["waits_at_a"] == 50.0
    assert found["splits"]["train"]["pick"] + sum(failures.values()) == 100.0
    assert set(results_of(outcome(0.0)).tables()["failures"]["train"].values()) == {None}


def test_a_language_control_is_about_the_tasks_it_has_a_sentence_for():
    language = mixed().tables()["language"]
    assert language["wrong-target"]["train"] == {"pick": None, "nav": 70.0, "total": 70.0, "n": 1}
    assert language["blank"]["train"]["n"] == 4
    assert mixed().controls == ("wrong-target", "blank"), "in the order in which they were given"


def test_the_tables_are_json_and_are_those_that_are_named():
    tables = mixed().tables()
    assert tuple(tables) == TABLES
    assert json.loads(json.dumps(tables, allow_nan=False)) == tables


def test_the_mean_over_seeds_averages_each_column():
    runs = [results_of(outcome(success), seed=seed) for seed, success in enumerate((1.0, 0.5))]
    found = Results.join(runs).splits()["train"]
    assert found == {"pick": None, "nav": 75.0, "total": 75.0, "n": 1}


def test_the_tables_of_each_seed_are_those_of_its_run():
    runs = [mixed(seed=3), mixed(seed=5, shift=0.01)]
    joined = Results.join(runs)
    assert joined.seeds == (3, 5)
    assert joined.seed_tables() == {3: runs[0].tables(), 5: runs[1].tables()}


def test_runs_about_different_tasks_are_not_joined():
    first, other = results_of(outcome(1.0, task="a")), results_of(outcome(1.0, task="b"), seed=1)
    with pytest.raises(UsageError, match=r"Seeds \(0,\) and \(1,\) are about different tasks"):
        Results.join([first, other])
    row = replace(outcome(1.0, task="a").task, command="go to the door")
    told = results_of(replace(outcome(1.0), task=row), seed=1)
    with pytest.raises(UsageError, match="different tasks"):
        Results.join([first, told])
    with pytest.raises(UsageError, match="no results to join"):
        Results.join([])


def test_the_total_is_about_all_splits():
    rows = [outcome(1.0), outcome(0.0, split=Split.TEST_HOUSE), outcome(0.5, kind=PICK)]
    assert results_of(*rows).total() == 50.0


def test_a_column_has_the_tasks_of_its_split_and_kind():
    every = success_results([[0.1, 0.2, 0.3, 0.4]])
    assert every.figure("train", "total") == Figure(15.0, n=2)
    assert every.figure("test-house", "nav") == Figure(40.0, n=1)
    assert every.estimate("test-task", "pick") is None


def test_an_estimate_is_in_per_cent_and_lies_in_its_interval():
    found = success_results([[0.0, 1.0, 0.5, 0.25], [1.0, 0.0, 0.75, 0.5]]).estimate(
        "test-house", "total"
    )
    assert found.mean == pytest.approx(50.0)
    assert found.low < found.mean < found.high
    assert found.n == 4, "two tasks, two seeds"


def test_the_mean_of_an_estimate_is_the_figure_of_the_table():
    joined = Results.join([mixed(seed=0), mixed(seed=1, shift=0.05)])
    for split, row in joined.figures().items():
        for column in COLUMNS:
            mean = None if row[column] is None else row[column].mean
            assert mean == pytest.approx(joined.splits()[split][column])


def test_what_never_varies_has_no_width():
    found = success_results([[1.0] * 4] * 3).estimate("train", "total")
    assert (found.mean, found.low, found.high) == (100, 100, 100)


def test_an_estimate_is_the_same_each_time():
    one = success_results([[0.0, 1.0, 0.5, 0.25]])
    assert one.estimate("train", "total") == one.estimate("train", "total")


def test_intervals_are_about_every_split_and_kind():
    runs = [
        results_of(outcome(success), outcome(success, kind=PICK), seed=seed)
        for seed, success in enumerate((0.25, 0.75))
    ]
    figures = Results.join(runs).figures()
    assert {key: each.bounds for key, each in figures["train"].items()} == dict.fromkeys(
        COLUMNS, (25.0, 75.0)
    )
    assert figures["test-house"] == dict.fromkeys(COLUMNS)
    assert results_of(outcome(1.0)).figure("train", "total").bounds is None


def test_a_difference_is_paired_so_what_both_share_cancels():
    hard = [[0.0, 0.2, 0.6, 0.9], [0.1, 0.3, 0.5, 0.8]]
    first, second = success_results((np.array(hard) + 0.1).tolist()), success_results(hard)
    for split in ("train", "test-house"):
        found = first.difference(second, split, "total")
        assert (found.mean, *found.bounds) == pytest.approx((10, 10, 10))
        assert second.difference(first, split, "total").mean == pytest.approx(-10)


def test_a_row_without_seeds_is_the_same_against_each_seed():
    seeds, control = success_results([[0.2] * 4, [0.4] * 4]), success_results([[0.1] * 4])
    assert seeds.difference(control, "train", "total").mean == pytest.approx(20)
    assert control.difference(seeds, "train", "total").mean == pytest.approx(-20)


def test_of_three_seeds_and_two_the_first_two_are_compared():
    three = success_results([[0.2] * 4, [0.4] * 4, [1.0] * 4])
    two = success_results([[0.0] * 4] * 2)
    assert three.difference(two, "test-house", "total").mean == pytest.approx(30)


def test_a_difference_is_about_the_tasks_that_both_have():
    every = success_results([[0.0, 1.0, 1.0, 1.0]])
    some = success_results([[0.5, 0.5, 0.5, 0.5]], ids="axyz")
    assert every.difference(some, "train", "total").mean == pytest.approx(-50)
    assert every.difference(success_results([[1.0]], ids="z"), "train", "total") is None
    assert every.difference(some, "test-house", "total") is None


def test_what_is_written_is_read_back_to_the_bit(tmp_path):
    run = mixed(seed=4)
    run.write(tmp_path / "episodes.parquet")
    again = Results.read("lcrl", {4: tmp_path / "episodes.parquet"})
    assert (again.method, again.seeds, again.rows) == (run.method, run.seeds, run.rows)
    assert list(again.values) == list(run.values)
    for name, values in run.values.items():
        assert again.values[name].tobytes() == values.tobytes(), name


def test_a_file_has_a_row_per_task_and_leaves_out_what_there_is_no_number_of(tmp_path):
    mixed().write(tmp_path / "episodes.parquet")
    rows = {row["task"]: row for row in pq.read_table(tmp_path / "episodes.parquet").to_pylist()}
    assert list(rows) == sorted(rows) == ["h", "p1", "p2", "t1", "t2"]
    assert rows["t1"]["failure_waits_at_a"] is None
    assert rows["p1"]["failure_waits_at_a"] == pytest.approx(0.7)
    assert rows["p1"]["success_wrong_target"] is None
    assert rows["t1"]["success_wrong_target"] == 0.7
    assert rows["h"]["split"] == "test-house"
    measured = set(MEASURES.values()) | set(FAILURES.values())
    assert measured | {"success_blank", "optimal_length", "random_success"} <= set(rows["h"])


def test_files_are_read_in_the_order_of_ids_and_must_be_about_the_same_tasks(tmp_path):
    def write(name: str, **success: float):
        rows = [
            {"task": task, "split": "train", "kind": "nav", "house": "h", "command": "go"}
            | {"success": value, "optimal_length": 1, "random_success": 0.0}
            for task, value in success.items()
        ]
        pq.write_table(pa.Table.from_pylist(rows), tmp_path / name)
        return tmp_path / name

    first, second = write("1.parquet", b=0.2, a=0.1), write("2.parquet", a=0.3, b=0.4)
    found = Results.read("lcrl", {0: first, 1: second})
    assert [row.task for row in found.rows] == ["a", "b"]
    assert found.values["success"].tolist() == [[0.1, 0.2], [0.3, 0.4]]
    with pytest.raises(InvalidFileError, match=r"not those of .*1\.parquet"):
        Results.read("lcrl", {0: first, 1: write("3.parquet", a=0.3, c=0.4)})
    (tmp_path / "4.parquet").write_bytes(b"torn")
    with pytest.raises(InvalidFileError, match="can't be read"):
        Results.read("lcrl", {0: tmp_path / "4.parquet"})
    pq.write_table(pa.table({"task": ["a"], "success": [1.0]}), tmp_path / "5.parquet")
    with pytest.raises(InvalidFileError, match="can't be read"):
        Results.read("lcrl", {0: tmp_path / "5.parquet"})


def test_outcomes_come_back_as_they_were_in_the_order_asked_for():
    rows = [outcome(1 / 3, task="b"), outcome(0.25, task="c", kind=PICK), outcome(0.7, task="a")]
    found = results_of(*rows)
    assert found.outcomes([row.task for row in rows]) == tuple(rows)
    assert found.outcomes([rows[1].task]) == (rows[1],)
    assert found.outcomes([rows[0].task])[0].failures == {}


def test_pandas_has_one_row_per_task_and_seed():
    joined = Results.join([mixed(seed=2), mixed(seed=7, shift=0.01)])
    table = joined.to_pandas()
    assert len(table) == 5 * 2
    assert sorted(table["seed"].unique()) == [2, 7]
    assert not table.duplicated(["task", "seed"]).any()
    assert set(joined.values) | {"task", "split", "kind", "house", "command"} <= set(table)
    for seed, run in zip((2, 7), (0, 1), strict=True):
        chosen = table[table["seed"] == seed].set_index("task")
        for name, values in joined.values.items():
            found = chosen.loc[[row.task for row in joined.rows], name].to_numpy()
            assert found.tobytes() == values[run].tobytes(), name
    shown = table[(table["split"] == "train") & (table["kind"] == "pick")]
    assert 100 * shown["success"].mean() == pytest.approx(joined.splits()["train"]["pick"])


def test_a_control_s_value_is_named_after_it():
    assert language_value("wrong-target") == "success_wrong_target"
    values = mixed().values[language_value("wrong-target")][0]
    known = [row.task for row, value in zip(mixed().rows, values, strict=True) if value == value]
    assert known == ["t1"]
    assert sum(math.isnan(value) for value in values) == 4


def test_every_failure_is_a_value():
    assert set(FAILURES.values()) == {f"failure_{failure.value}" for failure in Failure}
    assert set(FAILURES.values()) <= set(mixed().values)
