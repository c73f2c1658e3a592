"""Outcomes folded into the paper's table."""

import pytest
from lcrl_bench.evaluation.summary import (
    failure_table,
    interval_table,
    mean_table,
    measure_table,
    split_table,
)

from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task
from lcrl_bench.cli.output import print_table
from lcrl_bench.evaluation.outcome import Failure, Outcome
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.table import cell, table_blocks


def outcome(success: float, *, kind: Kind = Kind.NAV, split: Split = Split.TRAIN) -> Outcome:
    task = Task(
        id="t",
        kind=kind,
        split=split,
        house="h",
        command="go to the bed",
        target="bed",
        start_tile=0,
        start_heading=0,
        proof=Proof(1, 1.0, 0.0),
    )
    lost = {Failure.WAITS_AT_A: 1 - success} if kind == Kind.PICK else {}
    failures = {failure: lost.get(failure, 0.0) for failure in Failure} if lost else {}
    return Outcome(task, success, success / 2, success / 4, 1 - success, failures)


def test_a_split_s_total_is_the_mean_over_its_tasks_not_over_its_kinds():
    rows = [outcome(1.0), outcome(1.0), outcome(0.0, kind=Kind.PICK), outcome(1.0)]
    assert split_table(rows)["train"] == {"pick": 0.0, "nav": 100.0, "total": 75.0, "n": 4}


def test_a_split_without_tasks_has_no_percentages():
    empty = {"pick": None, "nav": None, "total": None, "n": 0}
    assert split_table([outcome(1.0)])["test-house"] == empty


def test_the_table_does_not_depend_on_the_order_of_the_tasks():
    rows = [outcome(0.1 * k) for k in range(10)]
    assert split_table(rows) == split_table(reversed(rows))


def test_every_measure_has_the_columns_of_the_table():
    rows = [outcome(1.0), outcome(0.0), outcome(0.5, kind=Kind.PICK)]
    measures = measure_table(rows)["train"]
    columns = {key: value for key, value in split_table(rows)["train"].items() if key != "n"}
    assert measures["success"] == columns == {"pick": 50.0, "nav": 50.0, "total": 50.0}
    assert measures["final"] == {"pick": 25.0, "nav": 25.0, "total": 25.0}
    assert measures["path_weighted"] == {"pick": 12.5, "nav": 12.5, "total": 12.5}
    assert measures["regret"] == {"pick": 50.0, "nav": 50.0, "total": 50.0}
    assert measure_table(rows)["test-house"]["regret"]["total"] is None


def test_failures_are_shares_of_the_pick_tasks_and_make_100_with_success():
    rows = [outcome(0.0), outcome(0.25, kind=Kind.PICK), outcome(0.75, kind=Kind.PICK)]
    failures = failure_table(rows)["train"]
    assert failures["waits_at_a"] == 50.0
    assert split_table(rows)["train"]["pick"] + sum(failures.values()) == 100.0
    assert set(failure_table([outcome(0.0)])["train"].values()) == {None}


def test_the_mean_over_seeds_averages_each_column():
    first, second = split_table([outcome(1.0)]), split_table([outcome(0.5)])
    assert mean_table([first, second])["train"]["nav"] == pytest.approx(75.0)
    assert mean_table([first, second])["train"]["pick"] is None


def test_every_split_has_a_block_with_a_cell_for_every_heading():
    blocks = table_blocks({"lcrl": split_table([outcome(1.0)])})
    assert [block.headings[0] for block in blocks] == [
        "train: success, %",
        "test-task: success, %",
        "test-house: success, %",
    ]
    for block in blocks:
        assert block.headings[1:] == ("PICK", "NAV", "total")
    assert blocks[0].rows == (("lcrl", "–", "100.0", "100.0"),)
    assert cell(33.349) == "33.3"


def test_intervals_stand_below_their_row():
    bounds = {"pick": None, "nav": [98.0, 99.96], "total": [90.0, 100.0]}
    intervals = {"lcrl": dict.fromkeys(("train", "test-task", "test-house"), bounds)}
    tables = {name: split_table([outcome(1.0)]) for name in ("lcrl", "random")}
    above, below, other = table_blocks(tables, intervals=intervals)[0].rows
    assert above == ("lcrl", "–", "100.0", "100.0")
    assert below == ("  95 % interval", "–", "[98.0, 100.0]", "[90.0, 100.0]")
    assert other[0] == "random"


def test_the_widest_table_fits_80_columns(capsys):
    name = "a/path/to/a/method/of/ones/own/method.py:LongishName, wrong-target"
    bounds = {key: [100.0, 100.0] for key in ("pick", "nav", "total")}
    intervals = {name: dict.fromkeys(("train", "test-task", "test-house"), bounds)}
    for block in table_blocks({name: split_table([outcome(1.0)])}, intervals=intervals):
        print_table(block.headings, block.rows, right=block.headings[1:])
    shown = capsys.readouterr().out
    assert max(map(len, shown.splitlines())) <= 80
    assert ", wrong-target" in shown


def test_intervals_are_about_every_split_and_kind(tmp_path):
    files = []
    for seed, success in enumerate((0.25, 0.75)):
        folder = RunFolder(tmp_path / f"seed{seed}")
        folder.write_episodes([outcome(success), outcome(success, kind=Kind.PICK)])
        files.append(folder.path / "episodes.parquet")
    found = interval_table(files)
    assert found["train"] == {key: [25.0, 75.0] for key in ("pick", "nav", "total")}
    assert found["test-house"] == dict.fromkeys(("pick", "nav", "total"))
