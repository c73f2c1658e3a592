"""The harness: exact controls, no leak of the goal, what methods are shown."""

from dataclasses import replace

import pytest
import torch
from benchmark_samples import TrueRewardBySight, tiny_benchmark, tiny_task_sets

from lcrl_bench.benchmarks.house_sets import by_house
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.evaluation.harness import (
    ConstantReward,
    evaluate,
    evaluate_optimal,
    evaluate_random,
)
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.methods.tensors import TensorPolicy
from lcrl_bench.methods.train_set import select_split, train_set


@pytest.fixture(scope="module")
def sets():
    return tiny_task_sets()


def test_the_optimal_policy_solves_every_task(sets):
    for outcome in evaluate_optimal(sets, 10.0):
        assert outcome.success == pytest.approx(1.0)
        assert outcome.final_success == pytest.approx(1.0), "the expert stays at the goal"


def test_a_random_policy_solves_as_much_as_the_proof_says(sets):
    for outcome in evaluate_random(sets):
        assert outcome.success == pytest.approx(outcome.task.proof.random_success, abs=1e-9)


def test_a_constant_reward_tells_the_planner_nothing(sets):
    constant, random = evaluate(ConstantReward(), sets), evaluate_random(sets)
    for one, other in zip(constant, random, strict=True):
        assert one.success == pytest.approx(other.success, abs=1e-9)


def test_what_can_be_seen_of_the_true_reward_solves_every_task(sets):
    for outcome in evaluate(TrueRewardBySight(sets), sets):
        assert outcome.success >= 0.99


class AlwaysForward(TensorPolicy):
    def logits(self, views, commands):
        forward = torch.tensor([100.0, 0.0, 0.0, 0.0])
        return forward.expand(len(commands), len(views), 2, HEADINGS, 4)


def test_a_policy_acts_as_it_is(sets):
    outcomes = evaluate(AlwaysForward(), sets)
    assert all(outcome.success < 1e-9 for outcome in outcomes if outcome.task.kind == Kind.PICK)


def test_what_is_held_is_the_middle_object_state_of_pick_tasks_only(sets):
    for tasks in by_house(sets)[0]:
        held = tasks.held
        if tasks.tasks[0].kind == Kind.NAV:
            assert not held.any()
        else:
            third = held.shape[1] // 3
            assert held[:, third : 2 * third].all()
            assert held.sum() == third * len(held)


def test_parts_cover_every_task_once_in_order(sets):
    for tasks in by_house(sets)[0]:
        parts = tasks.split(2)
        assert [task for part in parts for task in part.tasks] == list(tasks.tasks)
        assert all(len(part.tasks) == len(part) <= 2 for part in parts)


def test_a_method_sees_training_tasks_only_and_no_goal_unless_it_is_an_oracle(sets):
    benchmark = tiny_benchmark()
    shown, oracle = (train_set(benchmark, sets, oracle=flag) for flag in (False, True))
    commands = [c for tasks in shown.tasks for c in tasks.commands]
    assert sorted(commands) == sorted(t.command for t in benchmark.select(split=Split.TRAIN))
    assert not any(tasks.goal.any() for tasks in shown.tasks)
    assert all(tasks.goal.any() for tasks in oracle.tasks)


def test_what_a_method_learns_from_is_the_same_without_the_test_tasks(sets):
    benchmark = tiny_benchmark()
    alone = replace(benchmark, tasks=benchmark.select(split=Split.TRAIN), views={})
    # Demonstrations are drawn with a seed that is a digest of the whole benchmark.
    vars(alone)["fingerprint"] = benchmark.fingerprint
    poor = load_task_sets(alone, device=torch.device("cpu"), renderer="rays")
    full, cut = (
        train_set(each, tasks, oracle=False) for each, tasks in ((benchmark, sets), (alone, poor))
    )
    assert full.vocabulary == cut.vocabulary
    assert any(task.split == Split.TEST_TASK for task in benchmark.tasks)
    for one, other in zip(full.tasks, cut.tasks, strict=True):
        assert one.views.house == other.views.house
        assert torch.equal(one.views.views, other.views.views)
        assert torch.equal(one.views.panorama_views, other.views.panorama_views)
        assert one.commands == other.commands
        for name in ("panoramas", "demonstrations", "held", "next_state", "start", "goal"):
            assert torch.equal(getattr(one, name), getattr(other, name))


def test_demonstrations_reach_the_goal_and_stay(sets):
    benchmark = tiny_benchmark()
    oracle = train_set(benchmark, sets, oracle=True)
    for tasks in oracle.tasks:
        cells = tasks.demonstrations // HEADINGS
        rows = torch.arange(len(cells))[:, None, None]
        at_goal = tasks.goal[rows, cells]
        assert at_goal[..., -1].all()
        assert (at_goal[..., 1:] >= at_goal[..., :-1]).all(), "once there, always there"
        assert cells.shape[1:] == (10, 31)


def test_demonstrations_depend_on_the_benchmark_alone(sets):
    first, second = (train_set(tiny_benchmark(), sets, oracle=False) for _ in range(2))
    for one, other in zip(first.tasks, second.tasks, strict=True):
        assert torch.equal(one.demonstrations, other.demonstrations)


def test_selecting_a_split_keeps_rows_together(sets):
    tasks = sets[0]
    chosen = select_split(tasks, tasks.tasks[0].split)
    assert chosen is not None
    row = tasks.tasks.index(chosen.tasks[-1])
    assert torch.equal(chosen.next_state[-1], tasks.next_state[row])
    assert select_split(tasks.rows([]), Split.TRAIN) is None
