"""Scores of runs: columns, means, intervals, differences."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from lcrl_bench.evaluation.reproduction.scores import Scores, difference, estimate, read_scores

from lcrl_bench.errors import InvalidFileError


def scores(success: list[list[float]], *, ids: str = "abcd") -> Scores:
    count = len(success[0])
    return Scores(
        np.array(success, dtype=np.float64),
        tuple(ids[:count]),
        ("h1", "h1", "h2", "h3")[:count],
        ("train", "train", "test-house", "test-house")[:count],
        ("pick", "nav", "pick", "nav")[:count],
    )


def test_a_column_has_the_tasks_of_its_split_and_kind():
    every = scores([[0.1, 0.2, 0.3, 0.4]])
    assert every.column("train.total").success.tolist() == [[0.1, 0.2]]
    assert every.column("test-house.nav").tasks == ("d",)
    assert estimate(every.column("test-task.pick")) is None


def test_an_estimate_is_in_per_cent_and_lies_in_its_interval():
    found = estimate(scores([[0.0, 1.0, 0.5, 0.25], [1.0, 0.0, 0.75, 0.5]]))
    assert found.mean == pytest.approx(50.0)
    assert found.low < found.mean < found.high


def test_what_never_varies_has_no_width():
    found = estimate(scores([[1.0] * 4] * 3))
    assert (found.mean, found.low, found.high) == (100, 100, 100)


def test_an_estimate_is_the_same_each_time():
    one = scores([[0.0, 1.0, 0.5, 0.25]])
    assert estimate(one) == estimate(one)


def test_a_difference_is_paired_so_what_both_share_cancels():
    hard = scores([[0.0, 0.2, 0.6, 0.9], [0.1, 0.3, 0.5, 0.8]])
    easier = scores((hard.success + 0.1).tolist())
    found = difference(easier, hard)
    assert (found.mean, found.low, found.high) == pytest.approx((10, 10, 10))
    assert difference(hard, easier).mean == pytest.approx(-10)


def test_a_row_without_seeds_is_the_same_against_each_seed():
    seeds, control = scores([[0.2] * 4, [0.4] * 4]), scores([[0.1] * 4])
    assert difference(seeds, control).mean == pytest.approx(20)
    assert difference(control, seeds).mean == pytest.approx(-20)


def test_of_three_seeds_and_two_the_first_two_are_compared():
    three, two = scores([[0.2] * 4, [0.4] * 4, [1.0] * 4]), scores([[0.0] * 4] * 2)
    assert difference(three, two).mean == pytest.approx(30)


def test_a_difference_is_about_the_tasks_that_both_have():
    every, some = scores([[0.0, 1.0, 1.0, 1.0]]), scores([[0.5, 0.5, 0.5, 0.5]], ids="axyz")
    assert difference(every, some).mean == pytest.approx(-50)
    assert difference(every, scores([[1.0]], ids="z")) is None


def test_files_are_read_in_the_order_of_ids_and_must_be_about_the_same_tasks(tmp_path):
    def write(name: str, **success: float):
        rows = [
            {"task": task, "house": "h", "split": "train", "kind": "nav", "success": value}
            for task, value in success.items()
        ]
        pq.write_table(pa.Table.from_pylist(rows), tmp_path / name)
        return tmp_path / name

    first, second = write("1.parquet", b=0.2, a=0.1), write("2.parquet", a=0.3, b=0.4)
    assert read_scores([first, second]).success.tolist() == [[0.1, 0.2], [0.3, 0.4]]
    with pytest.raises(InvalidFileError, match=r"not those of .*1\.parquet"):
        read_scores([first, write("3.parquet", a=0.3, c=0.4)])
    (tmp_path / "4.parquet").write_bytes(b"torn")
    with pytest.raises(InvalidFileError, match="can't be read"):
        read_scores([tmp_path / "4.parquet"])
