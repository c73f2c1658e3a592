"""A session loads a benchmark once, and evaluates its controls once."""

from __future__ import annotations

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_session, tiny_task_sets

from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.controls import CONTROLS
from lcrl_bench.evaluation.search import CarvedSession
from lcrl_bench.evaluation.session import Session, Workplace, resolve_device
from lcrl_bench.evaluation.validation import carve_validation


def test_houses_are_loaded_when_they_are_first_needed_and_once(tmp_path):
    told: list[str] = []
    place = Workplace(tmp_path, renderer="rays")
    session = Session(tiny_benchmark(), place)
    sets = session.task_sets(progress=told.append)
    assert told == sorted(tiny_benchmark().houses)
    assert session.task_sets() is sets
    assert [each.tasks for each in sets] == [each.tasks for each in tiny_task_sets()]


def test_another_image_size_has_task_sets_of_its_own(tmp_path):
    session = tiny_session(tmp_path)
    own, small = session.task_sets(), session.task_sets((16, 12))
    assert own[0].views.views.shape[-2:] != small[0].views.views.shape[-2:] == (12, 16)
    assert session.task_sets()[0].views.views.shape == own[0].views.views.shape


def test_controls_are_evaluated_once(tmp_path):
    session = tiny_session(tmp_path)
    controls = session.controls()
    assert list(controls) == list(CONTROLS)
    assert session.controls() is controls
    assert controls["optimal"].total() == pytest.approx(100)
    assert controls["constant"].total() == pytest.approx(controls["random"].total())


def test_a_carved_session_has_training_tasks_alone(tmp_path):
    benchmark, place = tiny_benchmark(), Workplace(tmp_path, renderer="rays")
    carved = carve_validation(benchmark, houses=1)
    session = CarvedSession(benchmark, carved, place)
    tasks = [task for each in session.task_sets() for task in each.tasks]
    assert sorted(task.id for task in tasks) == sorted(task.id for task in carved.tasks)
    assert {task.id: task.split for task in tasks} == {t.id: t.split for t in carved.tasks}
    assert session.task_sets() is session.task_sets()


def test_a_device_is_named_or_found():
    assert resolve_device("cpu") == torch.device("cpu")
    assert resolve_device("auto").type == ("cuda" if torch.cuda.is_available() else "cpu")
    with pytest.raises(UsageError, match="--device tpu9"):
        resolve_device("tpu9")
