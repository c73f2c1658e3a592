"""Both solvers against all action sequences, and the laws of their recurrences."""

from __future__ import annotations

import itertools
import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_batch, random_reward

from lcrl_bench.mdp.dynamics import fold_cells, spread_cells
from lcrl_bench.mdp.expert import expert_policy, true_reward
from lcrl_bench.mdp.planning import q_iteration, soft_q_iteration
from lcrl_bench.mdp.rollouts import rollout, sample_trajectories
from lcrl_bench.mdp.success import optimal_length, success_probability
from lcrl_bench.mdp.task_batch import ACTIONS, TaskBatch
from lcrl_bench.mdp.visitation import empirical_occupancy, occupancy

laws = settings(derandomize=True, deadline=None, max_examples=25)
seeds = st.integers(0, 10_000)


def returns_of_all_sequences(batch: TaskBatch, reward: torch.Tensor, task: int) -> torch.Tensor:
    """The discounted return of every one of the 4^H action sequences of a task."""
    cells = spread_cells(reward)[task].tolist()
    step = batch.next_state[task].tolist()
    totals = []
    for actions in itertools.product(range(ACTIONS), repeat=batch.horizon):
        state = int(batch.start[task])
        total = cells[state]
        for t, action in enumerate(actions):
            state = step[state][action]
            total += batch.discount ** (t + 1) * cells[state]
        totals.append(total)
    return torch.tensor(totals, dtype=torch.float64)


def start_values(batch: TaskBatch, values: torch.Tensor) -> torch.Tensor:
    return values[torch.arange(len(batch)), 0, batch.start]


@laws
@given(seeds, st.sampled_from([0.5, 0.9, 1.0]))
def test_the_hard_value_is_the_best_return_of_all_action_sequences(seed, discount):
    batch = random_batch(seed, discount=discount)
    reward = random_reward(batch, seed)
    found = start_values(batch, q_iteration(batch, reward).values)
    expected = [returns_of_all_sequences(batch, reward, task).max() for task in range(len(batch))]
    torch.testing.assert_close(found, torch.stack(expected), rtol=1e-12, atol=1e-12)


@laws
@given(seeds, st.sampled_from([0.1, 1.0, 3.0]))
def test_the_undiscounted_soft_value_is_the_log_sum_of_all_action_sequences(seed, temperature):
    batch = random_batch(seed, discount=1.0)
    reward = random_reward(batch, seed)
    found = start_values(batch, soft_q_iteration(batch, reward, temperature=temperature).values)
    for task in range(len(batch)):
        returns = returns_of_all_sequences(batch, reward, task)
        expected = temperature * torch.logsumexp(returns / temperature, 0)
        torch.testing.assert_close(found[task], expected, rtol=1e-12, atol=1e-12)


@laws
@given(seeds, st.sampled_from([0.2, 1.0]), st.sampled_from([0.7, 1.0]))
def test_the_soft_solution_obeys_the_published_recurrences(seed, temperature, discount):
    batch = random_batch(seed, discount=discount)
    reward = random_reward(batch, seed)
    solution = soft_q_iteration(batch, reward, temperature=temperature)
    r = spread_cells(reward)
    torch.testing.assert_close(solution.values[:, batch.horizon], r)
    for t in range(batch.horizon):
        for task in range(len(batch)):
            v_next = solution.values[task, t + 1][batch.next_state[task]]
            q = r[task][:, None] + discount * v_next
            v = temperature * torch.logsumexp(q / temperature, -1)
            torch.testing.assert_close(solution.values[task, t], v, rtol=1e-12, atol=1e-12)
            policy = torch.exp((q - v[:, None]) / temperature)
            torch.testing.assert_close(solution.policy[task, t], policy, rtol=1e-10, atol=1e-12)


