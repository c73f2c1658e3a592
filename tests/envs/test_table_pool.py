"""Tables of many tasks end to end lead where the tasks' own lead, wherever they are moved."""

from __future__ import annotations

import numpy as np
import pytest
from environment_samples import CountingReward, sample_benchmark

from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.benchmarks.task_sets import TaskSets
from lcrl_bench.envs.reward_table import LearnedReward, RewardTable, TrueReward
from lcrl_bench.envs.table_pool import Column, TablePool

TASKS = sample_benchmark().tasks
BED, _, CUP, _ = (task for task in TASKS if task.house == "rooms-a")
OTHER_BED = next(task for task in TASKS if task.id == "rooms-b.go-to-the-bed")
SETS = TaskSets(sample_benchmark(), renderer="rays")


def make(
    selection: tuple[Task, ...] = TASKS, *, reward: RewardTable | None = None, houses_kept: int = 8
) -> TablePool:
    sets = TaskSets(sample_benchmark(), renderer="rays", houses_kept=1)
    return TablePool(sets, reward or TrueReward(10.0), selection, houses_kept=houses_kept)


def nobody() -> set[str]:
    return set()


def assert_holds(pool: TablePool, task: Task) -> None:
    """Every table holds what the task's own has in every state."""
    segment, row = pool.find(task, nobody)
    one = SETS.single(task)
    first = segment.first + row * one.states
    assert segment.first + segment.starts[row] == first + int(one.start[0])
    states = np.arange(first, first + one.states)
    cells = np.unique(states // 4)
    following = pool.next_state.rows.reshape(-1, 4)[states] - first
    assert (following == one.next_state[0].numpy()).all()
    assert (pool.goal.rows[cells] == one.goal[0].numpy()).all()
    assert (pool.held.rows[cells] == one.held[0].numpy()).all()
    assert set(pool.first_state.rows[cells]) == {first}
    for cell in cells[:: len(cells) // 9]:
        state = int(cell * 4 - first)
        seen = pool.views.rows[pool.cell_views.rows[cell]]
        tile, _, object_state = one.place(state)
        assert (seen == one.panorama(state)).all()
        assert (pool.tile.rows[cell], pool.object_state.rows[cell]) == (tile, object_state)


def test_tables_hold_what_the_tasks_tables_hold():
    pool = make()
    for task in TASKS:
        assert_holds(pool, task)
    assert len(pool) == 2


def test_tables_that_were_moved_hold_the_same():
    pool = make(houses_kept=1)
    pool.find(BED, nobody)
    _, row = pool.find(OTHER_BED, lambda: {"rooms-a"})
    assert (len(pool), pool.compactions) == (2, 0)
    # The house that is being played stays, and moves to where the other one was.
    pool._drop_some({"rooms-b"})
    assert (len(pool), pool.compactions) == (1, 1)
    segment, again = pool.find(OTHER_BED, nobody)
    assert (segment.first, segment.first_view, again) == (0, 0, row)
    for task in TASKS:
        if task.house == "rooms-b":
            assert_holds(pool, task)
    assert pool.compactions == 1


def test_the_house_played_longest_ago_is_dropped():
    pool = make(houses_kept=1)
    for task in (BED, OTHER_BED, CUP, OTHER_BED):
        assert_holds(pool, task)
        assert len(pool) == 1
    assert pool.compactions == 3


def test_only_kinds_that_are_played_are_loaded():
    pool = make((BED,))
    pool.find(BED, nobody)
    loaded = pool.next_state.size
    nav = [task for task in TASKS if task.house == "rooms-a" and task.kind == Kind.NAV]
    assert loaded == len(nav) * SETS.single(BED).states * 4
    assert_holds(pool, CUP)
    assert_holds(pool, BED)
    assert pool.next_state.size > loaded


def test_a_dropped_house_is_not_scored_again():
    reward = CountingReward()
    pool = make(reward=LearnedReward(reward), houses_kept=1)
    for task in (BED, OTHER_BED, BED, OTHER_BED):
        pool.find(task, nobody)
    assert sorted(reward.scored) == sorted(task.command for task in TASKS)


def test_a_cleared_pool_is_filled_anew():
    pool = make()
    pool.find(BED, nobody)
    pool.clear()
    assert (len(pool), pool.views.size) == (0, 0)
    assert_holds(pool, BED)


@pytest.mark.parametrize("sizes", [(1, 1, 1), (5, 0, 1, 300)])
def test_a_column_keeps_the_rows_it_is_given(sizes):
    column, rng = Column(np.int32, 2), np.random.default_rng(0)
    parts = [rng.integers(99, size=(size, 2)) for size in sizes]
    for part in parts:
        column.append(part)
    assert (column.rows[: column.size] == np.concatenate(parts)).all()
