"""Task sets that are streamed are the same task sets, and give the same bits."""

from __future__ import annotations

from dataclasses import fields

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets

from lcrl_bench.benchmarks.house_sets import HouseSets, by_house, tasks_by_set, tasks_of
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.evaluation.controls import CONTROLS
from lcrl_bench.evaluation.harness import evaluate_each, own_command
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.validation import carve_task_sets, carve_validation
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.train_set import train_set


@pytest.fixture
def sets():
    """One house in memory at a time."""
    found = load_task_sets(tiny_benchmark(), renderer="rays", houses_kept=1)
    assert isinstance(found, HouseSets)
    return found


def assert_same(one: TaskSet, other: TaskSet) -> None:
    for each in fields(TaskSet):
        left, right = getattr(one, each.name), getattr(other, each.name)
        if isinstance(left, torch.Tensor):
            assert left.dtype == right.dtype
            assert torch.equal(left, right)
        elif each.name == "views":
            assert torch.equal(left.views, right.views)
            assert torch.equal(left.panorama_views, right.panorama_views)
            assert left.house == right.house
        elif each.name != "origin":
            assert left == right


def test_streamed_sets_are_those_that_are_loaded_at_once(sets):
    for _ in range(2):
        for one, other in zip(sets, tiny_task_sets(), strict=True):
            assert_same(one, other)
    assert [len(house) for house in by_house(sets)] == [len(h) for h in by_house(tiny_task_sets())]
    assert all(house[0].views is house[-1].views for house in by_house(sets))
    assert tasks_of(sets) == tasks_of(tiny_task_sets())
    assert tasks_by_set(sets) == [tasks.tasks for tasks in sets]
    assert_same(sets[-1], tiny_task_sets()[-1])
    assert len(sets[1:3]) == 2


def test_a_method_is_shown_the_same_streamed_or_not(sets):
    shown = train_set(tiny_benchmark(), sets, oracle=False, expert=True)
    whole = train_set(tiny_benchmark(), tiny_task_sets(), oracle=False, expert=True)
    for _ in range(2):
        for one, other in zip(shown.tasks, whole.tasks, strict=True):
            assert_same(one, other)
    assert tasks_of(shown.tasks) == (), "a method is not told the tasks"


@pytest.mark.parametrize("name", ["lcrl", "gail_exact", "cloning", "reward_regression", "agile"])
def test_training_and_evaluation_give_the_same_bits_streamed_or_not(sets, name):
    method = resolve_method(name)
    config = method.Config
    short = {"passes": 2, "least_steps": 1, "size": 8, "hidden": 8}
    answers = []
    for each in (tiny_task_sets(), sets):
        rows = []
        learned = method(config(**short) if config else None).fit(
            train_set(tiny_benchmark(), each, oracle=method.oracle, expert=method.expert),
            generator=torch.Generator().manual_seed(0),
            device=torch.device("cpu"),
            log=rows.append,
        )
        said = {"command": own_command, **language_controls(each)}
        answers.append((rows, evaluate_each(learned, each, said)))
    assert answers[0] == answers[1]


def test_controls_give_the_same_bits_streamed_or_not(sets):
    for outcomes_of in CONTROLS.values():
        assert outcomes_of(sets) == outcomes_of(tiny_task_sets())


def test_houses_are_carved_streamed_or_not(sets):
    benchmark = carve_validation(tiny_benchmark(), houses=1)
    carved = carve_task_sets(benchmark, sets)
    whole = carve_task_sets(benchmark, tiny_task_sets())
    assert isinstance(carved, HouseSets)
    for one, other in zip(carved, whole, strict=True):
        assert_same(one, other)
    assert tasks_of(carved) == tasks_of(whole)
    assert {task.split for task in tasks_of(carved)} >= {Split.TEST_HOUSE}
