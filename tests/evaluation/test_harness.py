"""The harness: exact controls, no leak of the goal, what methods are shown."""

from dataclasses import replace

import pytest
import torch
from benchmark_samples import TrueRewardBySight, tiny_benchmark, tiny_problems
from lcrl_bench.evaluation.problems import chunks, compile_problems, select_tasks, train_set

from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.evaluation.harness import (
    ConstantReward,
    evaluate,
    evaluate_optimal,
    evaluate_random,
)
from lcrl_bench.mdp.task_batch import HEADINGS
from lcrl_bench.methods.tensors import TensorPolicy


@pytest.fixture(scope="module")
def problems():
    return tiny_problems()


def test_the_optimal_policy_solves_every_task(problems):
    for outcome in evaluate_optimal(problems, 10.0):
        assert outcome.success == pytest.approx(1.0)
        assert outcome.final_success == pytest.approx(1.0), "the expert stays at the goal"


def test_a_random_policy_solves_as_much_as_the_proof_says(problems):
    for outcome in evaluate_random(problems):
        assert outcome.success == pytest.approx(outcome.task.proof.random_success, abs=1e-9)


def test_a_constant_reward_tells_the_planner_nothing(problems):
    constant, random = evaluate(ConstantReward(), problems), evaluate_random(problems)
    for one, other in zip(constant, random, strict=True):
        assert one.success == pytest.approx(other.success, abs=1e-9)


def test_what_can_be_seen_of_the_true_reward_solves_every_task(problems):
    for outcome in evaluate(TrueRewardBySight(tiny_benchmark(), problems), problems):
        assert outcome.success >= 0.99


class AlwaysForward(TensorPolicy):
    def logits(self, views, commands):
        forward = torch.tensor([100.0, 0.0, 0.0, 0.0])
        return forward.expand(len(commands), len(views.panorama_views), 2, HEADINGS, 4)


def test_a_policy_acts_as_it_is(problems):
    outcomes = evaluate(AlwaysForward(), problems)
    assert all(outcome.success < 1e-9 for outcome in outcomes if outcome.task.kind == Kind.PICK)


def test_what_is_held_is_the_middle_object_state_of_pick_tasks_only(problems):
    for tasks in problems[0].compiled.sets:
        held = tasks.held
        if tasks.tasks[0].kind == Kind.NAV:
            assert not held.any()
        else:
            third = held.shape[1] // 3
            assert held[:, third : 2 * third].all()
            assert held.sum() == third * len(held)


def test_chunks_cover_every_task_once_in_order(problems):
    for tasks in problems[0].compiled.sets:
        parts = chunks(tasks, size=2)
        assert [task for part in parts for task in part.tasks] == list(tasks.tasks)
        assert all(len(part.tasks) == len(part) <= 2 for part in parts)


def test_a_method_sees_training_tasks_only_and_no_goal_unless_it_is_an_oracle(problems):
    benchmark = tiny_benchmark()
    shown, oracle = (train_set(benchmark, problems, oracle=flag) for flag in (False, True))
    commands = [c for house in shown.houses for tasks in house.tasks for c in tasks.commands]
    assert sorted(commands) == sorted(t.command for t in benchmark.select(split=Split.TRAIN))
    assert not any(tasks.batch.goal.any() for house in shown.houses for tasks in house.tasks)
    assert all(tasks.batch.goal.any() for house in oracle.houses for tasks in house.tasks)


def test_what_a_method_learns_from_is_the_same_without_the_test_tasks(problems):
    benchmark = tiny_benchmark()
    alone = replace(benchmark, tasks=benchmark.select(split=Split.TRAIN), views={})
    # Demonstrations are drawn with a seed that is a digest of the whole benchmark.
    vars(alone)["fingerprint"] = benchmark.fingerprint
    poor = compile_problems(alone, device=torch.device("cpu"), renderer="rays")
    full, cut = (
        train_set(each, compiled, oracle=False)
        for each, compiled in ((benchmark, problems), (alone, poor))
    )
    assert full.vocabulary == cut.vocabulary
    assert any(task.split == Split.TEST_TASK for task in benchmark.tasks)
    for one, other in zip(full.houses, cut.houses, strict=True):
        assert torch.equal(one.views.views, other.views.views)
        assert torch.equal(one.views.panorama_views, other.views.panorama_views)
        for a, b in zip(one.tasks, other.tasks, strict=True):
            assert a.commands == b.commands
            for name in ("panoramas", "demonstrations", "held"):
                assert torch.equal(getattr(a, name), getattr(b, name))
            assert torch.equal(a.batch.next_state, b.batch.next_state)


def test_demonstrations_reach_the_goal_and_stay(problems):
    benchmark = tiny_benchmark()
    oracle = train_set(benchmark, problems, oracle=True)
    for house in oracle.houses:
        for tasks in house.tasks:
            cells = tasks.demonstrations // HEADINGS
            rows = torch.arange(len(cells))[:, None, None]
            at_goal = tasks.batch.goal[rows, cells]
            assert at_goal[..., -1].all()
            assert (at_goal[..., 1:] >= at_goal[..., :-1]).all(), "once there, always there"
            assert cells.shape[1:] == (10, 31)


def test_demonstrations_depend_on_the_benchmark_alone(problems):
    first, second = (train_set(tiny_benchmark(), problems, oracle=False) for _ in range(2))
    for one, other in zip(first.houses, second.houses, strict=True):
        for a, b in zip(one.tasks, other.tasks, strict=True):
            assert torch.equal(a.demonstrations, b.demonstrations)


def test_selecting_a_split_keeps_rows_together(problems):
    tasks = problems[0].compiled.sets[0]
    chosen = select_tasks(tasks, tasks.tasks[0].split)
    assert chosen is not None
    row = tasks.tasks.index(chosen.tasks[-1])
    assert torch.equal(chosen.batch.next_state[-1], tasks.batch.next_state[row])
    assert select_tasks(replace(tasks, tasks=tasks.tasks[:0]), Split.TRAIN) is None
