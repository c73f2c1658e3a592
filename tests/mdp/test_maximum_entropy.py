"""Soft marginals: the derivative of the soft value, and those of the solved policy."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import random_batch, random_reward

from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.maximum_entropy import soft_marginals, soft_marginals_of
from lcrl_bench.mdp.planning import soft_q_iteration
from lcrl_bench.mdp.visitation import occupancy

laws = settings(derandomize=True, deadline=None, max_examples=25)
seeds = st.integers(0, 10_000)


@laws
@given(seeds, st.sampled_from([0.2, 1.0]), st.sampled_from([0.8, 1.0]))
def test_the_occupancy_is_the_derivative_of_the_start_value(seed, temperature, discount):
    batch = random_batch(seed, horizon=6, discount=discount)
    reward = random_reward(batch, seed)
    rho = soft_marginals(batch, reward, temperature=temperature).occupancy
    for cell in range(batch.cells):
        nudge = torch.zeros_like(reward)
        nudge[:, cell] = 1e-5
        above, below = (
            soft_marginals(batch, reward + sign * nudge, temperature=temperature).start_value
            for sign in (1, -1)
        )
        slope = (above - below) / 2e-5
        torch.testing.assert_close(slope, rho[:, cell], rtol=1e-6, atol=1e-7)


@laws
@given(seeds, st.sampled_from([0.1, 1.0]), st.sampled_from([0.0, 0.9, 1.0]))
def test_the_marginals_are_those_of_the_solved_policy(seed, temperature, discount):
    batch = random_batch(seed, cells=10, horizon=12, discount=discount)
    reward = random_reward(batch, seed)
    found = soft_marginals(batch, reward, temperature=temperature)
    solution = soft_q_iteration(batch, reward, temperature=temperature)
    rho = fold_cells(occupancy(batch, solution.policy, discount=discount))
    torch.testing.assert_close(found.occupancy, rho, rtol=1e-10, atol=1e-12)
    value = solution.values[torch.arange(len(batch)), 0, batch.start]
    torch.testing.assert_close(found.start_value, value, rtol=1e-12, atol=1e-12)


@laws
@given(seeds, st.sampled_from([torch.float32, torch.float64]))
def test_batches_solved_together_are_those_solved_alone(seed, dtype):
    batches = [random_batch(seed + k, tasks=k, cells=3 * k, horizon=9) for k in (1, 2, 3)]
    rewards = [random_reward(batch, seed).to(dtype) for batch in batches]
    together = soft_marginals_of(batches, rewards, temperature=0.7)
    for batch, reward, found in zip(batches, rewards, together, strict=True):
        alone = soft_marginals(batch, reward, temperature=0.7)
        torch.testing.assert_close(found.occupancy, alone.occupancy)
        torch.testing.assert_close(found.start_value, alone.start_value)


def test_batches_that_do_not_fit_together_are_refused():
    batches = [random_batch(0), random_batch(0, horizon=5)]
    rewards = [torch.zeros(2, 3)] * 2
    with pytest.raises(ValueError, match=r"found 4, 0.9, cpu, torch.float32; 5, 0.9, cpu, torch"):
        soft_marginals_of(batches, rewards, temperature=1.0)
    with pytest.raises(ValueError, match="discount, device and dtype, found no batch"):
        soft_marginals_of([], [], temperature=1.0)
    with pytest.raises(ValueError, match=r"argument 2 is shorter"):
        soft_marginals_of(batches, rewards[:1], temperature=1.0)


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_what_does_not_fit_is_refused_whatever_computes(dtype):
    batch = random_batch(0)
    with pytest.raises(ValueError, match="temperature must be positive, found 0"):
        soft_marginals(batch, torch.zeros(2, 3, dtype=dtype), temperature=0.0)
    with pytest.raises(ValueError, match="reward must be float"):
        soft_marginals(batch, torch.zeros(2, 4, dtype=dtype), temperature=1.0)
    with pytest.raises(ValueError, match="holds a NaN or an infinity"):
        soft_marginals(batch, torch.full((2, 3), torch.inf, dtype=dtype), temperature=1.0)
