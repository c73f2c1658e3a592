"""The environment is the tabular model, told state by state; its episodes, rewards and endings."""

from __future__ import annotations

import subprocess
import sys

import gymnasium
import numpy as np
import pytest
import torch
from environment_samples import CountingReward, sample_benchmark
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.benchmarks.task_sets import house_task_sets
from lcrl_bench.envs import HOUSE_ID, register
from lcrl_bench.envs.environment import HouseEnvironment
from lcrl_bench.errors import NothingSelectedError, UnknownNameError, UsageError
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.rollouts import rollout
from lcrl_bench.mdp.task_batch import Action

HORIZON = 30
SUCCESS_REWARD = 10.0


def make(**settings) -> HouseEnvironment:
    environment = gymnasium.make(
        HOUSE_ID, **{"benchmark": sample_benchmark(), "renderer": "rays", "split": None} | settings
    )
    assert isinstance(environment.unwrapped, HouseEnvironment)
    return environment.unwrapped


def optimal_actions(name: str) -> list[int]:
    """The actions of the exact optimum of a task."""
    (task,) = (task for task in sample_benchmark().tasks if task.id == name)
    (batch,) = house_task_sets(sample_benchmark(), task.house, [task], renderer="rays")
    return rollout(batch, expert_policy(batch, SUCCESS_REWARD)).actions[0, 0].tolist()


TASKS = [task.id for task in sample_benchmark().tasks if task.house == "rooms-a"]
BED, BEDROOM, CUP, TABLE = TASKS


