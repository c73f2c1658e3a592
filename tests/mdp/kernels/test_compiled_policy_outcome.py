"""The compiled greedy outcome equals torch's within 1e-12, ties included, on any threads."""

from __future__ import annotations

import sys
from dataclasses import fields, replace

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_batch, random_reward

from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.policy_outcome import PolicyOutcome, follow, follow_greedy
from lcrl_bench.mdp.task_batch import TaskBatch

compiled = pytest.importorskip("lcrl_bench.mdp.kernels.policy_outcome")
laws = settings(derandomize=True, deadline=None, max_examples=30)
seeds = st.integers(0, 10_000)


@pytest.fixture(autouse=True)
def kernel(monkeypatch):
    """Compiled kernels, required."""
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")


def plain(batch: TaskBatch, reward: torch.Tensor, waypoint: torch.Tensor | None) -> PolicyOutcome:
    return follow(batch, q_iteration(batch, reward.double()).policy, waypoint=waypoint)


def assert_same(found: PolicyOutcome, expected: PolicyOutcome, tolerance: float) -> None:
    for field in fields(PolicyOutcome):
        left, right = getattr(found, field.name), getattr(expected, field.name)
        torch.testing.assert_close(left, right, rtol=tolerance, atol=tolerance)


@laws
@given(
    seed=seeds,
    cells=st.sampled_from([1, 3, 16, 40]),
    horizon=st.sampled_from([0, 1, 12, 30]),
    discount=st.sampled_from([0.0, 0.5, 0.99, 1.0]),
    digits=st.sampled_from([None, 0]),
    named=st.booleans(),
)
def test_the_kernel_agrees_with_torch(seed, cells, horizon, discount, digits, named):
    batch = random_batch(seed, tasks=3, cells=cells, horizon=horizon, discount=discount)
    reward = random_reward(batch, seed)
    # Whole numbers tie often.
    reward = reward if digits is None else reward.round()
    waypoint = batch.goal.roll(1, -1) if named else None
    found = follow_greedy(batch, reward, waypoint=waypoint)
    assert_same(found, plain(batch, reward, waypoint), 1e-12)


@laws
@given(seeds, st.sampled_from([0.9e-6, 1e-6, 1.1e-6]))
def test_the_kernel_draws_the_line_between_tied_and_not_where_torch_does(seed, gap):
    batch = random_batch(seed, cells=20, horizon=12, discount=1.0)
    reward = 1.0 + gap * random_reward(batch, seed).round()
    assert_same(follow_greedy(batch, reward), plain(batch, reward, None), 1e-12)


@pytest.mark.parametrize("goal_cell", [0, 7, 39])
def test_the_kernel_agrees_with_torch_in_a_corridor(goal_cell):
    batch = corridor(40, goal_cell=goal_cell)
    for reward in (true_reward(batch, 10.0), torch.full((1, 40), -1.0)):
        assert_same(follow_greedy(batch, reward), plain(batch, reward, None), 1e-12)


def test_the_kernel_gives_the_same_bits_on_one_thread_and_on_more():
    batch = random_batch(8, tasks=7, cells=50, horizon=20)
    reward = random_reward(batch, 8).round()
    before = torch.get_num_threads()
    outcomes = []
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            outcomes.append(follow_greedy(batch, reward, waypoint=batch.goal))
    finally:
        torch.set_num_threads(before)
    for other in outcomes[1:]:
        assert_same(other, outcomes[0], 0.0)


def test_the_kernel_takes_tables_of_any_layout():
    batch = random_batch(3, cells=30)
    reward = random_reward(batch, 3)
    table = batch.next_state.permute(2, 0, 1).contiguous().permute(1, 2, 0)
    rewards = reward.T.contiguous().T.requires_grad_()
    found = follow_greedy(replace(batch, next_state=table), rewards)
    assert_same(found, follow_greedy(batch, reward), 0.0)
    assert not found.goal_value.requires_grad


@pytest.mark.parametrize("choice", ["auto", "numba", "torch"])
def test_the_variable_chooses_what_computes(choice, monkeypatch):
    calls = []
    monkeypatch.setattr(compiled, "follow", lambda *arguments: calls.append(arguments))
    monkeypatch.setenv("LCRL_BENCH_KERNEL", choice)
    batch = random_batch(0)
    follow_greedy(batch, torch.zeros(2, 3))
    assert len(calls) == (choice != "torch")


def test_torch_computes_the_same_where_numba_is_not_installed(monkeypatch):
    batch = random_batch(0, cells=20, horizon=10)
    reward = random_reward(batch, 0)
    first = follow_greedy(batch, reward)
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, "lcrl_bench.mdp.kernels.policy_outcome")
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "auto")
    assert_same(follow_greedy(batch, reward), first, 1e-12)


@pytest.mark.parametrize("state", [-1, 12])
def test_the_kernel_refuses_a_transition_that_leads_nowhere(state):
    batch = random_batch(0)
    batch.next_state[1, 2, 3] = state
    with pytest.raises(ValueError, match=f"next_state leads to state {state}, outside 0 to 11"):
        follow_greedy(batch, torch.zeros(2, 3))


def test_what_does_not_fit_is_refused():
    batch = random_batch(0)
    with pytest.raises(ValueError, match="reward must be float"):
        follow_greedy(batch, torch.zeros(2, 4))
    with pytest.raises(ValueError, match="waypoint must be bool"):
        follow_greedy(batch, torch.zeros(2, 3), waypoint=torch.zeros(2, 3))
