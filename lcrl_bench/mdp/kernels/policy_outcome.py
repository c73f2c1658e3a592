"""Outcomes of greedy policies, compiled: what `policy_outcome.follow_greedy` computes, in float64.

Letters as in `planning` and `policy_outcome`: V_t(s), Q_t(s, a), d_t(s), gamma, H. One task at a
time, so that its data stay in a core's cache. No policy is stored: the forward pass compares the
values of actions again, in the few states that can have been reached.

Values are rounded exactly as torch rounds them (no fused multiply-add), so that actions are tied
here if and only if they are tied there.

Imports numba: import this module only where numba is installed. The kernel is in one file, because
numba's cache does not notice an edit in another.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.mdp.kernels.compilation import compiled

# Parts of the probability mass that are tracked: all, not yet at the goal, nor at the waypoint.
_ALL, _LOST, _MISSED = 0, 1, 2

_compiled = compiled(error_model="numpy")


@_compiled
def follow(
    next_state: NDArray[np.int64],
    goal: NDArray[np.bool_],
    waypoint: NDArray[np.bool_],
    reward: NDArray[np.float64],
    start: NDArray[np.int64],
    discount: float,
    tolerance: float,
    first: int,
    end: int,
    arrival: NDArray[np.float64],
    final: NDArray[np.float64],
    lost: NDArray[np.float64],
    missed: NDArray[np.float64],
    goal_value: NDArray[np.float64],
    passed: NDArray[np.float64],
) -> None:
    """Follow tasks `first` to `end - 1` of a batch into the fields of a `PolicyOutcome`.

    Args:
        next_state: [task, state, action], within the states.
        goal: [task, cell].
        waypoint: [task, cell].
        reward: [task, cell], finite.
        start: [task].
        discount: gamma.
        tolerance: Actions within `tolerance * max_s |V_t(s)|` of the best are tied.
        first: First task.
        end: The task after the last.
        arrival: [task, horizon + 1], zeros, written.
        final: [task, state], written.
        lost: [task, state], written.
        missed: [task, state], written.
        goal_value: [task], zeros, written.
        passed: [task], zeros, written.
    """
    states, horizon = next_state.shape[1], arrival.shape[1] - 1
    values, margins = np.empty((horizon + 1, states)), np.empty(horizon)
    mass = np.empty((2, 3, states))
    for task in range(first, end):
        table, r = next_state[task], reward[task]
        _plan(table, r, discount, tolerance, values, margins)
        mass[:] = 0.0
        mass[0, :, start[task]] = 1.0
        weight = 1.0
        for t in range(horizon + 1):
            here, onward = mass[t % 2], mass[(t + 1) % 2]
            met, came, saw = _arrive(here, goal[task], waypoint[task])
            goal_value[task] += weight * met
            arrival[task, t] = came
            passed[task] += saw
            weight *= discount
            if t < horizon:
                _step(table, r, values[t + 1], discount, margins[t], here, onward)
        final[task], lost[task], missed[task] = here[_ALL], here[_LOST], here[_MISSED]


@_compiled
def _plan(next_state, r, discount, tolerance, values, margins):  # noqa: ANN001, ANN202
    """V_t of every step, and the margin within which actions are tied."""
    horizon, states = len(margins), values.shape[1]
    for state in range(states):
        values[horizon, state] = r[state // 4]
    for t in range(horizon - 1, -1, -1):
        v_next, largest = values[t + 1], 0.0
        for state in range(states):
            best = _q(next_state, r, v_next, discount, state, 0)
            for action in range(1, 4):
                best = max(best, _q(next_state, r, v_next, discount, state, action))
            values[t, state] = best
            largest = max(largest, abs(best))
        margins[t] = tolerance * largest


@_compiled
def _q(next_state, r, v_next, discount, state, action):  # noqa: ANN001, ANN202
    """Q_t(s, a), rounded after the multiplication and after the addition."""
    return r[state // 4] + discount * v_next[next_state[state, action]]


@_compiled
def _arrive(mass, goal, waypoint):  # noqa: ANN001, ANN202
    """Mass in the goal; mass that meets the goal, and the waypoint, for the first time."""
    met, came, saw = 0.0, 0.0, 0.0
    for cell in range(len(goal)):
        if goal[cell] or waypoint[cell]:
            for state in range(4 * cell, 4 * cell + 4):
                if goal[cell]:
                    met += mass[_ALL, state]
                    came += mass[_LOST, state]
                    mass[_LOST, state] = 0.0
                if waypoint[cell]:
                    saw += mass[_MISSED, state]
                    mass[_MISSED, state] = 0.0
    return met, came, saw


@_compiled
def _step(next_state, r, v_next, discount, margin, here, onward):  # noqa: ANN001, ANN202
    """Split every state's mass among its tied actions; `onward` is overwritten."""
    onward[:] = 0.0
    q = np.empty(4)
    for state in range(here.shape[1]):
        if here[_ALL, state] > 0.0:
            best = -np.inf
            for action in range(4):
                q[action] = _q(next_state, r, v_next, discount, state, action)
                best = max(best, q[action])
            tied = 0
            for action in range(4):
                tied += q[action] >= best - margin
            for action in range(4):
                if q[action] >= best - margin:
                    leads_to = next_state[state, action]
                    for part in range(3):
                        onward[part, leads_to] += here[part, state] / tied
