"""How figures are written."""

from __future__ import annotations

import pytest

from lcrl_bench.evaluation.table import cell, interval_cell


@pytest.mark.parametrize(
    ("value", "written"),
    [(None, "–"), (0.0, "0.0"), (-0.04, "0.0"), (-0.06, "-0.1"), (71.1452, "71.1")],
)
def test_a_figure_has_one_decimal_and_nothing_is_a_dash(value, written):
    assert cell(value) == written


def test_an_interval_has_both_its_ends():
    assert interval_cell((1.0, 2.25)) == "[1.0, 2.2]"
    assert interval_cell(None) == "–"
