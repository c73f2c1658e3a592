"""The vector environment: what it takes, what it refuses, and what it shares."""

from __future__ import annotations

from pathlib import Path

import gymnasium
import numpy as np
import pytest
import torch
from environment_samples import CountingReward, sample_benchmark
from gymnasium.envs.registration import EnvSpec
from gymnasium.vector import AutoresetMode
from vector_samples import ENVIRONMENTS, equal, shared

from lcrl_bench.benchmarks import task_sets
from lcrl_bench.benchmarks.document import write_benchmark
from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.envs.arguments import check_actions
from lcrl_bench.envs.vector_environment import HouseVectorEnvironment
from lcrl_bench.errors import NothingSelectedError, UnknownNameError, UsageError

BED, CUP = "rooms-a.go-to-the-bed", "rooms-b.move-the-cup-to-the-bed"
STAY = np.full(ENVIRONMENTS, 3)


def test_it_is_what_make_vec_makes_unless_told_otherwise():
    arguments = {"num_envs": 2, "benchmark": sample_benchmark()}
    assert isinstance(gymnasium.make_vec(HOUSE_ID, **arguments), HouseVectorEnvironment)
    sync = gymnasium.make_vec(HOUSE_ID, vectorization_mode="sync", **arguments)
    assert isinstance(sync, gymnasium.vector.SyncVectorEnv)


@pytest.mark.parametrize("mode", [*AutoresetMode, *(each.value for each in AutoresetMode)])
def test_its_autoreset_mode_is_in_its_metadata(mode):
    assert shared(autoreset_mode=mode).metadata["autoreset_mode"] is AutoresetMode(mode)
    default = HouseVectorEnvironment(benchmark=sample_benchmark())
    assert default.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP


def test_a_house_is_loaded_once_for_all_sub_environments(monkeypatch: pytest.MonkeyPatch):
    loaded = []

    def load(benchmark, house, *arguments, **more):
        loaded.append(house)
        return original(benchmark, house, *arguments, **more)

    original = task_sets.house_task_sets
    monkeypatch.setattr(task_sets, "house_task_sets", load)
    vector = shared(num_envs=50)
    assert loaded == []
    vector.reset(seed=0)
    for _ in range(65):
        vector.step(np.full(50, 3))
    assert sorted(loaded) == ["rooms-a", "rooms-b"]


def test_a_task_is_scored_once_for_all_sub_environments():
    reward = CountingReward()
    vector = shared(num_envs=50, reward=reward)
    vector.reset(seed=0)
    vector.reset()
    assert sorted(reward.scored) == sorted(task.command for task in sample_benchmark().tasks)


def test_observations_are_the_readers_own_if_copied_and_overwritten_if_not():
    for settings in ({"position": True}, {"observation": "tabular"}, {"observation": "state"}):
        mine, shared_arrays = shared(**settings), shared(copy=False, **settings)
        kept, _ = mine.reset(seed=0)
        once, _ = shared_arrays.reset(seed=0)
        first, _ = mine.reset(seed=0)
        for action in (0, 1, 0, 2, 0):
            actions = np.full(ENVIRONMENTS, action)
            fresh = mine.step(actions)[0]
            again = shared_arrays.step(actions)[0]
            assert equal(fresh, again)
            for name, array in _arrays(fresh):
                assert not np.shares_memory(array, dict(_arrays(kept))[name])
            for name, array in _arrays(again):
                assert array is dict(_arrays(once))[name]
        assert equal(kept, first)


def _arrays(seen) -> list[tuple[str, np.ndarray]]:
    parts = seen if isinstance(seen, dict) else {"": seen}
    return [(key, value) for key, value in parts.items() if isinstance(value, np.ndarray)]


def test_whatever_is_returned_may_be_written_in():
    ours, theirs = shared(autoreset_mode="SameStep"), shared(autoreset_mode="SameStep")
    ours.reset(seed=4)
    theirs.reset(seed=4)
    for _ in range(64):
        seen, *flags, infos = ours.step(STAY)
        assert equal((seen, *flags, infos), theirs.step(STAY))
        for array in (seen["panorama"], seen["heading"], seen["held"], seen["command"], *flags):
            array[...] = 1
        for array in infos.values():
            if isinstance(array, np.ndarray):
                array[...] = 0


