"""Occupancies: visit counts, mass, duality with values, and repeatable bits."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_batch, random_policy, random_reward

from lcrl_bench.mdp.dynamics import fold_cells, spread_cells
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.planning import soft_q_iteration
from lcrl_bench.mdp.rollouts import rollout, sample_trajectories
from lcrl_bench.mdp.visitation import empirical_occupancy, occupancy, occupancy_mass

laws = settings(derandomize=True, deadline=None, max_examples=25)
seeds = st.integers(0, 10_000)
discounts = st.sampled_from([0.5, 0.99, 1.0])


@laws
@given(seeds, discounts)
def test_the_occupancy_of_a_deterministic_policy_is_its_visit_count(seed, discount):
    batch = random_batch(seed)
    actions = random_policy(batch, seed).argmax(-1)
    policy = torch.nn.functional.one_hot(actions, 4).double()
    states = rollout(batch, policy).states
    counts = torch.zeros(len(batch), batch.states, dtype=torch.float64)
    for task in range(len(batch)):
        for t, state in enumerate(states[task, 0].tolist()):
            counts[task, state] += discount**t
    torch.testing.assert_close(occupancy(batch, policy, discount=discount), counts)
    expert = empirical_occupancy(batch, states, discount=discount, dtype=torch.float64)
    torch.testing.assert_close(expert, counts)


@laws
@given(seeds, discounts)
def test_the_mass_of_an_occupancy_is_the_geometric_sum(seed, discount):
    batch = random_batch(seed)
    rho = occupancy(batch, random_policy(batch, seed), discount=discount)
    expected = sum(discount**t for t in range(batch.horizon + 1))
    assert occupancy_mass(batch.horizon, discount) == pytest.approx(expected)
    torch.testing.assert_close(rho.sum(-1), torch.full((len(batch),), expected).double())
    torch.testing.assert_close(fold_cells(rho).sum(-1), rho.sum(-1))


@laws
@given(seeds)
def test_the_occupancy_is_the_derivative_of_the_soft_value(seed):
    batch = random_batch(seed, tasks=1)
    reward = random_reward(batch, seed)
    policy = soft_q_iteration(batch, reward, temperature=0.6).policy
    rho = fold_cells(occupancy(batch, policy, discount=batch.discount))[0]
    for cell in range(batch.cells):
        nudge = torch.zeros_like(reward)
        nudge[0, cell] = 1e-5
        ends = [
            soft_q_iteration(batch, reward + sign * nudge, temperature=0.6).values[
                0, 0, batch.start[0]
            ]
            for sign in (1, -1)
        ]
        assert float((ends[0] - ends[1]) / 2e-5) == pytest.approx(float(rho[cell]), abs=1e-7)


@laws
@given(seeds)
def test_the_occupancy_weighs_rewards_into_the_return(seed):
    batch = random_batch(seed)
    policy = random_policy(batch, seed)
    reward = spread_cells(random_reward(batch, seed))
    value = reward.clone()
    for t in reversed(range(batch.horizon)):
        onward = torch.stack([value[task][batch.next_state[task]] for task in range(len(batch))])
        value = reward + batch.discount * (policy[:, t] * onward).sum(-1)
    rho = occupancy(batch, policy, discount=batch.discount)
    expected = value[torch.arange(len(batch)), batch.start]
    torch.testing.assert_close((rho * reward).sum(-1), expected)


def test_many_sampled_trajectories_have_the_occupancy_of_their_policy():
    batch = random_batch(5, horizon=6)
    policy = random_policy(batch, 5)
    generator = torch.Generator().manual_seed(1)
    states = sample_trajectories(batch, policy, episodes=40_000, generator=generator).states
    found = empirical_occupancy(batch, states, discount=0.9, dtype=torch.float64)
    torch.testing.assert_close(found, occupancy(batch, policy, discount=0.9), rtol=0, atol=0.02)


def test_the_bits_of_an_occupancy_do_not_depend_on_threads():
    batch = random_batch(8, tasks=20, cells=200, horizon=10)
    policy = random_policy(batch, 8).float()
    before = torch.get_num_threads()
    results = []
    try:
        for threads in (1, 2, 2):
            torch.set_num_threads(threads)
            results.append(occupancy(batch, policy, discount=0.99))
    finally:
        torch.set_num_threads(before)
    assert torch.equal(results[0], results[1])
    assert torch.equal(results[1], results[2])


def test_a_policy_that_does_not_sum_to_one_is_refused():
    batch = corridor(4, goal_cell=3)
    with pytest.raises(ValueError, match="does the policy sum to one"):
        occupancy(batch, expert_policy(batch, 10.0) * 1.01, discount=0.99)


def test_a_policy_of_another_shape_is_refused():
    batch = corridor(4, goal_cell=3)
    with pytest.raises(ValueError, match=r"\[task, horizon, state, action\] = \[1, 30, 16, 4\]"):
        occupancy(batch, torch.full((1, 16, 4), 0.25), discount=0.99)


def test_demonstrations_of_another_length_are_refused():
    batch = corridor(4, goal_cell=3)
    with pytest.raises(ValueError, match=r"\[1, at least 1, 31\], found \[1, 2, 30\]"):
        empirical_occupancy(batch, torch.zeros(1, 2, 30, dtype=torch.int64), discount=0.99)