@laws
@given(seeds, st.sampled_from([0.3, 1.0]), st.sampled_from([0.8, 1.0]))
def test_the_occupancy_difference_is_the_gradient_of_the_likelihood(seed, temperature, discount):
    batch = random_batch(seed, tasks=1, discount=discount)
    reward = random_reward(batch, seed)
    demonstrator = soft_q_iteration(batch, random_reward(batch, seed + 1), temperature=0.5).policy
    generator = torch.Generator().manual_seed(seed)
    demos = sample_trajectories(batch, demonstrator, episodes=3, generator=generator)

    def log_likelihood(values: torch.Tensor) -> float:
        policy = soft_q_iteration(batch, values, temperature=temperature).policy[0]
        total = 0.0
        for states, actions in zip(demos.states[0], demos.actions[0], strict=True):
            for t in range(batch.horizon):
                total += discount**t * float(policy[t, states[t], actions[t]].log())
        return total / len(demos.states[0])

    policy = soft_q_iteration(batch, reward, temperature=temperature).policy
    expert = empirical_occupancy(batch, demos.states, discount=discount, dtype=torch.float64)
    learner = occupancy(batch, policy, discount=discount)
    gradient = fold_cells(expert - learner)[0] / temperature
    for cell in range(batch.cells):
        nudge = torch.zeros_like(reward)
        nudge[0, cell] = 1e-5
        slope = (log_likelihood(reward + nudge) - log_likelihood(reward - nudge)) / 2e-5
        assert math.isclose(slope, float(gradient[cell]), rel_tol=1e-6, abs_tol=1e-7)


@laws
@given(seeds)
def test_the_soft_solution_tends_to_the_hard_one_as_the_temperature_falls(seed):
    batch = random_batch(seed)
    reward = random_reward(batch, seed)
    hard = q_iteration(batch, reward)
    gaps = [
        float((soft_q_iteration(batch, reward, temperature=a).values - hard.values).abs().max())
        for a in (1.0, 0.1, 0.01, 0.001)
    ]
    assert gaps == sorted(gaps, reverse=True)
    # At most alpha log 4 of entropy a step.
    assert gaps[-1] <= 0.001 * math.log(ACTIONS) * batch.horizon + 1e-12


@laws
@given(seeds, st.floats(-50, 50))
def test_a_constant_reward_gives_the_random_policy(seed, constant):
    batch = random_batch(seed)
    reward = torch.full((len(batch), batch.cells), constant)
    for solution in (q_iteration(batch, reward), soft_q_iteration(batch, reward, temperature=1.0)):
        torch.testing.assert_close(
            solution.policy, torch.full_like(solution.policy, 0.25), rtol=1e-4, atol=1e-4
        )


@laws
@given(seeds, st.floats(0.01, 100), st.floats(-5, 5))
def test_scaling_and_shifting_the_reward_leaves_the_hard_policy(seed, scale, shift):
    batch = random_batch(seed)
    reward = random_reward(batch, seed)
    expected = q_iteration(batch, reward, tolerance=1e-9).policy
    found = q_iteration(batch, scale * (reward + shift), tolerance=1e-9).policy
    assert torch.equal(found, expected)


@laws
@given(seeds, st.sampled_from([0.7, 1.0]), st.floats(-5, 5))
def test_a_constant_added_to_the_reward_leaves_the_soft_policy(seed, discount, shift):
    # The one potential that a reward of states can carry. It holds because no episode ends early.
    batch = random_batch(seed, discount=discount)
    reward = random_reward(batch, seed)
    plain = soft_q_iteration(batch, reward, temperature=0.7)
    moved = soft_q_iteration(batch, reward + shift, temperature=0.7)
    torch.testing.assert_close(moved.policy, plain.policy, rtol=1e-9, atol=1e-12)


def test_the_dtype_of_the_reward_is_the_dtype_of_the_solution():
    batch = random_batch(3)
    reward = random_reward(batch, 3)
    for dtype in (torch.float32, torch.float64):
        solution = soft_q_iteration(batch, reward.to(dtype), temperature=1.0)
        assert (solution.values.dtype, solution.policy.dtype) == (dtype, dtype)
        assert q_iteration(batch, reward.to(dtype)).policy.dtype == dtype