def test_tasks_can_be_asked_for_all_at_once_or_one_by_one():
    vector = shared()
    _, infos = vector.reset(options={"task": BED})
    assert infos["task"].tolist() == [BED] * ENVIRONMENTS
    _, infos = vector.reset(seed=0, options={"task": [BED, CUP, None, BED, CUP]})
    drawn = shared().reset(seed=0)[1]["task"]
    # Who is told a task draws none; the draws of the others are as ever.
    assert infos["task"].tolist() == [BED, CUP, drawn[2], BED, CUP]
    mask = np.array([True, False, True, False, False])
    _, infos = vector.reset(options={"task": CUP, "reset_mask": mask})
    assert infos["task"].tolist() == [CUP, None, CUP, None, None]
    assert infos["_task"].tolist() == mask.tolist()
    assert [task.id for task in vector.played] == [CUP, CUP, CUP, BED, CUP]


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"autoreset": "SameStep"}, UnknownNameError, "Did you mean 'autoreset_mode'"),
        ({"autoreset_mode": "samestep"}, UnknownNameError, "Valid: Disabled, NextStep, SameStep"),
        ({"autoreset_mode": 1}, UsageError, "autoreset_mode is 1"),
        ({"num_envs": 0}, UsageError, "num_envs is 0"),
        ({"max_episode_steps": 0}, UsageError, "max_episode_steps is 0"),
        ({"copy": "yes"}, UsageError, "copy is 'yes'. Valid: True, False"),
        ({"split": "tests"}, UnknownNameError, "Unknown split 'tests'.*test-house"),
        ({"observation": "tabula"}, UnknownNameError, "Did you mean 'tabular'"),
        ({"tasks": []}, NothingSelectedError, "no task of"),
        ({"houses_kept": 0}, UsageError, "houses_kept is 0"),
        ({"render_mode": "human"}, UnknownNameError, "Valid: ansi, rgb_array"),
    ],
)
def test_what_can_not_be_made_says_why(settings, error, words):
    with pytest.raises(error, match=words):
        HouseVectorEnvironment(**{"benchmark": sample_benchmark()} | settings)


@pytest.mark.parametrize(
    ("actions", "words"),
    [
        ([0, 1, 2, 3], r"actions are int64\[4\]. Valid: 5 integers 0 \.\. 3"),
        (np.zeros((ENVIRONMENTS, 1), np.int64), r"int64\[5, 1\]"),
        (np.zeros(ENVIRONMENTS), r"float64\[5\]"),
        ([True] * ENVIRONMENTS, r"bool\[5\]"),
        ([0, 1, 4, 3, 0], r"4 is not an action \(sub-environment 2\)"),
        ([0, 1, 2, -1, 0], r"-1 is not an action \(sub-environment 3\)"),
        ([0, 1, 2, 3, None], r"object\[5\]"),
        (3, r"int64\[\]"),
    ],
)
def test_what_is_no_action_is_refused_and_the_episodes_go_on(actions, words):
    vector = shared()
    with pytest.raises(UsageError, match="call reset"):
        vector.step(STAY)
    vector.reset(seed=0)
    before = vector.states
    with pytest.raises(UsageError, match=words):
        vector.step(actions)
    assert (vector.states == before).all()


def test_integers_of_any_kind_are_actions():
    expected = np.array([0, 1, 2, 3, 0])
    kinds = [expected.astype(kind) for kind in (np.uint8, np.int32, np.int64)]
    for actions in (*kinds, torch.tensor(expected), expected.tolist(), tuple(expected)):
        checked = check_actions(actions, ENVIRONMENTS, 3, ignored=[])
        assert (checked.dtype, checked.tolist()) == (np.int64, expected.tolist())


