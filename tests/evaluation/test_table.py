"""How the paper's table and its figures are written."""

from __future__ import annotations

from dataclasses import replace

import pytest
from results_samples import outcome, results_of

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.cli.output import print_table
from lcrl_bench.evaluation.results import Figure, Results
from lcrl_bench.evaluation.table import INTERVAL_ROW, cell, interval_cell, table_blocks


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (None, "–"),
        (0.0, "0.0"),
        (-0.04, "0.0"),
        (-0.06, "-0.1"),
        (71.1452, "71.1"),
        (33.349, "33.3"),
    ],
)
def test_a_figure_has_one_decimal_and_nothing_is_a_dash(value, written):
    assert cell(value) == written


def test_an_interval_has_both_its_ends():
    assert interval_cell(Figure(1.5, 1.0, 2.25)) == "[1.0, 2.2]"
    assert interval_cell(Figure(99.0, 98.0, 99.96)) == "[98.0, 100.0]"
    assert interval_cell(Figure(1.5)) == "–"
    assert interval_cell(None) == "–"


def test_every_split_has_a_block_with_a_cell_for_every_heading():
    blocks = table_blocks(results_of(outcome(1.0)))
    assert [block.headings[0] for block in blocks] == [
        "train: success, %",
        "test-task: success, %",
        "test-house: success, %",
    ]
    for block in blocks:
        assert block.headings[1:] == ("PICK", "NAV", "total")
    assert blocks[0].rows == (("lcrl", "–", "100.0", "100.0"),)


def several(*success: float, method: str = "lcrl", controls: tuple[str, ...] = ()) -> Results:
    """A seed per success, each told something else too."""
    runs = [
        Results.of(
            method, seed, [outcome(each)], language={name: [outcome(0.5)] for name in controls}
        )
        for seed, each in enumerate(success)
    ]
    return Results.join(runs)


def test_intervals_stand_below_their_row_where_there_are_several_seeds():
    beside = {"random": results_of(outcome(0.125))}
    above, below, other = table_blocks(replace(several(0.25, 0.75), beside=beside))[0].rows
    assert above == ("lcrl", "–", "50.0", "50.0")
    assert below == (INTERVAL_ROW, "–", "[25.0, 75.0]", "[25.0, 75.0]")
    assert other == ("random", "–", "12.5", "12.5")


def test_rows_are_the_method_other_optimizers_what_it_is_told_and_the_controls():
    told = ("blank", "shuffled", "wrong-target", "paraphrase")
    found = replace(
        several(1.0, controls=told),
        optimized={"lcrl, dqn": results_of(outcome(0.25))},
        beside={name: results_of(outcome(0.0)) for name in ("random", "optimal")},
    )
    names = [row[0] for row in table_blocks(found)[0].rows]
    assert names == ["lcrl", "lcrl, dqn", *(f"lcrl, {name}" for name in told), "random", "optimal"]


def test_the_widest_table_fits_80_columns(capsys):
    name = "a/path/to/a/method/of/ones/own/method.py:LongishName"
    rows = [outcome(1.0), outcome(1.0, kind=Kind.PICK)]
    runs = [Results.of(name, seed, rows, language={"wrong-target": rows}) for seed in range(2)]
    for block in table_blocks(Results.join(runs)):
        print_table(block.headings, block.rows, right=block.headings[1:])
    shown = capsys.readouterr().out
    assert "[100.0, 100.0]" in shown
    assert max(map(len, shown.splitlines())) <= 80
    assert ", wrong-target" in shown
