"""Soft marginals, compiled: what `maximum_entropy.soft_marginals` computes, to float32 accuracy.

Letters as in `planning` and `visitation`: V_t(s), pi_t(a|s), d_t(s), alpha, gamma, H. One task at a
time, so that its data stay in a core's cache. Three ideas:

- *Order.* States are renumbered breadth first from the start, so the states within t actions of it
  are the first `within[t]`: step t skips states that can't have been reached yet.
- *Tiles.* `TILE` states at a time: their successors' values are gathered first; the rest is loops
  of constant length over small contiguous arrays, which LLVM vectorises. A tile of weights or of a
  policy is `[action * TILE + i]`.
- *Differences.* Values are float64; (V_{t+1}(f(s,a)) - max_a V_{t+1}(f(s,a))) gamma / alpha is
  float32. So exponentials are cheap, and errors don't grow with the size of the values.

Imports numba: import this module only where numba is installed. The kernel is in one file, because
numba's cache does not notice an edit in another.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.mdp.kernels.compilation import compiled

TILE = 64
"""States per tile."""

LN_2 = 0.6931471805599453

# A float32 of this size has no fractional bits: adding it rounds to an integer.
_ROUNDING = np.float32(3 << 22)

# Exponent of the smallest normal float32.
_LEAST = np.float32(-126.0)

# 2^x on [-1/2, 1/2] as 1 + x (...), relative error 2e-9; least squares reweighted to equal ripples.
_E1 = np.float32(6.93147203e-01)
_E2 = np.float32(2.40226479e-01)
_E3 = np.float32(5.55033247e-02)
_E4 = np.float32(9.61843736e-03)
_E5 = np.float32(1.33988744e-03)
_E6 = np.float32(1.53533618e-04)

# 2 artanh(s) on [-1/3, 1/3] as s times a polynomial in s^2, error 4e-9 of the factor.
_L0 = np.float32(2.00000001)
_L1 = np.float32(0.66666315)
_L2 = np.float32(0.40024910)
_L3 = np.float32(0.27960603)
_L4 = np.float32(0.28178334)

_ONE, _TWO, _LOG_TWO = np.float32(1.0), np.float32(2.0), np.float32(LN_2)

# No reassociation: results don't depend on how loops are vectorised.
_compiled = compiled(error_model="numpy", fastmath={"contract", "nnan", "nsz"})


@_compiled
def solve(
    next_state: NDArray[np.int64],
    reward: NDArray[np.float32],
    start: NDArray[np.int64],
    horizon: int,
    discount: float,
    temperature: float,
    first: int,
    end: int,
    occupancy: NDArray[np.float32],
    start_value: NDArray[np.float32],
) -> None:
    """Solve tasks `first` to `end - 1` of a batch into `occupancy` and `start_value`.

    Args:
        next_state: [task, state, action], within the states.
        reward: [task, cell], finite.
        start: [task].
        horizon: H.
        discount: gamma.
        temperature: alpha > 0.
        first: First task.
        end: The task after the last.
        occupancy: [task, cell], written.
        start_value: [task], written.
    """
    states, cells = next_state.shape[1], reward.shape[1]
    room = -(-states // TILE) * TILE
    order, rank = np.empty(states, np.int64), np.empty(states, np.int64)
    within = np.empty(horizon + 1, np.int64)
    successors = np.empty(4 * room, np.uint32)
    r, values, mass = np.zeros(room), np.zeros((2, room)), np.zeros((2, room))
    policy = np.empty((horizon, 4 * room), np.float32)
    visits, folded = np.empty(room), np.empty(cells)
    for task in range(first, end):
        _order(next_state[task], start[task], order, rank, within)
        _place(next_state[task], order, rank, within, successors)
        for k in range(within[horizon]):
            r[k] = reward[task, order[k] // 4]
        _backward(within, successors, r, discount, temperature, values, policy)
        _forward(within, successors, policy, discount, mass, visits)
        start_value[task] = values[0, 0]
        folded[:] = 0.0
        for k in range(within[horizon]):
            folded[order[k] // 4] += visits[k]
        for cell in range(cells):
            occupancy[task, cell] = folded[cell]


@_compiled
def _order(next_state, start, order, rank, within):  # noqa: ANN001, ANN202
    """Number states by distance from the start; unreachable states get rank -1."""
    rank[:] = -1
    order[0], rank[start] = start, 0
    count, looked_at = 1, 0
    for t in range(len(within) - 1):
        within[t] = count
        while looked_at < within[t]:
            for action in range(4):
                state = next_state[order[looked_at], action]
                if rank[state] < 0:
                    order[count], rank[state] = state, count
                    count += 1
            looked_at += 1
    within[-1] = count


@_compiled
def _place(next_state, order, rank, within, successors):  # noqa: ANN001, ANN202
    """Successors of the states that act, tile by tile; padding leads to state 0."""
    acting = within[-2] if len(within) > 1 else 0
    for k in range(-(-acting // TILE) * TILE):
        at = k // TILE * 4 * TILE + k % TILE
        for action in range(4):
            leads_to = rank[next_state[order[k], action]] if k < acting else 0
            successors[at + action * TILE] = leads_to


@_compiled
def _backward(within, successors, r, discount, temperature, values, policy):  # noqa: ANN001, ANN202
    """V_t into `values[t % 2]`, so V_0 is in `values[0]` at the end; pi_t into `policy[t]`."""
    horizon = len(policy)
    # Finite, as what it multiplies may be zero.
    scale = min(discount / (temperature * LN_2), 1e300)
    onward, best, logarithm = np.empty(4 * TILE), np.empty(TILE), np.empty(TILE, np.float32)
    for k in range(within[horizon]):
        values[horizon % 2, k] = r[k]
    for t in range(horizon - 1, -1, -1):
        v_next = values[(t + 1) % 2]
        for k in range(0, within[t], TILE):
            leads_to = successors[4 * k : 4 * (k + TILE)]
            for i in range(4 * TILE):
                onward[i] = v_next[leads_to[i]]
            tile = policy[t, 4 * k : 4 * (k + TILE)]
            _compare(onward, scale, best, tile)
            _normalise(tile, logarithm)
            v, here = values[t % 2, k : k + TILE], r[k : k + TILE]
            for i in range(TILE):
                v[i] = here[i] + (discount * best[i] + temperature * np.float64(logarithm[i]))


@_compiled
def _compare(onward, scale, best, tile):  # noqa: ANN001, ANN202
    """The best successor value, and each action's distance from it as an exponent of two."""
    for i in range(TILE):
        forward, left = onward[i], onward[TILE + i]
        right, interact = onward[2 * TILE + i], onward[3 * TILE + i]
        moving = forward if forward > left else left
        other = right if right > interact else interact
        most = moving if moving > other else other
        best[i] = most
        tile[i] = (forward - most) * scale
        tile[TILE + i] = (left - most) * scale
        tile[2 * TILE + i] = (right - most) * scale
        tile[3 * TILE + i] = (interact - most) * scale


