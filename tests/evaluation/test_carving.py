"""Validation houses are carved from training houses alone."""

from __future__ import annotations

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.validation import carve_task_sets, carve_validation
from lcrl_bench.methods.train_set import train_set


def test_no_test_task_is_left_and_no_house_is_on_both_sides():
    benchmark = tiny_benchmark()
    carved = carve_validation(benchmark, houses=1)
    train = {task.id for task in benchmark.select(split=Split.TRAIN)}
    assert {task.id for task in carved.tasks} == train
    assert not set(carved.houses_of(Split.TEST_HOUSE)) & set(carved.houses_of(Split.TRAIN))
    assert len(carved.houses_of(Split.TEST_HOUSE)) == 1
    assert carved.fingerprint != benchmark.fingerprint
    assert carve_validation(benchmark, houses=1).fingerprint == carved.fingerprint


def test_the_carved_houses_hold_the_same_tasks_under_other_names():
    benchmark = tiny_benchmark()
    carved = carve_validation(benchmark, houses=1)
    sets = carve_task_sets(carved, tiny_task_sets())
    tasks = [task for each in sets for task in each.tasks]
    assert sorted(task.id for task in tasks) == sorted(task.id for task in carved.tasks)
    assert {task.split for task in tasks} >= {Split.TRAIN, Split.TEST_HOUSE}
    learned_from = train_set(carved, sets, oracle=True)
    commands = [c for each in learned_from.tasks for c in each.commands]
    assert len(commands) == len(carved.select(split=Split.TRAIN))
    assert all(bool(torch.any(t.goal)) for t in learned_from.tasks)


@pytest.mark.parametrize("houses", [0, 99])
def test_as_many_houses_as_there_are_can_not_be_held_out(houses):
    with pytest.raises(UsageError, match="training houses; hold out at least 1"):
        carve_validation(tiny_benchmark(), houses=houses)
