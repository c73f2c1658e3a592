"""A task's proof against brute force over every action sequence."""

import dataclasses
import itertools

import numpy as np
import pytest
import torch
from grid_samples import strip
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.benchmarks.dynamics import nav_transitions
from lcrl_bench.benchmarks.proof import SLACK, start_table
from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch
from lcrl_bench.semantics import DEFAULT_SEMANTICS

SHORT = dataclasses.replace(DEFAULT_SEMANTICS, horizon=4)


def batch_of(table, goal, semantics=DEFAULT_SEMANTICS):
    """A batch of one task; `goal` is bool [cell], its start is of no account."""
    return TaskBatch(
        next_state=torch.from_numpy(table)[None],
        goal=torch.from_numpy(goal)[None],
        start=torch.tensor([0]),
        horizon=semantics.horizon,
        discount=semantics.discount,
    )


def enumerate_all(table, goal, state, semantics):
    """(shortest solution, best return, share of sequences that succeed), one sequence at a time."""
    shortest, best, solved, total = -1, -np.inf, 0, 0
    for actions in itertools.product(range(4), repeat=semantics.horizon):
        here, first, value = (
            state,
            0 if goal[state] else None,
            semantics.success_reward * goal[state],
        )
        for time, action in enumerate(actions, start=1):
            here = table[here, action]
            value += semantics.discount**time * semantics.success_reward * goal[here]
            first = time if first is None and goal[here] else first
        total += 1
        solved += first is not None
        best = max(best, value)
        if first is not None:
            shortest = first if shortest < 0 else min(shortest, first)
    return shortest, best, solved / total


@given(st.integers(1, 3), st.integers(0, 2**31 - 1))
@settings(max_examples=12)
def test_the_proof_of_every_start_is_what_enumeration_finds(cells, seed):
    rng = np.random.default_rng(seed)
    table = rng.integers(cells * HEADINGS, size=(cells * HEADINGS, 4))
    goal = rng.random(cells) < 0.3
    proved = start_table(batch_of(table, goal, SHORT), SHORT.success_reward)
    for state in range(len(table)):
        shortest, best, share = enumerate_all(table, goal.repeat(HEADINGS), state, SHORT)
        proof = proved.proof(state)
        assert proof.optimal_length == shortest
        assert proof.value == pytest.approx(best, abs=1e-9)
        assert proof.random_success == pytest.approx(share, abs=1e-9)


def test_a_start_beyond_the_horizon_is_not_admitted_and_nor_is_a_solved_one():
    batch = batch_of(nav_transitions(strip(40)), np.arange(40) == 39)
    admitted = start_table(batch, DEFAULT_SEMANTICS.success_reward).admitted(DEFAULT_SEMANTICS)
    east = admitted.reshape(40, 4)[:, 1]
    in_time = (1 - SLACK) * DEFAULT_SEMANTICS.horizon
    assert not any(east[39 - steps] for steps in range(40) if steps > in_time)
    assert all(east[39 - steps] for steps in range(10, 40) if steps <= in_time)
    assert not east[39], "solved where it starts"


def test_a_task_that_chance_solves_is_not_admitted():
    batch = batch_of(nav_transitions(strip(3)), np.arange(3) == 1)
    assert (
        not start_table(batch, DEFAULT_SEMANTICS.success_reward).admitted(DEFAULT_SEMANTICS).any()
    )
