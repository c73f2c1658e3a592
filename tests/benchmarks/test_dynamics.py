"""What the four actions do in a house's transition tables."""

import numpy as np
import pytest
from grid_samples import strip
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.benchmarks.dynamics import (
    ObjectState,
    nav_transitions,
    pick_goal,
    pick_transitions,
)
from lcrl_bench.mdp.task_batch import Action

NORTH, EAST, SOUTH, WEST = range(4)


def state(tile: int, heading: int, held: int = 0, tiles: int = 3) -> int:
    return (held * tiles + tile) * 4 + heading


def test_forward_follows_the_heading_and_stops_at_a_wall():
    table = nav_transitions(strip(3))
    assert table[state(0, EAST), Action.FORWARD] == state(1, EAST)
    assert table[state(2, EAST), Action.FORWARD] == state(2, EAST)
    assert table[state(1, WEST), Action.FORWARD] == state(0, WEST)
    assert table[state(1, NORTH), Action.FORWARD] == state(1, NORTH)


def test_left_turns_against_the_clock_and_right_with_it():
    table = nav_transitions(strip(1))
    assert table[NORTH, Action.LEFT] == WEST
    assert table[NORTH, Action.RIGHT] == EAST
    assert table[WEST, Action.RIGHT] == NORTH


def test_interacting_without_an_object_does_nothing():
    table = nav_transitions(strip(3))
    assert (table[:, Action.INTERACT] == np.arange(len(table))).all()


@given(st.integers(2, 6), st.randoms(use_true_random=False))
@settings(max_examples=25)
def test_turning_left_undoes_turning_right_in_every_state(tiles, random):
    reach = np.array([random.random() < 0.5 for _ in range(tiles)])
    for table in (
        nav_transitions(strip(tiles)),
        pick_transitions(nav_transitions(strip(tiles)), reach, ~reach),
    ):
        there = table[:, Action.RIGHT]
        assert (table[there, Action.LEFT] == np.arange(len(table))).all()


@pytest.fixture
def carry():
    reach_a, reach_b = np.array([True, False, False]), np.array([False, False, True])
    return pick_transitions(nav_transitions(strip(3)), reach_a, reach_b)


def test_the_object_is_taken_only_within_reach_of_a(carry):
    at_a, held = ObjectState.AT_A, ObjectState.HELD
    assert carry[state(0, EAST, at_a), Action.INTERACT] == state(0, EAST, held)
    assert carry[state(1, EAST, at_a), Action.INTERACT] == state(1, EAST, at_a)
    assert carry[state(2, EAST, at_a), Action.INTERACT] == state(2, EAST, at_a)


def test_a_held_object_is_put_where_it_came_from_or_where_it_is_wanted(carry):
    held = ObjectState.HELD
    assert carry[state(0, EAST, held), Action.INTERACT] == state(0, EAST, ObjectState.AT_A)
    assert carry[state(1, EAST, held), Action.INTERACT] == state(1, EAST, held)
    assert carry[state(2, EAST, held), Action.INTERACT] == state(2, EAST, ObjectState.AT_B)


def test_an_object_at_b_can_be_taken_again(carry):
    assert carry[state(2, WEST, ObjectState.AT_B), Action.INTERACT] == state(
        2, WEST, ObjectState.HELD
    )


def test_moving_never_moves_the_object(carry):
    states = np.arange(len(carry))
    for action in (Action.FORWARD, Action.LEFT, Action.RIGHT):
        assert (carry[:, action] // 12 == states // 12).all()


def test_the_goal_of_a_pick_task_is_the_object_at_b_wherever_the_agent_stands():
    assert pick_goal(3).tolist() == [False] * 6 + [True] * 3
