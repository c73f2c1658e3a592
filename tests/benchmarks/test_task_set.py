"""Task sets: rows stay together, devices change nothing else, and what interacting does where."""

from __future__ import annotations

from dataclasses import fields, replace

import pytest
import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets
from hypothesis import given
from hypothesis import strategies as st
from task_samples import sample_train_set

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import CHUNK, TaskSet, one_task
from lcrl_bench.mdp.expert import shortest_way_policy
from lcrl_bench.mdp.task_batch import HEADINGS, OBJECT_STATES, Action, ObjectState
from lcrl_bench.methods.train_set import demonstrate
from lcrl_bench.scenes.reach import within_reach

SHARED = {"horizon", "discount", "views", "origin"}
"""Fields that all tasks of a set share; every other has a row per task."""


def full_sets() -> list[TaskSet]:
    """A NAV and a PICK set with something in every field."""
    return [
        replace(
            tasks,
            demonstrations=demonstrate(tiny_benchmark(), tasks),
            expert=shortest_way_policy(tasks),
        )
        for tasks in by_house(tiny_task_sets())[0]
    ]


FULL = full_sets()


def assert_rows(part: TaskSet, whole: TaskSet, chosen: list[int]) -> None:
    """Every field of `part` holds the chosen rows of `whole`, whatever fields there are."""
    assert len(part) == len(chosen)
    for each in fields(TaskSet):
        found, before = getattr(part, each.name), getattr(whole, each.name)
        if each.name in SHARED:
            assert found is before or found == before, each.name
        elif isinstance(before, torch.Tensor):
            assert torch.equal(found, before[chosen]), each.name
        else:
            assert found == tuple(before[row] for row in chosen), each.name


@given(st.sampled_from(FULL), st.data())
def test_rows_stay_together_in_every_field(whole: TaskSet, data: st.DataObject):
    chosen = data.draw(st.lists(st.integers(0, len(whole) - 1), max_size=2 * len(whole)))
    assert all(
        len(getattr(whole, each.name)) for each in fields(TaskSet) if each.name not in SHARED
    )
    assert_rows(whole.rows(chosen), whole, chosen)


@given(st.sampled_from(FULL), st.integers(1, 9))
def test_parts_are_the_set_in_order(whole: TaskSet, size: int):
    first = 0
    for part in whole.split(size):
        assert 0 < len(part) <= size
        assert_rows(part, whole, list(range(first, first + len(part))))
        first += len(part)
    assert first == len(whole)
    assert sum(map(len, whole.parts)) == len(whole)
    assert max(map(len, whole.parts)) <= CHUNK


def test_a_field_that_is_empty_stays_empty():
    (handed, *_) = sample_train_set(0).tasks
    bare = replace(handed, demonstrations=torch.empty(0, 0, 0).long(), expert=None)
    part = bare.rows([1, 0])
    assert (part.tasks, part.expert, len(part.demonstrations)) == ((), None, 0)
    assert part.commands == (handed.commands[1], handed.commands[0])


@pytest.mark.parametrize("whole", FULL, ids=lambda each: each.kind)
def test_every_tensor_goes_to_another_device_and_nothing_else_changes(whole: TaskSet):
    there = whole.to("meta")
    assert type(there) is TaskSet
    for each in fields(TaskSet):
        found, before = getattr(there, each.name), getattr(whole, each.name)
        if isinstance(before, torch.Tensor):
            assert (found.device.type, found.shape) == ("meta", before.shape), each.name
            assert found.dtype == before.dtype, each.name
        elif each.name != "views":
            assert found == before, each.name
    assert_rows(whole.to("cpu"), whole, list(range(len(whole))))


