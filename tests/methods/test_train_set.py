"""What a method is handed: training tasks without scene, task or goal, and nothing that tells."""

from __future__ import annotations

from dataclasses import fields
from itertools import pairwise

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets
from task_samples import sample_train_set

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.expert import shortest_way_policy
from lcrl_bench.methods.train_set import TrainSet, select_split, train_set
from lcrl_bench.panoramas import Panoramas


def handed(*, oracle: bool = False, expert: bool = False) -> TrainSet:
    return train_set(tiny_benchmark(), tiny_task_sets(), oracle=oracle, expert=expert)


@pytest.mark.parametrize("train", [handed(), sample_train_set(0)], ids=["benchmark", "practice"])
def test_it_has_neither_tasks_nor_scene_nor_goals(train: TrainSet):
    for tasks in train.tasks:
        assert tasks.tasks == ()
        assert not tasks.goal.any()
        with pytest.raises(UsageError, match="not told the scene"):
            _ = tasks.scene


def test_nothing_in_it_leads_to_a_house_or_a_task():
    # Numbers, sentences and views: no object that knows where anything is.
    for tasks in handed(oracle=True, expert=True).tasks:
        assert set(vars(tasks)) == {each.name for each in fields(TaskSet)}, "nothing worked out"
        for name, value in vars(tasks).items():
            if name == "commands":
                assert {type(command) for command in value} == {str}
            elif name == "views":
                assert type(value) is Panoramas
                assert set(vars(value)) == {"views", "panorama_views", "house"}
            elif name not in ("tasks", "origin"):
                assert isinstance(value, (torch.Tensor, int, float)), name


def test_goals_are_for_an_oracle_alone_and_the_optimum_for_an_expert():
    true = [select_split(tasks, Split.TRAIN) for tasks in tiny_task_sets()]
    pairs = list(zip(handed(oracle=True).tasks, [each for each in true if each], strict=True))
    assert pairs
    for tasks, own in pairs:
        assert torch.equal(tasks.goal, own.goal)
        assert tasks.expert is None
    for tasks, (_, own) in zip(handed(expert=True).tasks, pairs, strict=True):
        assert not tasks.goal.any()
        assert tasks.expert is not None
        assert torch.equal(tasks.expert, shortest_way_policy(own))


def test_each_cell_shows_what_it_shows_in_the_house():
    true = [select_split(tasks, Split.TRAIN) for tasks in tiny_task_sets()]
    for tasks, own in zip(handed().tasks, [each for each in true if each], strict=True):
        assert tasks.commands == own.commands
        for row in range(len(tasks)):
            for cell in range(0, tasks.cells, 11):
                shown, seen = int(tasks.panoramas[row, cell]), int(own.panoramas[row, cell])
                assert (tasks.views.pixels(shown) == own.views.pixels(seen)).all()


def test_every_panorama_is_shown_once_in_an_order_of_its_own_and_is_seen_somewhere():
    for house in handed().houses:
        views = house[0].views
        used = torch.cat([tasks.panoramas.flatten() for tasks in house]).unique()
        assert used.tolist() == list(range(len(views)))
        pixels = views.views[views.panorama_views].flatten(1)
        assert len(torch.unique(pixels, dim=0)) == len(views)
        assert set(views.panorama_views.flatten().tolist()) == set(range(len(views.views)))


def test_houses_are_those_that_are_trained_in_and_their_sets_share_views():
    train = handed()
    assert train.houses == by_house(train.tasks)
    assert [tasks for house in train.houses for tasks in house] == list(train.tasks)
    names = [house[0].views.house for house in train.houses]
    assert names == list(tiny_benchmark().houses_of(Split.TRAIN))
    assert all(one.views is other.views for house in train.houses for one, other in pairwise(house))
    assert train.vocabulary == tiny_benchmark().vocabulary


def test_demonstrations_start_where_their_tasks_do_and_take_possible_steps():
    for tasks in handed().tasks:
        states = tasks.demonstrations
        assert states.shape == (len(tasks), 10, tasks.horizon + 1)
        assert (states[:, :, 0] == tasks.start[:, None]).all()
        for row in range(len(tasks)):
            onward = tasks.next_state[row, states[row, :, :-1]]
            assert (onward == states[row, :, 1:, None]).any(-1).all()


def test_selecting_a_split_selects_the_tasks_of_that_split():
    for tasks in tiny_task_sets():
        for split in Split:
            expected = [task for task in tasks.tasks if task.split == split]
            found = select_split(tasks, split)
            assert list(found.tasks if found else ()) == expected
