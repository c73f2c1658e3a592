"""The experiments as declared, against the paper's tables and the methods there are."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.cli.main import main
from lcrl_bench.errors import ExitCode, UnknownNameError
from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.reproduction.experiments import (
    ARCHITECTURES,
    EXPERIMENTS,
    IMAGE_SIZE,
    PAPER_SEEDS,
    TABLE_1,
    TABLE_2,
    Claim,
    specs_of,
)
from lcrl_bench.evaluation.reproduction.paper import paper_tables
from lcrl_bench.evaluation.reproduction.table import verdict
from lcrl_bench.evaluation.results import Figure
from lcrl_bench.evaluation.run import RunSpec

PRINTED = {
    "table-1": r"""
Optimal Policy Cloning & 20.7 & 61.6 & 40.3
        & 10.1 & 29.4 & 19.6
        & 0.0 & 17.2 & 8.5 \\
AGILE & 0.0 & 40.9 & 18.0 & 0.0 & 34.1 & 16.8 & 0.0 & 30.6 & 15.1 \\
GAIL-Exact & 59.4 & \textbf{73.5} & \textbf{66.9}
           & 49.1 & \textbf{50.4} & 49.8 & 23.5 & 35.4 & 28.3 \\
LC-RL (ours) & \textbf{63.8} & 69.7 & \textbf{66.9}
             & \textbf{56.7} & 47.8 & \textbf{51.9}
             & \textbf{32.1} & \textbf{39.4} & \textbf{36.4}\\
Reward Reg. (Oracle) & 87.0 & 85.0 & 86.1
                  & 82.5 & 67.0 & 74.1
                  & 70.6 & 62.3 & 65.7\\
""",
    "table-2": r"""
LC-RL (DQN), shaping & 12.9 & 14.1 & 14.9 \\
LC-RL (DQN), no shaping & 8.0 & 7.7 & 8.0 \\
LC-RL (QI) & 66.9 & 51.9 & 36.4 \\
Reward Regression (DQN), shaping & 54.7 & 58.9 & 57.5 \\
Reward Regression (DQN), no shaping & 7.5 & 8.3 & 9.2 \\
Reward Regression (QI) & 86.1 & 74.1 & 65.7 \\
""",
    "architectures": r"""
Pooling, Mult & 67.3 & 49.7 \\
Pooling, Add & 64.1 & 45.5 \\
Pooling, Concat & 65.8 & 48.5 \\
FiLM, Mult & 60.6 & 43.2 \\
FiLM, Add & 67.0 & 49.1 \\
FiLM, Concat & 63.2 & 44.6 \\
FC, Mult & 53.1 & 38.4 \\
FC, Add & 55.2 & 39.1 \\
FC, Concat & 48.1 & 35.2  \\
""",
    "image-size": r"""