def test_registration_imports_nothing_heavy():
    program = (
        "import sys, lcrl_bench.envs, gymnasium; print(gymnasium.spec('lcrl_bench/House-v1').id); "
        "assert not {'torch', 'mujoco', 'matplotlib'} & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.stdout.strip(), done.returncode) == (HOUSE_ID, 0), done.stderr


def test_the_module_can_be_named_instead_of_imported(monkeypatch):
    spec = gymnasium.registry[HOUSE_ID]
    monkeypatch.delitem(gymnasium.registry, HOUSE_ID)
    monkeypatch.delitem(sys.modules, "lcrl_bench.envs")
    environment = gymnasium.make(f"lcrl_bench.envs:{HOUSE_ID}", benchmark=sample_benchmark())
    assert isinstance(environment.unwrapped, HouseEnvironment)
    assert gymnasium.registry[HOUSE_ID] == spec


def test_registering_twice_does_nothing():
    before = gymnasium.registry[HOUSE_ID]
    register()
    assert gymnasium.registry[HOUSE_ID] is before


@pytest.mark.parametrize("observation", ["panorama", "tabular", "state"])
@pytest.mark.parametrize("reward", ["true", CountingReward()], ids=["true", "learned"])
def test_gymnasium_finds_nothing_wrong(observation, reward):
    check_env(make(observation=observation, reward=reward, render_mode="rgb_array"))


@pytest.mark.parametrize("options", [{"one_hot": True}, {"text": False, "position": True}])
def test_gymnasium_finds_nothing_wrong_with_any_dictionary(options):
    check_env(make(**options), skip_render_check=True)


def test_equal_seeds_give_equal_episodes():
    def tasks_of(seed: int) -> list[str]:
        environment = make()
        environment.reset(seed=seed)
        return [environment.reset()[1]["task"] for _ in range(20)]

    assert tasks_of(5) == tasks_of(5)
    assert tasks_of(5) != tasks_of(6)


def test_every_task_of_the_selection_is_drawn_and_no_other():
    environment = make(split="test-house", kind="pick")
    environment.reset(seed=0)
    drawn = {environment.reset()[1]["task"] for _ in range(60)}
    expected = sample_benchmark().select(split=Split.TEST_HOUSE, kind=Kind.PICK)
    assert drawn == {task.id for task in expected}


@settings(max_examples=60)
@given(
    name=st.sampled_from([task.id for task in sample_benchmark().tasks]),
    actions=st.lists(st.integers(0, 3), max_size=HORIZON),
)
def test_it_walks_through_the_states_of_the_tabular_model(name, actions):
    environment = WALKED
    environment.reset(options={"task": name})
    (task,) = (task for task in sample_benchmark().tasks if task.id == name)
    batch = SETS[task.house, task.kind]
    row = [each.id for each in SETS[task.house, task.kind].tasks].index(name)
    state = int(batch.start[row])
    for action in actions:
        seen, reward, terminated, truncated, info = environment.step(action)
        state = int(batch.next_state[row, state, action])
        assert environment.state == int(seen) == state
        assert reward == SUCCESS_REWARD * info["success"]
        assert info["success"] == bool(batch.goal[row, state // 4])
        assert (terminated, truncated) == (False, environment.steps == HORIZON)


WALKED = make(observation="state", terminate_at_goal=False)
SETS = {
    (name, tasks.kind): tasks
    for name in sample_benchmark().houses
    for tasks in house_task_sets(sample_benchmark(), name, renderer="rays")
}


@pytest.mark.parametrize("name", TASKS)
def test_the_optimum_arrives_in_as_many_steps_as_the_task_says(name):
    environment = make(tasks=[name])
    _, info = environment.reset()
    length, actions = info["optimal_length"], optimal_actions(name)
    for action in actions[: length - 1]:
        _, reward, terminated, truncated, info = environment.step(action)
        assert (reward, terminated, truncated, info["success"]) == (0.0, False, False, False)
    _, reward, terminated, truncated, info = environment.step(actions[length - 1])
    assert (reward, terminated, truncated, info["success"]) == (SUCCESS_REWARD, True, False, True)


@pytest.mark.parametrize("name", TASKS)
def test_the_optimum_earns_its_value_where_episodes_go_on(name):
    environment = make(tasks=[name], terminate_at_goal=False)
    _, info = environment.reset()
    rewards = [environment.step(action)[1] for action in optimal_actions(name)]
    discounts = sample_benchmark().semantics.discount ** np.arange(1, HORIZON + 1)
    assert np.dot(rewards, discounts) == pytest.approx(info["optimal_value"])


def test_an_episode_of_the_true_reward_is_cut_at_the_horizon():
    environment = make(tasks=[BED])
    environment.reset()
    ends = [environment.step(Action.INTERACT)[2:4] for _ in range(HORIZON)]
    assert ends == [(False, False)] * (HORIZON - 1) + [(False, True)]
    with pytest.raises(UsageError, match="call reset"):
        environment.step(Action.INTERACT)


def test_arriving_at_the_last_step_is_termination_not_truncation():
    environment = make(tasks=[BED])
    _, info = environment.reset()
    length = info["optimal_length"]
    idle = [int(Action.INTERACT)] * (HORIZON - length)
    for action in idle + optimal_actions(BED)[: length - 1]:
        environment.step(action)
    assert environment.step(optimal_actions(BED)[length - 1])[2:4] == (True, False)


def test_a_learned_reward_does_not_end_episodes_at_the_goal():
    environment = make(tasks=[BED], reward=CountingReward())
    environment.reset()
    steps = [environment.step(action) for action in optimal_actions(BED)]
    assert steps[-2][4]["success"]
    assert [step[2] for step in steps] == [False] * HORIZON
    assert [step[3] for step in steps] == [False] * (HORIZON - 1) + [True]


def test_a_learned_reward_may_be_told_to_end_them():
    environment = make(tasks=[BEDROOM], reward=CountingReward(), terminate_at_goal=True)
    environment.reset()
    ends = [environment.step(action)[2] for action in optimal_actions(BEDROOM)[:3]]
    assert ends == [False, False, True]


def test_a_task_can_be_asked_for():
    environment = make(split="train")
    _, info = environment.reset(options={"task": "rooms-b.go-to-the-bed"})
    assert info["task"] == environment.task.id == "rooms-b.go-to-the-bed"
    with pytest.raises(UsageError, match=r"Did you mean 'rooms-b\.go-to-the-bed'\?"):
        environment.reset(options={"task": "rooms-b.go-to-the-bee"})
    with pytest.raises(UsageError, match="Unknown option 'tasks'"):
        environment.reset(options={"tasks": "rooms-b.go-to-the-bed"})


def test_few_houses_stay_in_memory_and_none_after_closing():
    environment = make(houses_kept=1)
    environment.reset(options={"task": BED})
    first = environment.played.scene
    environment.reset(options={"task": CUP})
    assert environment.played.scene is first
    environment.reset(options={"task": "rooms-b.go-to-the-bed"})
    environment.reset(options={"task": BED})
    assert environment.played.scene is not first
    assert len(environment._sets) == 1
    environment.close()
    assert len(environment._sets) == 0


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"split": "tests"}, UnknownNameError, "Unknown split 'tests'.*test-house"),
        ({"kind": "navigate"}, UnknownNameError, "Unknown kind 'navigate'"),
        ({"observation": "tabula"}, UnknownNameError, "Did you mean 'tabular'"),
        ({"benchmark": "minni"}, UnknownNameError, "Did you mean 'mini'"),
        ({"tasks": ["nothing"]}, UsageError, "no task 'nothing'"),
        ({"tasks": []}, NothingSelectedError, "no task of"),
        ({"split": "test-task", "kind": "pick"}, NothingSelectedError, "split='test-task'"),
        ({"tasks": BED}, UsageError, "tasks is 'rooms-a.*Valid: a list"),
        ({"tasks": [BED, 3]}, UsageError, r"tasks\[1\] is 3, not a string"),
        ({"split": 3}, UsageError, "split is 3.*Valid: test-house, test-task, train"),
        ({"benchmark": 3}, UsageError, "benchmark is 3"),
        ({"reward": None}, UsageError, "reward is None.*the folder of a run"),
        ({"reward": 10.0}, UsageError, "reward is 10.0"),
        ({"renderer": "ray"}, UnknownNameError, "Did you mean 'rays'"),
        ({"houses_kept": 0}, UsageError, "houses_kept is 0"),
        ({"houses_kept": 1.5}, UsageError, "houses_kept is 1.5"),
        ({"one_hot": "no"}, UsageError, "one_hot is 'no'. Valid: True, False"),
        ({"terminate_at_goal": 0}, UsageError, "terminate_at_goal is 0"),
        ({"render_mode": "depth"}, UnknownNameError, "Valid: ansi, rgb_array"),
        ({"render_mode": 3}, UsageError, "render_mode is 3"),
    ],
)
def test_what_can_not_be_made_says_why(settings, error, words):
    with pytest.raises(error, match=words):
        HouseEnvironment(**{"benchmark": sample_benchmark()} | settings)