def test_the_action_of_an_episode_that_is_over_does_not_matter():
    vector = shared(max_episode_steps=1)
    vector.reset(seed=0)
    vector.step(STAY)
    ignored = vector.step(np.full(ENVIRONMENTS, 17))
    assert not (ignored[2] | ignored[3]).any()
    assert ignored[1].tolist() == [0.0] * ENVIRONMENTS


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"seed": [1, 2]}, r"seed is \[1, 2\].*a list of 5"),
        ({"seed": -1}, "seed is -1"),
        ({"seed": [1, 2, 3, 4, 1.5]}, "seed is 1.5"),
        ({"options": {"tasks": BED}}, "Unknown option 'tasks' of reset. Valid: task, reset_mask"),
        ({"options": [BED]}, "Valid: a dictionary"),
        ({"options": {"task": [BED]}}, "a list of 5 ids"),
        ({"options": {"task": [BED, 3, None, None, None]}}, r"options\['task'\]\[1\] is 3"),
        ({"options": {"task": "rooms-b.go-to-the-bee"}}, r"Did you mean 'rooms-b\.go-to-the-bed'"),
        ({"options": {"reset_mask": [True] * 5}}, "Valid: a NumPy array of 5 booleans"),
        ({"options": {"reset_mask": np.ones(4, bool)}}, r"reset_mask'\] is 'bool\[4\]'"),
        ({"options": {"reset_mask": np.zeros(5, bool)}}, "False everywhere"),
    ],
)
def test_what_can_not_be_reset_says_why_and_the_episodes_go_on(arguments, words):
    vector = shared()
    vector.reset(seed=0)
    before, seeds = vector.states, vector.np_random_seed
    with pytest.raises(UsageError, match=words):
        vector.reset(**arguments)
    assert ((vector.states == before).all(), vector.np_random_seed) == (True, seeds)


def test_the_first_reset_is_of_all():
    with pytest.raises(UsageError, match="call reset"):
        shared().reset(options={"reset_mask": np.arange(ENVIRONMENTS) > 2})


def test_an_episode_that_is_over_is_begun_by_hand_where_autoreset_is_disabled():
    vector = shared(autoreset_mode="Disabled")
    vector.reset(options={"task": [BED, BED, CUP, CUP, CUP]})
    for _ in range(30):
        truncated = vector.step(STAY)[3]
    assert truncated.all()
    with pytest.raises(
        UsageError, match=r"sub-environments \[0, 1, 2, 3, 4\] are over.*reset_mask"
    ):
        vector.step(STAY)
    vector.reset(options={"reset_mask": truncated})
    vector.step(STAY)


def test_a_closed_environment_is_empty():
    vector = shared(render_mode="ansi")
    vector.reset(seed=0)
    assert len(vector._pool) > 0
    vector.close()
    assert (len(vector._pool), vector.closed) == (0, True)
    for use in (lambda: vector.step(STAY), vector.render, lambda: vector.played):
        with pytest.raises(UsageError, match="call reset"):
            use()


def test_a_picture_needs_a_render_mode():
    vector = shared()
    vector.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode='rgb_array'"):
        assert vector.render() == (None,) * ENVIRONMENTS


@pytest.mark.parametrize("mode", ["SameStep", AutoresetMode.SAME_STEP])
def test_json_makes_the_same_vector_environment(tmp_path: Path, mode):
    write_benchmark(tmp_path / "rooms", sample_benchmark())
    vector = shared(benchmark=tmp_path / "rooms", autoreset_mode=mode, copy=False)
    assert vector.spec is not None
    again = gymnasium.make_vec(EnvSpec.from_json(vector.spec.to_json()))
    assert isinstance(again, HouseVectorEnvironment)
    assert (again.num_envs, again.metadata) == (vector.num_envs, vector.metadata)
    assert equal(again.reset(seed=0), vector.reset(seed=0))


def test_gymnasiums_wrappers_take_it():
    vector = gymnasium.wrappers.vector.RecordEpisodeStatistics(shared(split="train"))
    vector.reset(seed=0)
    for _ in range(30):
        infos = vector.step(STAY)[4]
    assert infos["episode"]["l"].tolist() == [30] * ENVIRONMENTS
