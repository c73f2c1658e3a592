"""What is measured of a task: against every action sequence, and at the ends of each scale."""

import itertools

import numpy as np
import pytest
import torch
from benchmark_samples import tiny_task_sets
from hypothesis import given, settings
from hypothesis import strategies as st
from mdp_samples import corridor, random_policy

from lcrl_bench.benchmarks.dynamics import pick_goal, pick_transitions
from lcrl_bench.benchmarks.task import Kind, Proof, Split, Task
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.evaluation.harness import evaluate_optimal, evaluate_random
from lcrl_bench.evaluation.outcome import Failure, Outcome, best_goal_value, outcomes_of
from lcrl_bench.mdp.policy_outcome import follow
from lcrl_bench.mdp.success import optimal_length
from lcrl_bench.mdp.task_batch import HEADINGS, Action, ObjectState, TaskBatch
from lcrl_bench.panoramas import Panoramas

TILES = 3
"""A corridor to the north: the object stands at its first tile, and belongs at its last."""
NORTH = 0


def pick_tasks(*, horizon: int, start_tile: int = 1) -> TaskSet:
    """One PICK task in a corridor, facing north."""
    moves = corridor(TILES, goal_cell=0).next_state[0].numpy()
    reach_a, reach_b = np.arange(TILES) == 0, np.arange(TILES) == TILES - 1
    batch = TaskBatch(
        next_state=torch.from_numpy(pick_transitions(moves, reach_a, reach_b))[None],
        goal=torch.from_numpy(pick_goal(TILES))[None],
        start=torch.tensor([start_tile * HEADINGS + NORTH]),
        horizon=horizon,
        discount=0.9,
    )
    return task_set(batch, Kind.PICK)


def nav_tasks(*, horizon: int, goal_tile: int = 1) -> TaskSet:
    """One NAV task in a corridor, facing south at its end."""
    return task_set(corridor(TILES, goal_cell=goal_tile, horizon=horizon), Kind.NAV)


def task_set(batch: TaskBatch, kind: Kind) -> TaskSet:
    proof = Proof(int(optimal_length(batch)), 1.0, 0.0)
    task = Task("t", kind, Split.TRAIN, "h", "go to the bed", "bed", 0, 0, proof)
    held = torch.zeros_like(batch.goal)
    if kind == Kind.PICK:
        held.view(1, 3, -1)[:, ObjectState.HELD] = True
    return TaskSet(
        next_state=batch.next_state,
        goal=batch.goal,
        start=batch.start,
        horizon=batch.horizon,
        discount=batch.discount,
        views=Panoramas(torch.zeros(1, 2, 2, dtype=torch.uint8), torch.zeros(1, 4).long()),
        panoramas=torch.zeros_like(batch.goal, dtype=torch.int64),
        commands=(task.command,),
        held=held,
        tasks=(task,),
    )


def outcome_of(tasks: TaskSet, policy: torch.Tensor) -> Outcome:
    (outcome,) = outcomes_of(tasks, follow(tasks, policy, waypoint=tasks.held))
    return outcome


def doing(tasks: TaskSet, *actions: Action) -> torch.Tensor:
    """The policy that does these actions and then turns in place."""
    policy = torch.zeros(1, tasks.horizon, tasks.states, 4, dtype=torch.float64)
    for t in range(tasks.horizon):
        policy[:, t, :, actions[t] if t < len(actions) else Action.LEFT] = 1.0
    return policy


