"""The controls of every table: what each one is, and its run."""

from __future__ import annotations

import pytest
from benchmark_samples import tiny_session, tiny_task_sets

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.evaluation.controls import CONTROLS
from lcrl_bench.evaluation.reproduction.experiments import CONTROLS as ROWS
from lcrl_bench.evaluation.run import RunSpec, run


def test_every_control_is_evaluated_on_every_task_in_order():
    sets = tiny_task_sets()
    order = [task.id for tasks in sets for task in tasks.tasks]
    for name, outcomes_of in CONTROLS.items():
        assert [outcome.task.id for outcome in outcomes_of(sets)] == order, name


def test_the_paper_s_tables_have_a_row_for_each():
    assert {row.run.method for row in ROWS} == set(CONTROLS)


def test_a_control_has_a_run_of_its_own_with_the_figures_of_the_session(tmp_path):
    session = tiny_session(tmp_path)
    for name in CONTROLS:
        found = run(RunSpec(name, control=True), session)
        assert found.folder.path == tmp_path / "tiny" / f"control-{name}"
        assert found.results.splits() == session.controls()[name].splits()
        assert found.folder.summary()["splits"] == found.results.splits()
        assert not found.folder.model.exists(), "there is nothing to train"
    assert run(RunSpec("random", control=True), session).read_back


def test_an_unknown_control_is_named(tmp_path):
    session = tiny_session(tmp_path)
    with pytest.raises(UnknownNameError, match=r"Unknown control 'randon'.*'random'"):
        run(RunSpec("randon", control=True), session)