32 by 24 & 67.3 & 49.7 \\
64 by 64 & 70.6 & 51.1 \\
""",
}  # fmt: skip
"""The rows of the paper's tables as its source prints them; in table 2 the column for shaping and
the method that spans two rows are written into the name."""


@pytest.mark.parametrize("name", PRINTED)
def test_the_paper_s_figures_are_those_it_prints(name):
    printed = {}
    for line in re.sub(r"\\textbf\{([\d.]+)\}", r"\1", PRINTED[name]).split(r"\\"):
        row, *figures = (cell.strip() for cell in line.split("&"))
        if figures:
            printed[row] = [float(figure) for figure in figures]
    assert {
        row: list(cells.values()) for row, cells in paper_tables()[name].rows.items()
    } == printed


def test_every_table_of_the_paper_has_an_experiment():
    assert {experiment.name for experiment in EXPERIMENTS} == set(paper_tables())


@pytest.mark.parametrize("experiment", EXPERIMENTS, ids=lambda each: each.name)
def test_an_experiment_s_rows_columns_and_claims_exist(experiment):
    table = paper_tables()[experiment.name]
    labels = [row.label for row in experiment.rows]
    assert len(set(labels)) == len(labels)
    assert {row.paper for row in experiment.rows} - {None} == set(table.rows)
    assert set().union(*(set(row) for row in table.rows.values())) <= set(experiment.columns)
    for claim in experiment.claims:
        assert {claim.first, claim.second} <= set(labels)
        assert claim.column in experiment.columns


def test_the_paper_s_own_figures_bear_its_claims_out():
    """At least those with figures: what is written down as a claim is one."""
    for experiment in EXPERIMENTS:
        table = paper_tables()[experiment.name]
        for claim in experiment.claims:
            rows = (experiment.row(label).paper for label in (claim.first, claim.second))
            first, second = (table.figure(row, claim.column) for row in rows)
            if first is None or second is None:
                continue
            if claim.relation == "better":
                assert first > second, claim
            else:
                assert abs(first - second) < 4, claim


@pytest.mark.parametrize("experiment", EXPERIMENTS, ids=lambda each: each.name)
def test_every_row_s_method_preset_and_settings_are_there(experiment):
    for row in experiment.rows:
        if not row.control:
            row.run.make_method()


def test_the_sweep_differs_in_the_architecture_alone():
    configs = [row.run.make_method().config for row in ARCHITECTURES.rows]
    assert len({(config.image, config.fusion) for config in configs}) == 9
    alike = {replace(config, image="pooling", fusion="mult") for config in configs}
    assert len(alike) == 1


_FILM_ADD = (
    "lcrl-fusion-add-hidden-32-image-film-mirror-false-passes-20-size-32-standardise-false/seed0"
)


def test_what_tables_share_is_run_once():
    specs = specs_of(EXPERIMENTS, PAPER_SEEDS, None)
    keys = {spec.key for spec in specs}
    assert len(keys) == len(set(specs)) == len(specs)
    training = [spec for spec in specs if spec == spec.training and not spec.control]
    # Six methods' rows, nine architectures, one more image size, and each seed of it.
    assert len(training) == 3 * (6 + 9 + 1)
    assert len([spec for spec in specs if spec.optimizer != Optimizer.Q_ITERATION]) == 3 * 4
    assert keys >= {"lcrl/seed0", "lcrl-paper/seed2", "lcrl-64x64/seed1"}
    assert keys >= {_FILM_ADD, "control-optimal"}


def test_a_run_comes_before_what_is_made_of_it():
    specs = specs_of([TABLE_2], (0,), None)
    for spec in specs:
        assert specs.index(spec.training) <= specs.index(spec)
    shaped = TABLE_2.rows[0].specs((0,), None)[0]
    assert (shaped.key, shaped.training.key) == ("lcrl/seed0/dqn-shaping", "lcrl/seed0")


def test_a_budget_shortens_training_and_has_a_folder_of_its_own():
    row = TABLE_1.row("LC-RL")
    full, spec = row.run.make_method().config, row.specs((0,), 0.1)[0]
    assert spec.key == "lcrl-budget-0.1/seed0"
    shortened = replace(full, passes=full.passes // 10, least_steps=full.least_steps // 10)
    assert spec.make_method().config == shortened
    assert row.specs((0,), None)[0].resolved_settings() == {}


def test_an_image_size_has_a_folder_of_its_own():
    own, larger = IMAGE_SIZE.rows
    assert larger.specs((4,), None)[4] == RunSpec("lcrl", seed=4, image_size=(64, 64))
    assert own.specs((4,), None)[4] == RunSpec("lcrl", seed=4)


def test_a_row_that_the_paper_lacks_is_an_error():
    with pytest.raises(UnknownNameError, match="LC-RL"):
        paper_tables()["table-1"].figure("LCRL", "train.total")
    assert paper_tables()["architectures"].figure("FC, Add", "test-house.total") is None


@pytest.mark.parametrize(
    ("relation", "low", "high", "expected"),
    [
        ("better", 0.1, 5.0, "holds"),
        ("better", -0.1, 5.0, "undecided"),
        ("better", -5.0, -0.1, "does not hold"),
        ("alike", -0.1, 5.0, "holds"),
        ("alike", 0.1, 5.0, "does not hold"),
    ],
)
def test_a_claim_is_judged_by_where_zero_is(relation, low, high, expected):
    claim = Claim("", "a", "b", f"{Split.TRAIN.value}.total", relation)
    assert verdict(claim, Figure((low + high) / 2, low, high)) == expected
    assert verdict(claim, None) == verdict(claim, Figure(1.0)) == "undecided"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("table-9",), "table-9"),
        (("table-1", "--budget", "2"), "--budget 2"),
        (("table-1", "--budget", "tiny"), "--budget tiny"),
        (("table-1", "--workers", "-1"), "--workers -1"),
        (("table-1", "--benchmark", "nowhere"), "Unknown benchmark 'nowhere'"),
    ],
)
def test_a_mistake_is_named_before_any_work(words, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["reproduce", *words]) == ExitCode.USAGE
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_rows_that_are_near_each_other_are_run_with_more_seeds_unless_others_are_asked_for():
    own, asked = (set(specs_of([TABLE_1], seeds, None)) for seeds in (None, (0,)))
    for row in TABLE_1.rows:
        assert set(row.specs(None, None).values()) <= own
        assert row.specs((0,), None)[0] in asked
        ten = len(row.seeds) == 10
        assert row.control or (row.specs((9,), None)[9] in own) == ten
    assert len(asked) == len(TABLE_1.rows)
    more = [row.run.method for row in TABLE_1.rows if len(row.seeds) == 10]
    assert more == ["gail_exact", "lcrl"]
