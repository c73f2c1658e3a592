"""From a learned reward to an episode: it follows the dynamics, the optimum and the policy."""

from __future__ import annotations

import numpy as np
import pytest
from episode_samples import SeenReward

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.harness import evaluate
from lcrl_bench.mdp.visitation import occupancy_mass
from lcrl_bench.recording.episode import Episode
from lcrl_bench.scenes.reach import within_reach


def table_of(sets: tuple[TaskSet, ...], kind: Kind) -> np.ndarray:
    (tasks,) = [found for found in sets if found.kind == kind]
    return tasks.next_state[0].numpy()


@pytest.mark.parametrize("name", ["nav_episode", "pick_episode", "policy_episode"])
def test_an_episode_follows_the_dynamics(
    name: str, sets: tuple[TaskSet, ...], request: pytest.FixtureRequest
):
    episode: Episode = request.getfixturevalue(name)
    table = table_of(sets, episode.task.kind)
    np.testing.assert_array_equal(episode.states[1:], table[episode.states[:-1], episode.actions])
    start = episode.task.start_tile * 4 + episode.task.start_heading
    assert episode.states[0] == start


@pytest.mark.parametrize("name", ["nav_episode", "pick_episode", "policy_episode"])
def test_every_action_is_among_the_most_likely(name: str, request: pytest.FixtureRequest):
    episode: Episode = request.getfixturevalue(name)
    chances = episode.action_probabilities
    np.testing.assert_allclose(chances.sum(axis=1), 1.0)
    taken = chances[np.arange(episode.horizon), episode.actions]
    np.testing.assert_allclose(taken, chances.max(axis=1))


@pytest.mark.parametrize("name", ["nav_episode", "pick_episode"])
def test_the_value_of_the_start_is_what_the_way_collects(
    name: str, benchmark_sample: Benchmark, request: pytest.FixtureRequest
):
    episode: Episode = request.getfixturevalue(name)
    assert episode.reward is not None
    assert episode.value is not None
    discounts = benchmark_sample.semantics.discount ** np.arange(episode.horizon + 1)
    collected = (discounts * episode.reward[episode.cells]).sum()
    np.testing.assert_allclose(episode.value[episode.states[0]], collected)


def test_the_cup_is_taken_and_put_on_the_bed(pick_episode: Episode):
    assert pick_episode.success
    states = pick_episode.object_states
    assert list(dict.fromkeys(states.tolist())) == [0, 1, 2]
    assert bool(pick_episode.done[-1])


def test_tiles_in_reach_are_those_of_the_scene(pick_episode: Episode, benchmark_sample: Benchmark):
    house, grid = pick_episode.scene.house, pick_episode.scene.grid
    task, semantics = pick_episode.task, benchmark_sample.semantics
    assert task.placement is not None
    near_start = within_reach(house, grid, house.object("cup"), semantics)
    near_end = within_reach(house, grid, task.placement, semantics)
    np.testing.assert_array_equal(pick_episode.near_start, near_start)
    np.testing.assert_array_equal(pick_episode.near_end, near_end)


def test_visits_add_up_to_the_discounted_length(nav_episode: Episode):
    total = occupancy_mass(nav_episode.horizon, 0.99)
    assert nav_episode.occupancy is not None
    assert nav_episode.expert_occupancy is not None
    np.testing.assert_allclose(nav_episode.occupancy.sum(), total)
    np.testing.assert_allclose(nav_episode.expert_occupancy.sum(), total)


def test_a_policy_has_no_reward_to_show(policy_episode: Episode):
    assert policy_episode.reward is None
    assert policy_episode.value is None
    assert policy_episode.occupancy is not None


def test_an_episode_reaches_the_goal_where_its_task_succeeds(
    sets: tuple[TaskSet, ...], nav_episode: Episode, pick_episode: Episode
):
    outcomes = {outcome.task.id: outcome for outcome in evaluate(SeenReward(), sets)}
    for episode in (nav_episode, pick_episode):
        assert episode.success == (outcomes[episode.task.id].success > 0.5)
