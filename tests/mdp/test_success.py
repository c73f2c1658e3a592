"""Success probabilities and shortest ways, against enumeration and sampling."""

from __future__ import annotations

import itertools

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_batch, random_policy

from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.rollouts import sample_trajectories
from lcrl_bench.mdp.success import (
    UNREACHABLE,
    distance_to_goal,
    final_success_probability,
    optimal_length,
    success_probability,
    uniform_policy,
)

laws = settings(derandomize=True, deadline=None, max_examples=20)
seeds = st.integers(0, 10_000)


@laws
@given(seeds)
def test_success_is_the_mass_of_the_sequences_that_reach_the_goal(seed):
    batch = random_batch(seed)
    policy = random_policy(batch, seed)
    ever, last = torch.zeros(2).double(), torch.zeros(2).double()
    for task, actions in itertools.product(
        range(len(batch)), itertools.product(range(4), repeat=batch.horizon)
    ):
        state, weight = int(batch.start[task]), 1.0
        there = [bool(batch.goal[task, state // 4])]
        for t, action in enumerate(actions):
            weight *= float(policy[task, t, state, action])
            state = int(batch.next_state[task, state, action])
            there.append(bool(batch.goal[task, state // 4]))
        ever[task] += weight * any(there)
        last[task] += weight * there[-1]
    torch.testing.assert_close(success_probability(batch, policy), ever)
    torch.testing.assert_close(final_success_probability(batch, policy), last)


def test_success_is_the_share_of_sampled_episodes_that_reach_the_goal():
    batch = corridor(6, goal_cell=5)
    policy = uniform_policy(batch)
    generator = torch.Generator().manual_seed(2)
    states = sample_trajectories(batch, policy, episodes=20_000, generator=generator).states
    there = batch.goal[0][states[0] // 4]
    ever, last = there.any(-1).double().mean(), there[:, -1].double().mean()
    assert float(success_probability(batch, policy)) == pytest.approx(float(ever), abs=0.01)
    assert float(final_success_probability(batch, policy)) == pytest.approx(float(last), abs=0.01)


def test_the_expert_succeeds_with_certainty_in_time_and_never_too_late():
    exactly = corridor(10, goal_cell=9, horizon=11)
    assert success_probability(exactly, expert_policy(exactly, 10.0)).tolist() == [1.0]
    short = corridor(10, goal_cell=9, horizon=10)
    assert success_probability(short, expert_policy(short, 10.0)).tolist() == [0.0]


def test_a_start_at_the_goal_is_a_success_whatever_is_done():
    batch = corridor(6, goal_cell=0)
    assert success_probability(batch, uniform_policy(batch)).tolist() == [1.0]
    assert optimal_length(batch).tolist() == [0]


def test_a_goal_that_no_way_leads_to_has_no_length():
    batch = corridor(6, goal_cell=5)
    batch.next_state[0, :, 0] = torch.arange(24)
    assert optimal_length(batch).tolist() == [UNREACHABLE]


@laws
@given(seeds)
def test_distances_fall_by_one_along_a_shortest_way(seed):
    batch = random_batch(seed, cells=6)
    distance = distance_to_goal(batch)
    for task in range(len(batch)):
        for state in range(batch.states):
            here = int(distance[task, state])
            onward = [int(distance[task, s]) for s in batch.next_state[task, state].tolist()]
            reachable = [d for d in onward if d != UNREACHABLE]
            if bool(batch.goal[task, state // 4]):
                assert here == 0
            elif reachable:
                assert here == min(reachable) + 1
            else:
                assert here == UNREACHABLE


@laws
@given(seeds)
def test_sampled_actions_are_possible_and_lead_where_the_dynamics_say(seed):
    batch = random_batch(seed)
    policy = random_policy(batch, seed)
    generator = torch.Generator().manual_seed(seed)
    run = sample_trajectories(batch, policy, episodes=20, generator=generator)
    for task in range(len(batch)):
        assert bool((run.states[task, :, 0] == batch.start[task]).all())
        for t in range(batch.horizon):
            state, action = run.states[task, :, t], run.actions[task, :, t]
            assert bool((policy[task, t, state, action] > 1e-200).all())
            assert torch.equal(batch.next_state[task, state, action], run.states[task, :, t + 1])
