"""Compiled agents draw, act and learn as torch's do, alone as in company, on any thread."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest
import torch
from mdp_samples import random_batch

from lcrl_bench.mdp.dqn.agents import DqnAgents
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.learning import act_and_learn
from lcrl_bench.mdp.dqn.stack import TaskStack

pytest.importorskip("numba")

CONFIG = DqnConfig(
    steps=3_000, episodes=5, hidden=24, batch=7, replay=40, target_interval=3, shaping="none"
)
TASKS = 5

Trained = tuple[DqnAgents, torch.optim.Optimizer]


def begin(config: DqnConfig = CONFIG) -> Trained:
    """Agents of random tasks, that have learned nothing yet."""
    stack = TaskStack.of([random_batch(3, tasks=3, cells=9), random_batch(4, tasks=2, cells=6)])
    agents = DqnAgents(stack, config, seeds=torch.arange(TASKS))
    return agents, torch.optim.AdamW(agents.networks.parameters(), lr=3e-3, weight_decay=0.0)


def draw(stack: TaskStack, *, per_cell: bool) -> torch.Tensor:
    """A number for every cell, or for every state."""
    width = stack.states // 4 if per_cell else stack.states
    return torch.randn(TASKS, width, generator=torch.Generator().manual_seed(width))


def go_on(trained: Trained, rounds: int, *, shaped: bool = False) -> float:
    """Let them learn from random rewards."""
    agents, optimizer = trained
    phi = draw(agents.stack, per_cell=False) if shaped else None
    return act_and_learn(agents, draw(agents.stack, per_cell=True), phi, optimizer, rounds=rounds)


def assert_equal(found: Trained, expected: Trained) -> None:
    """Agents and moments, to the bit."""
    for mine, its in zip(found, expected, strict=True):
        torch.testing.assert_close(mine.state_dict(), its.state_dict(), rtol=0, atol=0)


@pytest.mark.parametrize("shaped", [False, True])
@pytest.mark.parametrize("double", [False, True])
def test_every_round_is_that_of_torch_within_rounding(double, shaped, monkeypatch):
    its = begin(replace(CONFIG, double=double))
    # Until rewards differ: the spread of nearly equal ones is rounding error.
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
    go_on(its, 3, shaped=shaped)
    for _ in range(12):
        # Adam makes whole steps of rounding errors, so both go on from the same weights.
        mine = copy.deepcopy(its)
        monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
        loss = go_on(mine, 1, shaped=shaped)
        monkeypatch.setenv("LCRL_BENCH_KERNEL", "torch")
        assert loss == pytest.approx(go_on(its, 1, shaped=shaped), rel=1e-5)
        for (name, found), (_, wanted) in zip(named(mine), named(its), strict=True):
            if wanted.is_floating_point():
                size = float(wanted.abs().max())
                assert float((found - wanted).abs().max()) <= 1e-5 * size, name
            else:
                assert torch.equal(found, wanted), name


def named(trained: Trained) -> list[tuple[str, torch.Tensor]]:
    """All that learning changes but the weights, and of these the steps."""
    agents, optimizer = trained
    parts = [each for each in agents.state_dict().items() if not each[0].startswith("networks")]
    for number, state in optimizer.state_dict()["state"].items():
        parts += [(f"{name} of {number}", value) for name, value in state.items()]
    return parts


def test_a_step_goes_where_the_moments_say(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    agents, optimizer = begin()
    for count in (1, 2, 3):
        before = [layer.detach().clone() for layer in agents.networks.layers]
        go_on((agents, optimizer), 1)
        for layer, old in zip(agents.networks.layers, before, strict=True):
            state = optimizer.state[layer]
            mean = state["exp_avg"] / (1 - 0.9**count)
            spread = (state["exp_avg_sq"] / (1 - 0.999**count)).sqrt()
            torch.testing.assert_close(layer.detach(), old - 3e-3 * mean / (spread + 1e-8))


def test_rounds_may_be_taken_in_parts(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    whole, parts = begin(), begin()
    go_on(whole, 11)
    for rounds in (4, 1, 6):
        go_on(parts, rounds)
    assert_equal(parts, whole)


def test_agents_learn_to_the_same_bits_on_one_thread_and_on_more(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    before, results = torch.get_num_threads(), []
    try:
        for threads in (1, 2, 3):
            torch.set_num_threads(threads)
            results.append(begin())
            go_on(results[-1], 20)
    finally:
        torch.set_num_threads(before)
    for other in results[1:]:
        assert_equal(other, results[0])


def test_what_torch_began_goes_on_compiled(monkeypatch):
    trained = begin()
    for kernel in ("torch", "numba", "torch"):
        monkeypatch.setenv("LCRL_BENCH_KERNEL", kernel)
        go_on(trained, 4)
    agents, optimizer = trained
    assert int(agents.learned) == int(agents.rounds) == 12
    assert {int(state["step"]) for state in optimizer.state.values()} == {12}


def test_a_transition_to_nowhere_never_reaches_the_kernel(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    agents, optimizer = begin()
    agents.stack.next_state[0, 0, 0] = agents.stack.states
    with pytest.raises(ValueError, match="next_state leads to state 36, outside 0 to 35"):
        go_on((agents, optimizer), 1)


def test_with_other_depths_torch_computes(monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", "numba")
    trained = begin(replace(CONFIG, layers=3))
    go_on(trained, 2)
    assert int(trained[0].learned) == 2