def enumerated(tasks: TaskSet, policy: torch.Tensor) -> Outcome:
    """The outcome, from the weight of each of the 4^H action sequences."""
    batch, task = tasks, tasks.task
    length = task.proof.optimal_length
    sums = dict.fromkeys(("success", "final", "path", "value"), 0.0)
    failures = dict.fromkeys(Failure, 0.0)
    best = chance = 0.0
    for actions in itertools.product(range(4), repeat=batch.horizon):
        states, weight = [int(batch.start[0])], 1.0
        for t, action in enumerate(actions):
            weight *= float(policy[0, t, states[-1], action])
            states.append(int(batch.next_state[0, states[-1], action]))
        there = [bool(batch.goal[0, state // HEADINGS]) for state in states]
        value = sum(batch.discount**t for t, now in enumerate(there) if now)
        best, chance = max(best, value), chance + value / 4**batch.horizon
        sums["value"] += weight * value
        sums["final"] += weight * there[-1]
        if any(there):
            sums["success"] += weight
            sums["path"] += weight * length / max(there.index(True), length)
        elif task.kind == Kind.PICK:
            failures[failure_of(states)] += weight
    regret = (best - sums["value"]) / (best - chance)
    shown = failures if task.kind == Kind.PICK else {}
    return Outcome(task, sums["success"], sums["final"], sums["path"], regret, shown)


def failure_of(states: list[int]) -> Failure:
    """How one episode in the corridor failed."""
    layers = [state // HEADINGS // TILES for state in states]
    tile = states[-1] // HEADINGS % TILES
    if layers[-1] == ObjectState.HELD:
        return Failure.HELD_AT_B if tile == TILES - 1 else Failure.HELD_ELSEWHERE
    if ObjectState.HELD in layers:
        return Failure.PUT_BACK
    ends = {0: Failure.WAITS_AT_A, TILES - 1: Failure.AT_B_WITHOUT_OBJECT}
    return ends.get(tile, Failure.ELSEWHERE)


def assert_equal(found: Outcome, expected: Outcome) -> None:
    for name in ("success", "final_success", "path_weighted", "regret", "failures"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), abs=1e-12), name


@settings(max_examples=6)
@given(st.integers(0, 10_000))
def test_an_outcome_of_pick_is_what_all_action_sequences_make_it(seed):
    tasks = pick_tasks(horizon=5, start_tile=0)
    policy = random_policy(tasks, seed)
    assert_equal(outcome_of(tasks, policy), enumerated(tasks, policy))


@settings(max_examples=6)
@given(st.integers(0, 10_000))
def test_an_outcome_of_nav_is_what_all_action_sequences_make_it(seed):
    tasks = nav_tasks(horizon=5)
    policy = random_policy(tasks, seed)
    assert_equal(outcome_of(tasks, policy), enumerated(tasks, policy))


F, L, I = Action.FORWARD, Action.LEFT, Action.INTERACT  # noqa: E741


@pytest.mark.parametrize(
    ("start_tile", "actions", "failure"),
    [
        (0, (), Failure.WAITS_AT_A),
        (1, (), Failure.ELSEWHERE),
        (1, (F,), Failure.AT_B_WITHOUT_OBJECT),
        (0, (I, I), Failure.PUT_BACK),
        (0, (I, I, F, F), Failure.PUT_BACK),
        (0, (I, F, F), Failure.HELD_AT_B),
        (0, (I, F), Failure.HELD_ELSEWHERE),
        (0, (I, F, I), Failure.HELD_ELSEWHERE),
    ],
)
def test_each_way_to_fail_has_its_name(start_tile, actions, failure):
    tasks = pick_tasks(horizon=10, start_tile=start_tile)
    outcome = outcome_of(tasks, doing(tasks, *actions))
    assert outcome.success == 0
    assert outcome.failures == {name: float(name == failure) for name in Failure}


def test_taking_the_object_away_again_is_a_success_that_did_not_last():
    tasks = pick_tasks(horizon=10, start_tile=0)
    stays, leaves = (I, F, F, I), (I, F, F, I, I)
    assert outcome_of(tasks, doing(tasks, *stays)).final_success == 1
    outcome = outcome_of(tasks, doing(tasks, *leaves))
    assert (outcome.success, outcome.final_success) == (1, 0)
    assert set(outcome.failures.values()) == {0.0}
    assert outcome.path_weighted == 1, "it arrived by the shortest way"
    assert 0 < outcome.regret < 1, "but every later step of the goal is missed"


def test_twice_the_optimal_length_is_half_a_success():
    tasks = pick_tasks(horizon=12, start_tile=0)
    length = tasks.tasks[0].proof.optimal_length
    late = (L,) * 4 + (I, F, F, I)
    outcome = outcome_of(tasks, doing(tasks, *late))
    assert length == 4
    assert outcome.success == 1
    assert outcome.path_weighted == pytest.approx(4 / 8)


def test_a_task_that_starts_at_its_goal_needs_no_way():
    tasks = nav_tasks(horizon=4, goal_tile=0)
    outcome = outcome_of(tasks, doing(tasks))
    assert (outcome.success, outcome.path_weighted, outcome.regret) == (1, 1, 0)


def test_a_task_that_can_not_be_solved_has_nothing_to_regret():
    tasks = nav_tasks(horizon=1, goal_tile=2)
    assert outcome_of(tasks, doing(tasks)).regret == 0


def test_the_optimum_regrets_nothing_and_takes_the_shortest_way():
    for outcome in evaluate_optimal(tiny_task_sets(), 10.0):
        assert outcome.regret == pytest.approx(0, abs=1e-9)
        assert outcome.path_weighted == pytest.approx(1)
        assert sum(outcome.failures.values()) == pytest.approx(0, abs=1e-9)


def test_a_random_policy_s_regret_is_one_and_its_failures_are_all_the_rest():
    for outcome in evaluate_random(tiny_task_sets()):
        assert outcome.regret == pytest.approx(1)
        assert outcome.path_weighted <= outcome.success + 1e-12
        if outcome.task.kind == Kind.PICK:
            assert sum(outcome.failures.values()) == pytest.approx(1 - outcome.success)
            assert min(outcome.failures.values()) >= 0
        else:
            assert outcome.failures == {}


def test_the_best_return_is_the_one_that_the_proof_states():
    for tasks in tiny_task_sets():
        for part in tasks.parts:
            lengths = torch.tensor([task.proof.optimal_length for task in part.tasks])
            best = 10.0 * best_goal_value(part, lengths)
            stated = torch.tensor([task.proof.value for task in part.tasks], dtype=torch.float64)
            torch.testing.assert_close(best, stated)


def test_a_journey_that_did_not_watch_the_object_is_refused():
    tasks = pick_tasks(horizon=4, start_tile=0)
    with pytest.raises(ValueError, match=r"waypoint=tasks\.held"):
        outcomes_of(tasks, follow(tasks, doing(tasks, Action.INTERACT)))