def test_what_is_no_action_is_refused():
    environment = make()
    with pytest.raises(UsageError, match="call reset"):
        environment.step(0)
    environment.reset()
    numbers = (-1, 4, 1.7, 1.0, np.float32(1), np.array(1.0), torch.tensor(1.0), np.nan)
    others = ("1", None, True, np.True_, np.array(True), torch.tensor(True), [1], np.array([1, 2]))
    for action in (*numbers, *others):
        with pytest.raises(UsageError, match=r"is not an action\. Valid: integers 0 \.\. 3"):
            environment.step(action)
    assert environment.steps == 0


def test_torch_and_numpy_integers_are_actions_too():
    environment = make()
    for action in (Action.LEFT, torch.tensor(1), np.array(1), np.int64(1), np.uint8(1)):
        environment.reset(options={"task": BED})
        environment.step(action)
        assert environment.state % 4 == (sample_benchmark().tasks[0].start_heading - 1) % 4


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"task": 3}, r"options\['task'\] is 3, not a string. Valid: the id of a task"),
        ({"task": [BED]}, r"options\['task'\] is \["),
        ({3: BED}, "Unknown option '3' of reset. Valid: task"),
        (BED, "options is 'rooms-a.*Valid: a dictionary"),
        ([("task", BED)], "options is .*Valid: a dictionary"),
    ],
)
def test_what_is_no_option_is_refused_and_the_episode_goes_on(options, words):
    environment = make()
    environment.reset(seed=0, options={"task": BED})
    with pytest.raises(UsageError, match=words):
        environment.reset(seed=1, options=options)
    environment.step(0)
    assert (environment.task.id, environment.np_random_seed) == (BED, 0)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", True, [1]])
def test_what_is_no_seed_is_refused(seed):
    with pytest.raises(UsageError, match="Valid: a non-negative integer, or None"):
        make().reset(seed=seed)


def test_numpy_seeds_are_seeds():
    first, second = make(), make()
    assert first.reset(seed=5)[1] == second.reset(seed=np.uint32(5))[1]
    assert first.np_random_seed == second.np_random_seed