@laws
@given(seeds)
def test_single_precision_agrees_with_double(seed):
    batch = random_batch(seed, cells=20, horizon=30, discount=0.99)
    reward = random_reward(batch, seed)
    exact = soft_q_iteration(batch, reward, temperature=1.0)
    rounded = soft_q_iteration(batch, reward.float(), temperature=1.0)
    torch.testing.assert_close(rounded.values.double(), exact.values, rtol=1e-5, atol=1e-5)
    torch.testing.assert_close(rounded.policy.double(), exact.policy, rtol=1e-3, atol=1e-4)


def test_tasks_of_a_batch_do_not_touch_each_other():
    both = random_batch(11, tasks=2)
    reward = random_reward(both, 11)
    together = soft_q_iteration(both, reward, temperature=1.0)
    for task in range(2):
        alone = TaskBatch(
            both.next_state[task : task + 1],
            both.goal[task : task + 1],
            both.start[task : task + 1],
            both.horizon,
            both.discount,
        )
        single = soft_q_iteration(alone, reward[task : task + 1], temperature=1.0)
        assert torch.equal(single.values[0], together.values[task])
        assert torch.equal(single.policy[0], together.policy[task])


@pytest.mark.parametrize("goal_cell", [1, 4, 9])
def test_the_expert_arrives_as_soon_as_possible_and_stays(goal_cell):
    batch = corridor(10, goal_cell=goal_cell)
    policy = expert_policy(batch, 10.0)
    generator = torch.Generator().manual_seed(0)
    demos = sample_trajectories(batch, policy, episodes=50, generator=generator)
    there = batch.goal[0][demos.states[0] // 4]
    first = there.int().argmax(-1)
    assert optimal_length(batch).tolist() == [goal_cell + 2]
    assert first.tolist() == [goal_cell + 2] * 50
    for episode in range(50):
        assert bool(there[episode, first[episode] :].all())


def test_the_expert_turns_either_way_when_both_are_as_short():
    batch = corridor(4, goal_cell=3)
    policy = expert_policy(batch, 10.0)
    assert policy[0, 0, 2].tolist() == [0.0, 0.5, 0.5, 0.0]


def test_a_constant_reward_does_not_know_where_the_goal_is():
    batch = corridor(10, goal_cell=9)
    policy = q_iteration(batch, torch.full((1, 10), -1.0)).policy
    assert float(success_probability(batch, policy)) < 0.05


def test_a_goal_out_of_reach_leaves_the_expert_indifferent():
    batch = corridor(10, goal_cell=9, horizon=3)
    assert torch.equal(expert_policy(batch, 10.0)[0, 0, 2], torch.full((4,), 0.25).double())


def test_the_true_reward_pays_at_the_goal_alone():
    batch = corridor(4, goal_cell=2)
    assert true_reward(batch, 10.0).tolist() == [[0.0, 0.0, 10.0, 0.0]]


def test_the_greedy_rollout_takes_the_lowest_of_tied_actions():
    batch = corridor(4, goal_cell=3)
    run = rollout(batch, expert_policy(batch, 10.0))
    assert run.actions[0, 0, :5].tolist() == [1, 1, 0, 0, 0]
    assert run.states[0, 0, :6].tolist() == [2, 1, 0, 4, 8, 12]


@pytest.mark.parametrize(
    ("reward", "message"),
    [
        (torch.zeros(2, 3, dtype=torch.int64), "must be float"),
        (torch.zeros(3, 2), r"\[task, cell\] = \[2, 3\], found torch.float32 \[3, 2\]"),
        (torch.full((2, 3), math.nan), "holds a NaN"),
    ],
)
def test_a_reward_that_does_not_fit_is_refused(reward, message):
    with pytest.raises(ValueError, match=message):
        q_iteration(random_batch(0), reward)


def test_a_temperature_that_is_not_positive_is_refused():
    with pytest.raises(ValueError, match="temperature must be positive, found 0"):
        soft_q_iteration(random_batch(0), torch.zeros(2, 3), temperature=0.0)
