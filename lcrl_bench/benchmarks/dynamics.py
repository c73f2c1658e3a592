"""The transition tables of a house's tasks, from its grid and the tiles within reach.

State layout as in `mdp.task_batch`: `state = (object_state * tiles + tile) * 4 + heading`.
Source: paper, section "Environment": step forward one tile, turn left or right, interact; within a
task there is one object and two locations it can be in, so the state space grows by a factor of 3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS, OBJECT_STATES, Action, ObjectState
from lcrl_bench.scenes.grid import Grid


def nav_transitions(grid: Grid) -> NDArray[np.int64]:
    """The successor of each state and action, without an object.

    Returns:
        int64 [tiles * 4, action]; a blocked step or an interaction leaves the state unchanged.
    """
    tile, heading = np.divmod(np.arange(grid.tiles * HEADINGS), HEADINGS)
    ahead = grid.neighbours[tile, heading]
    table = np.empty((grid.tiles * HEADINGS, ACTIONS), np.int64)
    table[:, Action.FORWARD] = np.where(ahead < 0, tile, ahead) * HEADINGS + heading
    table[:, Action.LEFT] = tile * HEADINGS + (heading - 1) % HEADINGS
    table[:, Action.RIGHT] = tile * HEADINGS + (heading + 1) % HEADINGS
    table[:, Action.INTERACT] = np.arange(len(table))
    return table


def pick_transitions(
    moves: NDArray[np.int64], reach_a: NDArray[np.bool_], reach_b: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """The successor of each state and action when an object can be taken or put at A or B.

    Args:
        moves: The house's `nav_transitions`.
        reach_a: bool [tile]: whether place A is within reach.
        reach_b: bool [tile]: whether place B is within reach; if both are, B takes precedence.

    Returns:
        int64 [3 * tiles * 4, action].
    """
    states = len(moves)
    table = np.concatenate([moves + state * states for state in ObjectState])
    here = np.arange(states)
    at_a, at_b = np.repeat(reach_a, HEADINGS), np.repeat(reach_b, HEADINGS)
    interact = table[:, Action.INTERACT].reshape(OBJECT_STATES, states)
    held = here + ObjectState.HELD * states
    interact[ObjectState.AT_A] = np.where(at_a, held, interact[ObjectState.AT_A])
    interact[ObjectState.AT_B] = np.where(at_b, held, interact[ObjectState.AT_B])
    put_a = np.where(at_a, here, interact[ObjectState.HELD])
    interact[ObjectState.HELD] = np.where(at_b, here + ObjectState.AT_B * states, put_a)
    table[:, Action.INTERACT] = interact.reshape(-1)
    return table


def pick_goal(tiles: int) -> NDArray[np.bool_]:
    """The goal of a PICK task: the object is at B, wherever the agent stands.

    Returns:
        bool [3 * tiles].
    """
    goal = np.zeros((OBJECT_STATES, tiles), bool)
    goal[ObjectState.AT_B] = True
    return goal.reshape(-1)