@_compiled
def _normalise(tile, logarithm):  # noqa: ANN001, ANN202
    """Exponents of two to a policy, and the natural logarithm of the weights' sum."""
    for i in range(TILE):
        forward, left = _power_of_two(tile[i]), _power_of_two(tile[TILE + i])
        right, interact = _power_of_two(tile[2 * TILE + i]), _power_of_two(tile[3 * TILE + i])
        total = (forward + left) + (right + interact)
        share = _ONE / total
        tile[i] = forward * share
        tile[TILE + i] = left * share
        tile[2 * TILE + i] = right * share
        tile[3 * TILE + i] = interact * share
        # The best action's weight is 1, so the sum is in [1, 4], where
        # log x = log 2 + 2 artanh((x - 2) / (x + 2)).
        s = (total - _TWO) / (total + _TWO)
        z = s * s
        logarithm[i] = _LOG_TWO + s * (_L0 + z * (_L1 + z * (_L2 + z * (_L3 + z * _L4))))


@_compiled
def _power_of_two(x):  # noqa: ANN001, ANN202
    """2^x of a float32 x <= 0: a polynomial, and the integer part added to the exponent bits."""
    x = x if x > _LEAST else _LEAST
    shifted = np.float32(x + _ROUNDING)
    f = x - (shifted - _ROUNDING)
    p = np.float32(_ONE + f * (_E1 + f * (_E2 + f * (_E3 + f * (_E4 + f * (_E5 + f * _E6))))))
    return np.int32(p.view(np.int32) + (shifted.view(np.int32) << 23)).view(np.float32)


@_compiled
def _forward(within, successors, policy, discount, mass, visits):  # noqa: ANN001, ANN202
    """rho(s) = sum_t gamma^t d_t(s) into `visits`, d_t in `mass[t % 2]`."""
    horizon = len(policy)
    reached = within[horizon]
    mass[:, :reached] = 0.0
    visits[:reached] = 0.0
    mass[0, 0] = 1.0
    weight = 1.0
    for t in range(horizon):
        d, d_next, pi = mass[t % 2], mass[(t + 1) % 2], policy[t]
        for k in range(within[t]):
            here = d[k]
            d[k] = 0.0
            visits[k] += weight * here
            # Unsigned, or numba would check for negative indices.
            at = np.uint32(k // TILE * 4 * TILE + k % TILE)
            for action in range(4):
                entry = at + np.uint32(action * TILE)
                d_next[successors[entry]] += here * pi[entry]
        weight *= discount
    for k in range(reached):
        visits[k] += weight * mass[horizon % 2, k]
