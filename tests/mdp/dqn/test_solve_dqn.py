"""DQN solves what exploration can find, alone as in company, and knows only what it met."""

from dataclasses import replace

import pytest
import torch
from mdp_samples import corridor

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.dqn.agents import DqnAgents
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.mdp.dqn.solve import solve_dqn, solve_seeded
from lcrl_bench.mdp.dqn.stack import TaskStack
from lcrl_bench.mdp.expert import true_reward
from lcrl_bench.mdp.planning import q_iteration
from lcrl_bench.mdp.success import success_probability

LITTLE = DqnConfig(steps=4_000, episodes=5, hidden=24, replay=2_000, target_interval=50)
NO_SHAPING = replace(LITTLE, shaping="none")
BRIEF = DqnConfig(steps=300, episodes=5, hidden=8, replay=200, target_interval=10)
NO_SHAPING_BRIEF = replace(BRIEF, shaping="none")


def solve(batches, config, seed=0, rewards=None):
    paid = rewards or [true_reward(batch, 10.0) for batch in batches]
    return solve_dqn(batches, paid, config, generator=torch.Generator().manual_seed(seed))


@pytest.mark.parametrize("kernel", ["auto", "torch"])
@pytest.mark.parametrize("config", [LITTLE, NO_SHAPING], ids=["shaped", "unshaped"])
def test_what_exploration_can_find_is_solved_as_exactly(config, kernel, monkeypatch):
    monkeypatch.setenv("LCRL_BENCH_KERNEL", kernel)
    batches = [corridor(length, goal_cell=length - 1) for length in (3, 4, 5)]
    for batch, policy in zip(batches, solve(batches, config), strict=True):
        exact = q_iteration(batch, true_reward(batch, 10.0)).policy
        assert success_probability(batch, exact).item() == pytest.approx(1.0)
        assert success_probability(batch, policy).item() == pytest.approx(1.0)


def test_what_exploration_can_not_find_takes_a_potential():
    batch = corridor(24, goal_cell=23)
    shaped, plain = (solve([batch], config)[0] for config in (LITTLE, NO_SHAPING))
    assert success_probability(batch, shaped).item() == pytest.approx(1.0)
    assert success_probability(batch, plain).item() < 0.5


def test_a_policy_takes_one_action_a_state_at_all_times():
    batch = corridor(4, goal_cell=3)
    (policy,) = solve([batch], BRIEF)
    assert tuple(policy.shape) == (1, batch.horizon, batch.states, 4)
    assert torch.equal(policy.sum(-1), torch.ones(1, batch.horizon, batch.states))
    assert torch.equal(policy.amax(-1), torch.ones(1, batch.horizon, batch.states))
    assert torch.equal(policy[:, 0], policy[:, -1])


def test_a_task_is_solved_alike_in_any_company():
    batches = [corridor(length, goal_cell=length - 1) for length in (3, 9, 5)]
    rewards = [true_reward(batch, 10.0) for batch in batches]
    seeds = torch.tensor([11, 12, 13])
    together = solve_seeded(batches, rewards, BRIEF, seeds=seeds)
    for k, batch in enumerate(batches):
        (alone,) = solve_seeded([batch], rewards[k : k + 1], BRIEF, seeds=seeds[k : k + 1])
        assert torch.equal(alone, together[k])


def test_equal_seeds_give_equal_bits_and_others_do_not():
    batches = [corridor(12, goal_cell=11)]
    first, again, other = (solve(batches, BRIEF, seed)[0] for seed in (1, 1, 2))
    assert torch.equal(first, again)
    assert not torch.equal(first, other)


def test_rewards_that_were_never_met_change_nothing():
    batch = corridor(40, goal_cell=39)
    reward = true_reward(batch, 10.0)
    # Thirty steps lead to the thirty-first cell at most.
    beyond = reward.clone()
    beyond[0, 31:] = 1e6
    first, second = (solve([batch], NO_SHAPING_BRIEF, rewards=[r]) for r in (reward, beyond))
    assert torch.equal(first[0], second[0])


def test_scale_and_offset_of_a_reward_do_not_matter():
    batch = corridor(4, goal_cell=3)
    rewards = [true_reward(batch, 1e-3), true_reward(batch, 1e4) - 3e4]
    for policy in solve([batch, batch], NO_SHAPING, rewards=rewards):
        assert success_probability(batch, policy).item() == pytest.approx(1.0)


def test_episodes_are_cut_at_the_horizon_and_what_is_remembered_happened():
    batch = corridor(6, goal_cell=5, horizon=7)
    agents = DqnAgents(TaskStack.of([batch]), BRIEF, seeds=torch.tensor([3]))
    for step in range(1, 22):
        agents.act()
        assert bool((agents.states == batch.start).all()) or step % 7
    states, actions, successors = agents.replay.sample(300, agents.draws)
    assert torch.equal(batch.next_state[0, states, actions], successors)
    assert {0, 1, 2, 3} == set(actions.flatten().tolist())
    assert int(batch.start[0]) in set(states.flatten().tolist())


def test_memory_forgets_the_oldest_first():
    batch = corridor(6, goal_cell=5)
    config = DqnConfig(steps=300, episodes=5, hidden=8, replay=10)
    agents = DqnAgents(TaskStack.of([batch]), config, seeds=torch.tensor([3]))
    arrived = [agents.act() for _ in range(9)]
    remembered = set(agents.visited(200).flatten().tolist())
    assert remembered == set(torch.cat(arrived[-2:]).flatten().tolist())


@pytest.mark.parametrize(
    "bad",
    [{"steps": 3}, {"batch": 0}, {"learning_rate": 0.0}, {"exploration_end": 2.0}, {"replay": 1}],
)
def test_settings_that_can_not_be_learned_with_are_refused(bad):
    with pytest.raises(UsageError, match=r"starts at 1|must hold|must be positive|lie in"):
        DqnConfig(**bad)


def test_exploration_falls_along_a_line_and_stays():
    config = DqnConfig(steps=1_000, episodes=10, exploration_share=0.5, exploration_end=0.1)
    assert [config.exploration(done) for done in (0, 25, 50, 99)] == pytest.approx(
        [1.0, 0.55, 0.1, 0.1]
    )
