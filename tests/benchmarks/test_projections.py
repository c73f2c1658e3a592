"""Laws of rewards projected on what is seen."""

from dataclasses import replace

import pytest
import torch
from benchmark_samples import tiny_benchmark

from lcrl_bench.benchmarks.projections import (
    Projection,
    alike,
    episode_weights,
    project_reward,
    success_by_sight,
)
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_sets import house_task_sets
from lcrl_bench.mdp.success import distance_to_goal
from lcrl_bench.semantics import DEFAULT_SEMANTICS


@pytest.fixture(scope="module")
def sets():
    benchmark = tiny_benchmark()
    return house_task_sets(benchmark, next(iter(benchmark.houses)), renderer="rays")


@pytest.fixture(scope="module", params=list(Kind))
def tasks(sets, request):
    (found,) = [one for one in sets if one.kind == request.param]
    return found


@pytest.mark.parametrize("projection", list(Projection))
def test_what_looks_alike_is_paid_alike(tasks, projection):
    paid = project_reward(tasks, projection)
    looks = alike(tasks)
    for row in range(len(looks)):
        for look in looks[row].unique():
            assert len(paid[row][looks[row] == look].unique()) == 1
    assert paid.min() >= 0
    assert paid.max() <= DEFAULT_SEMANTICS.success_reward


def test_what_looks_like_nothing_else_is_paid_its_true_reward(tasks):
    looks = alike(tasks)
    possible = episode_weights(tasks) > 0
    compared = 0
    for projection in Projection:
        paid = project_reward(tasks, projection)
        for row in range(len(looks)):
            single = torch.bincount(looks[row])[looks[row]] == 1
            single &= possible[row]
            truth = tasks.goal[row][single] * DEFAULT_SEMANTICS.success_reward
            assert torch.equal(paid[row][single], truth.to(paid.dtype))
            compared += int(single.sum())
    assert compared


def test_the_certain_reward_is_the_least_and_is_paid_at_goals_only(tasks):
    certain = project_reward(tasks, Projection.CERTAIN)
    mean = project_reward(tasks, Projection.CELLS)
    assert (certain <= mean).all()
    assert (certain[~tasks.goal] == 0).all()
    assert (certain > 0).any()


def test_counting_each_cell_once_is_the_mean_over_equal_panoramas(tasks):
    mean = project_reward(tasks, Projection.CELLS)
    for row in range(len(tasks)):
        paid: dict[tuple[int, ...], list[float]] = {}
        looks = [
            tuple(views) for views in tasks.views.panorama_views[tasks.panoramas[row]].tolist()
        ]
        for look, goal in zip(looks, tasks.goal[row].tolist(), strict=True):
            paid.setdefault(look, []).append(10.0 * goal)
        expected = [sum(paid[look]) / len(paid[look]) for look in looks]
        assert mean[row].tolist() == pytest.approx(expected, abs=1e-9)


def test_the_certain_reward_solves_a_task_just_where_a_proof_can_be_seen_in_time(tasks):
    certain = project_reward(tasks, Projection.CERTAIN) > 0
    distance = distance_to_goal(replace(tasks, goal=certain))
    steps = distance.gather(1, tasks.start[:, None]).squeeze(1)
    provable = (steps >= 0) & (steps <= tasks.horizon)
    success = success_by_sight(tasks, Projection.CERTAIN)
    assert torch.equal(success >= 1 - 1e-9, provable)


def test_a_cell_weighs_as_many_steps_as_are_left_when_it_is_reached(tasks):
    weights = episode_weights(tasks)
    start = tasks.start // 4
    for row in range(len(tasks)):
        goal = torch.zeros_like(tasks.goal)
        for cell in (int(start[row]), int(weights[row].argmax()), tasks.cells - 1):
            goal.zero_()[row, cell] = True
            steps = int(distance_to_goal(replace(tasks, goal=goal))[row, tasks.start[row]])
            left = max(tasks.horizon + 1 - steps, 0) if steps >= 0 else 0
            # A way found needs `steps` actions; each of four headings fits the rest at most.
            assert bool(weights[row, cell] > 0) == (left > 0)
            assert weights[row, cell] <= 4 * left


def test_the_weights_of_one_step_count_what_one_action_leads_to(tasks):
    batch = replace(tasks, horizon=1)
    weights = episode_weights(batch)
    for row in range(len(batch)):
        first = int(batch.start[row])
        after = set(batch.next_state[row, first].tolist())
        expected = torch.zeros(batch.cells, dtype=weights.dtype)
        for state in [first, *after]:
            expected[state // 4] += 1
        assert torch.equal(weights[row], expected)
