"""The shared tables play the same episodes as single environments under the same seeds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from environment_samples import CountingReward, sample_benchmark
from gymnasium.vector import AutoresetMode, VectorEnv
from vector_samples import ENVIRONMENTS, equal, shared, singles

from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.envs.environment import HouseEnvironment

OBSERVATIONS = (
    {},
    {"text": False, "position": True},
    {"one_hot": True},
    {"observation": "tabular"},
    {"observation": "state"},
)
FROZEN = {"renderer": "auto"}
"""Shows the views that shipped benchmarks are frozen with."""
MODES = tuple(mode.value for mode in AutoresetMode)


def played(vector: VectorEnv, *, steps: int = 70, seed: int = 3) -> Iterator[tuple]:
    """All that is returned under random actions; where episodes are over, they are begun again."""
    # Forward more often than not: terminations matter, and random turns rarely get anywhere.
    rng = np.random.default_rng(seed)
    choices = np.array([0, 0, 0, 1, 2, 3])
    yield vector.reset(seed=seed)
    for _ in range(steps):
        returned = vector.step(rng.choice(choices, size=vector.num_envs))
        yield returned
        over = returned[2] | returned[3]
        if vector.metadata["autoreset_mode"] is AutoresetMode.DISABLED and over.any():
            yield vector.reset(options={"reset_mask": over})
    vector.close()


def assert_same_episodes(mode: str, **settings) -> None:
    ours, theirs = shared(autoreset_mode=mode, **settings), singles(autoreset_mode=mode, **settings)
    terminated = truncated = False
    for found, expected in zip(played(ours), played(theirs), strict=True):
        assert equal(found, expected)
        if len(found) == 5:
            terminated, truncated = terminated or found[2].any(), truncated or found[3].any()
    assert truncated
    assert terminated == ours.terminate_at_goal


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("settings", OBSERVATIONS, ids=str)
def test_observations_rewards_flags_and_infos_are_the_same(mode, settings):
    assert_same_episodes(mode, **settings)


@pytest.mark.parametrize("mode", MODES)
def test_a_learned_reward_is_paid_the_same(mode):
    assert_same_episodes(mode, reward=CountingReward(), observation="state")
    assert_same_episodes(mode, reward=CountingReward(), terminate_at_goal=True, houses_kept=1)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("limit", [-1, 12, 29, 30, 31])
def test_any_limit_of_steps_truncates_the_same(mode, limit):
    assert_same_episodes(mode, max_episode_steps=limit, observation="state", kind="nav")


def test_a_longer_horizon_than_usual_ends_the_same():
    semantics = replace(sample_benchmark().semantics, horizon=40)
    longer = replace(sample_benchmark(), semantics=semantics)
    for limit in (35, 40, 45):
        assert_same_episodes("NextStep", benchmark=longer, max_episode_steps=limit)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", ["mini", "lcrl-v1"])
def test_shipped_benchmarks_are_played_the_same_while_houses_come_and_go(name, mode):
    benchmark = read_benchmark(benchmark_folder(name))
    # Fewer houses are kept than are played, so tables are dropped and moved all the time.
    settings = {"benchmark": benchmark, "houses_kept": 2, "autoreset_mode": mode, **FROZEN}
    ours, theirs = shared(**settings), singles(**settings)
    for found, expected in zip(played(ours), played(theirs), strict=True):
        assert equal(found, expected)
        assert len(ours._pool) <= ENVIRONMENTS


@pytest.mark.parametrize("name", ["mini", "lcrl-v1"])
def test_every_task_of_the_shipped_benchmarks_is_played_the_same(name):
    benchmark = read_benchmark(benchmark_folder(name))
    single = gymnasium.make(HOUSE_ID, benchmark=benchmark)
    rng = np.random.default_rng(0)
    for first in range(0, len(benchmark.tasks), 128):
        ids = [task.id for task in benchmark.tasks[first : first + 128]]
        vector = shared(num_envs=len(ids), benchmark=benchmark, **FROZEN, autoreset_mode="Disabled")
        actions = rng.integers(4, size=(len(ids), 8))
        seen, infos = vector.reset(options={"task": ids})
        assert infos["task"].tolist() == ids
        steps = _stepped(vector, actions.T)
        for number, task in enumerate(ids):
            expected, info = single.reset(options={"task": task})
            assert _of(seen, number, expected)
            assert info == {key: infos[key][number] for key in info}
            for action, found in zip(actions[number], steps, strict=False):
                expected, *scalars, info = single.step(int(action))
                assert _of(found[0], number, expected)
                assert [column[number] for column in found[1:4]] == scalars
                assert info == {key: found[4][key][number] for key in info}
                if scalars[1] or scalars[2]:
                    break


def _stepped(vector: VectorEnv, columns: np.ndarray) -> list[tuple]:
    """Steps with these actions; what is over is begun anew, which nobody compares."""
    steps: list[tuple] = []
    for column in columns:
        over = steps[-1][2] | steps[-1][3] if steps else np.array(False)
        if over.any():
            vector.reset(options={"reset_mask": over})
        steps.append(vector.step(column))
    return steps


def _of(batch: dict, number: int, expected: dict) -> bool:
    return all(np.array_equal(batch[key][number], value) for key, value in expected.items())


def test_a_reset_of_some_leaves_the_others_where_they_are():
    ours, theirs = shared(position=True), singles(position=True)
    mask = np.arange(ENVIRONMENTS) % 2 == 0
    assert equal(ours.reset(seed=1), theirs.reset(seed=1))
    for seed in (None, 9, [4, None, 6, 7, None]):
        actions = np.full(ENVIRONMENTS, 2)
        assert equal(ours.step(actions), theirs.step(actions))
        found = ours.reset(seed=seed, options={"reset_mask": mask})
        assert equal(found, theirs.reset(seed=seed, options={"reset_mask": mask.copy()}))


def test_generators_are_those_of_single_environments():
    ours, theirs = shared(), singles()
    for _ in zip(played(ours, steps=40), played(theirs, steps=40), strict=True):
        assert ours.np_random_seed == theirs.np_random_seed
        states = [[g.bit_generator.state for g in vector.np_random] for vector in (ours, theirs)]
        assert states[0] == states[1]


def test_without_a_seed_every_sub_environment_draws_for_itself():
    vector = shared(num_envs=40)
    _, infos = vector.reset()
    assert len(set(infos["task"])) > 1
    assert len(set(vector.np_random_seed)) == 40


def test_spaces_and_metadata_are_those_of_single_environments():
    for settings in OBSERVATIONS:
        ours, theirs = shared(**settings), singles(**settings)
        for space in ("observation_space", "single_observation_space", "action_space"):
            assert getattr(ours, space) == getattr(theirs, space)
        assert ours.single_action_space == theirs.single_action_space
        assert ours.metadata == theirs.metadata
        assert ours.reset(seed=0)[0] in ours.observation_space


@pytest.mark.parametrize("render_mode", ["ansi", "rgb_array"])
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_frames_are_those_of_single_environments(render_mode, mode):
    settings = {"num_envs": 2, "autoreset_mode": mode, "render_mode": render_mode}
    ours, theirs = shared(**settings), singles(**settings)
    pairs = zip(played(ours, steps=32), played(theirs, steps=32), strict=True)
    for step, _ in enumerate(pairs):
        if render_mode == "ansi" or step in (0, 1, 30, 31):
            assert equal(ours.render(), theirs.render())


def test_tables_hold_the_states_of_single_environments():
    ours, theirs = shared(), singles()
    for _ in zip(played(ours, steps=35), played(theirs, steps=35), strict=True):
        states = [each.unwrapped.state for each in theirs.envs]  # pyright: ignore
        assert ours.states.tolist() == states
        tasks = [each.unwrapped.task.id for each in theirs.envs]  # pyright: ignore
        assert [task.id for task in ours.played] == tasks


def test_a_single_environment_is_what_the_others_are_made_of():
    single = singles().envs[0].unwrapped  # pyright: ignore[reportAttributeAccessIssue]
    assert isinstance(single, HouseEnvironment)
