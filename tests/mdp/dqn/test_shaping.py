"""A potential changes what a transition is paid, and no optimal policy."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from mdp_samples import random_batch, random_reward

from lcrl_bench.mdp.dqn.shaping import optimal_values, shaped_reward
from lcrl_bench.mdp.planning import q_iteration

GAMMA = 0.9


def paid(batch, reward, phi):
    """R(s, a) of every transition: float64 [task, state, action]."""
    states = torch.arange(batch.states).repeat_interleave(4).expand(len(batch), -1)
    successors = batch.next_state.reshape(len(batch), -1)
    table = shaped_reward(reward, phi, states, successors, discount=GAMMA)
    return table.view(len(batch), batch.states, 4)


def optimal_q(batch, payment, sweeps=400):
    """Q* of an endless discounted task, by repeated backups: float64 [task, state, action]."""
    q = torch.zeros_like(payment)
    successors = batch.next_state.reshape(len(batch), -1)
    for _ in range(sweeps):
        q = payment + GAMMA * q.amax(-1).gather(1, successors).view_as(q)
    return q


@given(seed=st.integers(0, 10_000))
def test_any_potential_shifts_values_and_leaves_advantages(seed):
    batch = random_batch(seed)
    reward = random_reward(batch, seed)
    phi = 5.0 * torch.randn(
        len(batch),
        batch.states,
        generator=torch.Generator().manual_seed(seed),
        dtype=torch.float64,
    )
    plain = optimal_q(batch, paid(batch, reward, None))
    shaped = optimal_q(batch, paid(batch, reward, phi))
    torch.testing.assert_close(shaped + phi[..., None], plain, rtol=0, atol=1e-9)


@given(seed=st.integers(0, 10_000))
def test_shaped_by_its_own_values_a_reward_pays_nothing_but_regret(seed):
    batch = random_batch(seed)
    plain = optimal_q(batch, paid(batch, random_reward(batch, seed), None))
    shaped = paid(batch, random_reward(batch, seed), plain.amax(-1))
    assert float(shaped.max()) <= 1e-9
    torch.testing.assert_close(shaped, plain - plain.amax(-1, keepdim=True), rtol=0, atol=1e-9)


def test_the_papers_potential_is_the_value_at_the_first_step():
    batch = random_batch(3)
    reward = random_reward(batch, 3)
    expected = q_iteration(batch, reward).values[:, 0]
    torch.testing.assert_close(optimal_values(batch, reward).double(), expected, rtol=1e-6, atol=0)


def test_a_transition_is_paid_for_where_it_leads():
    rewards = torch.tensor([[1.0, 2.0, 4.0]])
    found = shaped_reward(
        rewards, None, torch.tensor([[0, 4]]), torch.tensor([[5, 11]]), discount=GAMMA
    )
    assert found.tolist() == [[pytest.approx(2.0), pytest.approx(4.0)]]
