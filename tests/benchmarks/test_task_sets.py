"""The task sets of a benchmark: every task once, in one order, with views that all tasks share."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_sets import TaskSets, house_task_sets, task_named
from lcrl_bench.errors import UnknownNameError, UsageError

HOUSES = sorted(tiny_benchmark().houses)


def test_every_task_comes_once_by_house_and_kind():
    expected = [
        task
        for house in HOUSES
        for kind in Kind
        for task in tiny_benchmark().select(house=house, kind=kind)
    ]
    assert [task for tasks in tiny_task_sets() for task in tasks.tasks] == expected
    commands = [command for tasks in tiny_task_sets() for command in tasks.commands]
    assert commands == [task.command for task in expected]


def test_some_tasks_of_a_house_see_what_all_of_them_see():
    house = HOUSES[0]
    every = by_house(tiny_task_sets())[0]
    (some,) = house_task_sets(tiny_benchmark(), house, every[-1].tasks[1:3], renderer="rays")
    assert some.tasks == every[-1].tasks[1:3]
    assert torch.equal(some.views.views, every[0].views.views)
    assert torch.equal(some.views.panorama_views, every[0].views.panorama_views)
    assert torch.equal(some.panoramas, every[-1].panoramas[1:3])


def test_sets_on_another_device_share_their_views_there():
    sets = house_task_sets(
        tiny_benchmark(), HOUSES[0], device=torch.device("meta"), renderer="rays"
    )
    assert len({id(tasks.views) for tasks in sets}) == 1
    assert sets[0].views.views.device.type == sets[0].next_state.device.type == "meta"


def test_the_houses_used_last_are_kept():
    first, second, third = (tiny_benchmark().select(house=house)[0] for house in HOUSES)
    kept = TaskSets(tiny_benchmark(), renderer="rays", houses_kept=2)
    assert len(kept) == 0
    before = kept.of(first)[0]
    kept.of(second)
    assert kept.of(first)[0] is before, "used again, so the second goes first"
    kept.of(third)
    assert len(kept) == 2
    assert kept.of(first)[0] is before
    kept.of(second)
    kept.of(third)
    assert kept.of(first)[0] is not before
    kept.clear()
    assert len(kept) == 0


def test_a_task_is_found_in_its_row():
    kept = TaskSets(tiny_benchmark(), renderer="rays")
    for task in tiny_benchmark().tasks:
        tasks, row = kept.of(task)
        assert tasks.tasks[row] == task == task_named(tiny_benchmark(), task.id)


def names_like(names: Sequence[str]) -> str:
    return names[0][:-1]


def test_a_task_that_is_none_and_a_house_that_is_none_are_named():
    task = tiny_benchmark().tasks[0]
    with pytest.raises(UsageError, match=f"has no task '{task.id}x'. Did you mean '{task.id}'?"):
        task_named(tiny_benchmark(), f"{task.id}x")
    with pytest.raises(UnknownNameError, match=f"Unknown house '{names_like(HOUSES)}'"):
        tiny_benchmark().scene(names_like(HOUSES))