def test_sets_are_grouped_by_house_in_order():
    sets = tiny_task_sets()
    groups = by_house(sets)
    assert [tasks for group in groups for tasks in group] == list(sets)
    assert [group[0].scene.house.id for group in groups] == sorted(tiny_benchmark().houses)
    for group in groups:
        assert [tasks.kind for tasks in group] == list(Kind)
        assert len({id(tasks.views) for tasks in group}) == 1
        assert len({tasks.scene.house.id for tasks in group}) == 1
    mixed = by_house([sets[2], sets[0], sets[3]])
    assert mixed == ((sets[2], sets[3]), (sets[0],))
    cut = [tasks.rows([0]) for tasks in sets]
    assert [len(group) for group in by_house(cut)] == [len(group) for group in groups]
    assert by_house([]) == ()


@pytest.mark.parametrize("tasks", tiny_task_sets(), ids=lambda each: f"{each.kind}-{len(each)}")
def test_each_row_is_the_problem_of_its_task(tasks: TaskSet):
    for row, task in enumerate(tasks.tasks):
        one = one_task(tasks.scene, task)
        assert torch.equal(one.next_state[0], tasks.next_state[row])
        assert torch.equal(one.goal[0], tasks.goal[row])
        assert int(one.start[0]) == int(tasks.start[row])
        assert (one.horizon, one.discount) == (tasks.horizon, tasks.discount)
        assert tasks.rows([row]).task == task
        assert tasks.place(int(one.start[0])) == (task.start_tile, task.start_heading, 0)


@pytest.mark.parametrize(
    "tasks",
    [*tiny_task_sets(), *sample_train_set(0, oracle=True).tasks],
    ids=lambda each: f"{each.views.house}-{each.object_states}",
)
def test_where_interacting_takes_and_puts_is_where_it_is_tried(tasks: TaskSet):
    taken = torch.zeros(len(tasks), tasks.tiles, dtype=torch.bool)
    put = taken.clone()
    if tasks.object_states == 1:
        put = tasks.goal
    for row in range(len(tasks)):
        for state in range(tasks.states):
            tile, heading, before = tasks.place(state)
            found, facing, after = tasks.place(int(tasks.next_state[row, state, Action.INTERACT]))
            assert (found, facing) == (tile, heading), "interacting moves nobody"
            if (before, after) == (ObjectState.AT_A, ObjectState.HELD):
                taken[row, tile] = True
            if (before, after) == (ObjectState.HELD, ObjectState.AT_B):
                put[row, tile] = True
    assert torch.equal(tasks.object_tiles, taken)
    assert torch.equal(tasks.target_tiles, put)
    assert put.any(1).all() or tasks.object_states == 1


def test_an_object_is_taken_and_put_where_it_is_within_reach():
    for tasks in tiny_task_sets():
        if tasks.kind == Kind.NAV:
            assert not tasks.object_tiles.any()
            assert torch.equal(tasks.target_tiles, tasks.goal)
            continue
        scene = tasks.scene
        for row, task in enumerate(tasks.tasks):
            moved, placed = task.carried()
            for tiles, thing in (
                (tasks.object_tiles, scene.house.object(moved)),
                (tasks.target_tiles, placed),
            ):
                near = within_reach(scene.house, scene.grid, thing, scene.semantics)
                assert tiles[row].tolist() == near.tolist()


def test_states_are_laid_out_by_object_state_tile_and_heading():
    for tasks in tiny_task_sets():
        states = 1 if tasks.kind == Kind.NAV else OBJECT_STATES
        assert (tasks.object_states, tasks.tiles) == (states, tasks.scene.grid.tiles)
        assert tasks.states == states * tasks.tiles * HEADINGS
        places = [tasks.place(state) for state in range(tasks.states)]
        assert places == sorted(places, key=lambda place: (place[2], place[0], place[1]))
        assert len(set(places)) == tasks.states


def test_what_is_seen_in_a_state_is_its_panorama():
    for tasks in FULL:
        one = tasks.rows([len(tasks) - 1])
        for state in range(0, one.states, 7):
            number = int(tasks.panoramas[-1, state // HEADINGS])
            assert (one.panorama(state) == tasks.views.pixels(number)).all()


def test_a_set_of_several_has_no_only_task():
    with pytest.raises(ValueError, match="unpack"):
        _ = FULL[0].task
