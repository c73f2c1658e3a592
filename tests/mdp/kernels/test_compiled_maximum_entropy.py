"""The compiled soft marginals equal torch's in float64 within 1e-5, on any number of threads."""

from __future__ import annotations

import sys
from dataclasses import replace

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_batch, random_reward

from lcrl_bench.mdp.maximum_entropy import Marginals, soft_marginals
from lcrl_bench.mdp.task_batch import TaskBatch
from lcrl_bench.mdp.visitation import occupancy_mass

laws = settings(derandomize=True, deadline=None, max_examples=25)
seeds = st.integers(0, 10_000)


def assert_close(found: Marginals, exact: Marginals) -> None:
    """Within 1e-5 of the exact figures, cell by cell, however rarely a cell is visited."""
    assert (found.occupancy.dtype, found.start_value.dtype) == (torch.float32, torch.float32)
    close = {"rtol": 1e-5, "atol": 1e-12}
    torch.testing.assert_close(found.occupancy.double(), exact.occupancy, **close)
    # A value is a difference of rewards, which are rounded to float32 beforehand.
    close = {"rtol": 1e-5, "atol": 1e-5}
    torch.testing.assert_close(found.start_value.double(), exact.start_value, **close)


@pytest.fixture
def kernel(monkeypatch):
    """Compiled kernels, required."""
    pytest.importorskip("numba")
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")


@laws
@given(
    seed=seeds,
    cells=st.sampled_from([1, 3, 16, 17, 40]),
    horizon=st.sampled_from([0, 1, 2, 13, 30]),
    discount=st.sampled_from([0.0, 0.5, 0.99, 1.0]),
    temperature=st.sampled_from([1e-3, 0.1, 1.0, 30.0]),
    scale=st.sampled_from([0.0, 1e-4, 1.0, 20.0]),
)
def test_the_kernel_agrees_with_torch(seed, cells, horizon, discount, temperature, scale):
    pytest.importorskip("numba")
    batch = random_batch(seed, tasks=3, cells=cells, horizon=horizon, discount=discount)
    reward = (scale * random_reward(batch, seed)).float()
    exact = soft_marginals(batch, reward.double(), temperature=temperature)
    assert_close(soft_marginals(batch, reward, temperature=temperature), exact)


@pytest.mark.parametrize("temperature", [0.05, 1.0])
@pytest.mark.parametrize("goal_cell", [0, 9])
def test_the_kernel_agrees_with_torch_in_a_corridor(kernel, temperature, goal_cell):
    batch = corridor(40, goal_cell=goal_cell)
    reward = 10.0 * batch.goal.float()
    exact = soft_marginals(batch, reward.double(), temperature=temperature)
    assert_close(soft_marginals(batch, reward, temperature=temperature), exact)


def test_the_kernel_finds_no_visit_where_none_can_be(kernel):
    batch = corridor(40, goal_cell=39)
    rho = soft_marginals(batch, torch.zeros(1, 40), temperature=1.0).occupancy[0]
    # Two turns, then 28 steps forward.
    assert rho.nonzero().flatten().tolist() == list(range(29))
    assert float(rho.sum()) == pytest.approx(occupancy_mass(30, 0.99), rel=1e-6)


def test_the_kernel_stands_a_temperature_near_zero(kernel):
    batch = random_batch(1, cells=20, horizon=10)
    reward = random_reward(batch, 1).float()
    cold, cool = (soft_marginals(batch, reward, temperature=t) for t in (1e-300, 1e-6))
    torch.testing.assert_close(cold.occupancy, cool.occupancy)


def test_the_kernel_gives_the_same_bits_on_one_thread_and_on_more(kernel):
    batch = random_batch(8, tasks=7, cells=50, horizon=20)
    reward = random_reward(batch, 8).float()
    before = torch.get_num_threads()
    results = []
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            results.append(soft_marginals(batch, reward, temperature=1.0))
    finally:
        torch.set_num_threads(before)
    for other in results[1:]:
        assert torch.equal(results[0].occupancy, other.occupancy)
        assert torch.equal(results[0].start_value, other.start_value)


def test_the_kernel_solves_a_task_as_if_it_were_alone(kernel):
    both = random_batch(11, tasks=2, cells=30, horizon=10)
    reward = random_reward(both, 11).float()
    together = soft_marginals(both, reward, temperature=1.0)
    parts = both.next_state[1:], both.goal[1:], both.start[1:]
    alone = soft_marginals(TaskBatch(*parts, 10, 0.9), reward[1:], temperature=1.0)
    assert torch.equal(together.occupancy[1:], alone.occupancy)
    assert torch.equal(together.start_value[1:], alone.start_value)


def test_the_kernel_takes_tables_of_any_layout(kernel):
    batch = random_batch(3, cells=30)
    reward = random_reward(batch, 3).float()
    table = batch.next_state.permute(2, 0, 1).contiguous().permute(1, 2, 0)
    strided = replace(batch, next_state=table)
    rewards = reward.T.contiguous().T.requires_grad_()
    found = soft_marginals(strided, rewards, temperature=1.0)
    assert torch.equal(found.occupancy, soft_marginals(batch, reward, temperature=1.0).occupancy)
    assert not found.occupancy.requires_grad


@pytest.mark.parametrize("choice", ["auto", "numba", "torch"])
def test_the_variable_chooses_what_computes(choice, monkeypatch):
    compiled = pytest.importorskip("lcrl_bench.mdp.kernels.maximum_entropy")
    calls = []
    monkeypatch.setattr(compiled, "solve", lambda *arguments: calls.append(arguments))
    monkeypatch.setenv("LCRL_BENCH_KERNEL", choice)
    batch = random_batch(0)
    soft_marginals(batch, torch.zeros(2, 3), temperature=1.0)
    assert len(calls) == (choice != "torch")
    soft_marginals(batch, torch.zeros(2, 3).double(), temperature=1.0)
    assert len(calls) == (choice != "torch")


def test_torch_computes_the_same_where_numba_is_not_installed(monkeypatch):
    batch = random_batch(0, cells=20, horizon=10)
    reward = random_reward(batch, 0).float()
    first = soft_marginals(batch, reward, temperature=1.0)
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, "lcrl_bench.mdp.kernels.maximum_entropy", raising=False)
    monkeypatch.delenv("LCRL_BENCH_KERNEL", raising=False)
    second = soft_marginals(batch, reward, temperature=1.0)
    torch.testing.assert_close(first.occupancy, second.occupancy, rtol=1e-4, atol=1e-6)
    torch.testing.assert_close(first.start_value, second.start_value, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("state", [-1, 12])
def test_the_kernel_refuses_a_transition_that_leads_nowhere(kernel, state):
    batch = random_batch(0)
    batch.next_state[1, 2, 3] = state
    with pytest.raises(ValueError, match=f"next_state leads to state {state}, outside 0 to 11"):
        soft_marginals(batch, torch.zeros(2, 3), temperature=1.0)


def test_the_kernel_refuses_a_start_that_is_nowhere(kernel):
    batch = replace(random_batch(0), start=torch.tensor([0, 12]))
    with pytest.raises(ValueError, match="start leads to state 12, outside 0 to 11"):
        soft_marginals(batch, torch.zeros(2, 3), temperature=1.0)
