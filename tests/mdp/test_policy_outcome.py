"""Outcomes against enumeration of every action sequence, and against the other sums."""

from __future__ import annotations

import itertools

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_batch, random_policy, random_reward

from lcrl_bench.mdp.dynamics import spread_cells
from lcrl_bench.mdp.expert import expert_policy, true_reward
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.policy_outcome import follow, follow_greedy
from lcrl_bench.mdp.success import (
    final_success_probability,
    optimal_length,
    success_probability,
    uniform_policy,
)
from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.mdp.visitation import occupancy

laws = settings(derandomize=True, deadline=None, max_examples=20)
seeds = st.integers(0, 10_000)
WAYPOINT = torch.tensor([[True, False, False], [False, True, True]])


def enumerated(batch: TaskBatch, policy: torch.Tensor, waypoint: torch.Tensor) -> dict:
    """An outcome, from the weight of every one of the 4^H action sequences."""
    tasks, steps = len(batch), batch.horizon + 1
    arrival = torch.zeros(tasks, steps, dtype=torch.float64)
    final = torch.zeros(tasks, batch.states, dtype=torch.float64)
    lost, missed = torch.zeros_like(final), torch.zeros_like(final)
    goal_value, passed = arrival.new_zeros(tasks), arrival.new_zeros(tasks)
    for task, actions in itertools.product(
        range(tasks), itertools.product(range(4), repeat=batch.horizon)
    ):
        states, weight = [int(batch.start[task])], 1.0
        for t, action in enumerate(actions):
            weight *= float(policy[task, t, states[-1], action])
            states.append(int(batch.next_state[task, states[-1], action]))
        there = [bool(batch.goal[task, state // 4]) for state in states]
        final[task, states[-1]] += weight
        if any(there):
            arrival[task, there.index(True)] += weight
        else:
            lost[task, states[-1]] += weight
        goal_value[task] += weight * sum(batch.discount**t for t in range(steps) if there[t])
        visited = any(bool(waypoint[task, state // 4]) for state in states)
        passed[task] += weight * visited
        missed[task, states[-1]] += weight * (not visited)
    fields = {"arrival": arrival, "final": final, "lost": lost, "missed": missed}
    return fields | {"goal_value": goal_value, "passed": passed}


@laws
@given(seeds, st.sampled_from([0.9, 1.0]))
def test_an_outcome_is_the_weight_of_the_action_sequences_that_make_it(seed, discount):
    batch = random_batch(seed, discount=discount)
    policy = random_policy(batch, seed)
    outcome = follow(batch, policy, waypoint=WAYPOINT)
    for name, expected in enumerated(batch, policy, WAYPOINT).items():
        torch.testing.assert_close(getattr(outcome, name), expected, rtol=1e-12, atol=1e-12)


@laws
@given(seeds)
def test_an_outcome_tells_both_kinds_of_success(seed):
    batch = random_batch(seed, cells=20, horizon=12)
    policy = random_policy(batch, seed)
    outcome = follow(batch, policy)
    close = {"rtol": 1e-12, "atol": 1e-12}
    torch.testing.assert_close(outcome.success, success_probability(batch, policy), **close)
    torch.testing.assert_close(1 - outcome.lost.sum(-1), outcome.success, **close)
    last = (outcome.final * spread_cells(batch.goal)).sum(-1)
    torch.testing.assert_close(last, final_success_probability(batch, policy), **close)


@laws
@given(seeds)
def test_the_goal_value_is_the_return_of_the_true_reward(seed):
    batch = random_batch(seed, cells=20, horizon=12)
    policy = random_policy(batch, seed)
    reward = spread_cells(true_reward(batch, 10.0, dtype=torch.float64))
    rho = occupancy(batch, policy, discount=batch.discount)
    expected = (rho * reward).sum(-1)
    torch.testing.assert_close(10.0 * follow(batch, policy).goal_value, expected)


@laws
@given(seeds)
def test_no_policy_has_a_larger_goal_value_than_the_expert(seed):
    batch = random_batch(seed, cells=20, horizon=12)
    best = q_iteration(batch, true_reward(batch, 1.0, dtype=torch.float64)).values[:, 0]
    best = best.gather(1, batch.start[:, None])[:, 0]
    expert = follow(batch, expert_policy(batch, 10.0)).goal_value
    torch.testing.assert_close(expert, best)
    assert bool((follow(batch, random_policy(batch, seed)).goal_value <= best + 1e-12).all())


@laws
@given(seeds)
def test_the_goal_as_waypoint_is_passed_with_the_probability_of_success(seed):
    batch = random_batch(seed, cells=20, horizon=12)
    outcome = follow(batch, random_policy(batch, seed), waypoint=batch.goal)
    torch.testing.assert_close(outcome.passed, outcome.success)


@laws
@given(seeds)
def test_the_greedy_outcome_is_that_of_the_solved_policy(seed):
    batch = random_batch(seed, cells=20, horizon=12)
    reward = random_reward(batch, seed).float()
    waypoint = batch.goal.roll(1, -1)
    found = follow_greedy(batch, reward, waypoint=waypoint)
    expected = follow(batch, q_iteration(batch, reward.double()).policy, waypoint=waypoint)
    for name in ("arrival", "final", "lost", "goal_value", "passed", "missed"):
        left, right = getattr(found, name), getattr(expected, name)
        torch.testing.assert_close(left, right, rtol=1e-12, atol=1e-12)


def test_the_expert_arrives_at_its_shortest_length():
    batch = corridor(10, goal_cell=7)
    outcome = follow(batch, expert_policy(batch, 10.0))
    assert outcome.arrival[0].nonzero().tolist() == [optimal_length(batch).tolist()]
    assert float(outcome.success) == 1.0
    assert float(outcome.lost.sum()) == 0.0


def test_a_start_at_the_goal_is_an_arrival_at_once():
    batch = corridor(6, goal_cell=0)
    outcome = follow(batch, uniform_policy(batch), waypoint=batch.goal)
    assert outcome.arrival[0, 0] == 1.0
    assert float(outcome.passed) == 1.0


def test_without_a_waypoint_none_is_passed():
    batch = corridor(6, goal_cell=0)
    assert follow(batch, uniform_policy(batch)).passed.tolist() == [0.0]


@pytest.mark.parametrize("waypoint", [torch.zeros(1, 6), torch.zeros(1, 5, dtype=torch.bool)])
def test_a_waypoint_that_does_not_fit_is_refused(waypoint):
    batch = corridor(6, goal_cell=0)
    message = r"must be bool \[task, cell\] = \[1, 6\], found torch"
    with pytest.raises(ValueError, match=message):
        follow(batch, uniform_policy(batch), waypoint=waypoint)
    with pytest.raises(ValueError, match=message):
        follow_greedy(batch, torch.zeros(1, 6), waypoint=waypoint)
