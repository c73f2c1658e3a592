"""DQN agents act and learn, compiled: what `learning.act_and_learn` computes, to float32 accuracy.

Letters as in `agents`: s, a, s', R, Q, Q', y. One agent at a time takes all its rounds, so that its
networks, moments and memory stay in a core's cache; torch takes a round of all agents at a time,
and each of its operations goes through memory. Random numbers are those of `draws`, to the bit.

Products are NumPy's, which numba hands to BLAS; the rest is loops that LLVM vectorises. A network
is a tuple of arrays of one agent: [row, hidden], [hidden, hidden], [hidden, action], then the
biases of the last two, [1, hidden] and [1, action].

Imports numba: import this module only where numba is installed. The kernel is in one file, because
numba's cache does not notice an edit in another.
"""

# numba infers the types of what it compiles.
# ruff: noqa: ANN001, ANN201, ANN202

from __future__ import annotations

import numpy as np

from lcrl_bench.mdp.kernels.compilation import compiled

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_UNIT = np.float32(2.0**-24)
_HALF, _ONE, _ZERO = np.float32(0.5), np.float32(1.0), np.float32(0.0)

# No reassociation: results don't depend on how loops are vectorised.
_compiled = compiled(error_model="numpy", fastmath={"contract", "nsz"})

# Nor fused multiply-add, where a difference of nearly equal numbers matters.
_rounded = compiled(error_model="numpy")


@_compiled
def learn(world, memory, networks, targets, moments, squares, running, plan, first, end, losses):
    """Agents `first` to `end - 1` take all rounds of a plan; a round is a step and a gradient step.

    Args:
        world: next_state int64 [task, state, action], start int64 [task], inputs int64 [task,
            state, 3], rewards float32 [task, cell], potentials float32 [task, state] (or [task, 0]
            for none), seeds int64 [task].
        memory: Current states int64 [task, episode] and the ring int32 [task, capacity, 3];
            written.
        networks: Q of all agents, each array with a task axis in front; written.
        targets: Q', written.
        moments: Adam's running means of gradients, like `networks`; written.
        squares: Those of their squares; written.
        running: Mean and square of rewards, float32 [task, 1] each; written.
        plan: What `_plan` of the torch module returns.
        first: First task.
        end: The task after the last.
        losses: float64 [task]: the sum of the losses, written.
    """
    next_state, start, inputs, rewards, potentials, seeds = world
    states, ring = memory
    counter, written, taken, horizon, learned, interval, batch, double, discount = plan[0]
    fresh, kept_square, fresh_square, epsilon = plan[1]
    episodes, hidden = states.shape[1], networks[0].shape[2]
    drawn = np.empty(2 * episodes + batch, np.float32)
    replayed, r = np.empty((3, batch), np.int64), np.empty(batch, np.float32)
    # States to be valued: before the transitions, then after them.
    asked = np.empty(2 * batch, np.int64)
    room = max(2 * batch, episodes)
    units = np.empty((room, hidden), np.float32), np.empty((room, hidden), np.float32)
    flows = np.empty((batch, hidden), np.float32), np.empty((batch, hidden), np.float32)
    q, q_after = np.empty((room, 4), np.float32), np.empty((batch, 4), np.float32)
    q_flow = np.empty((batch, 4), np.float32)
    gradient = (
        np.empty_like(networks[0][0]),
        np.empty_like(networks[1][0]),
        np.empty_like(networks[2][0]),
        np.empty_like(networks[3][0]),
        np.empty_like(networks[4][0]),
    )
    for task in range(first, end):
        network, target = _of(networks, task), _of(targets, task)
        mean, square = _of(moments, task), _of(squares, task)
        seed, total = _mix(np.uint64(seeds[task])), 0.0
        for t in range(len(plan[2])):
            explore, renewed, step_size, correction = plan[2][t]
            place = np.uint64(counter + t * len(drawn))
            for k in range(len(drawn)):
                drawn[k] = _uniform(seed, place + np.uint64(k))

            _values(network, inputs[task], states[task], units, q)
            for k in range(episodes):
                s, a = states[task, k], np.int64(drawn[k] * np.float32(4.0))
                if not drawn[episodes + k] < explore:
                    a = _argmax(q[k])
                s_next = next_state[task, s, a]
                entry = ring[task, (written + t * episodes + k) % ring.shape[1]]
                entry[0], entry[1], entry[2] = s, a, s_next
                over = (taken + t + 1) % horizon == 0
                states[task, k] = start[task] if over else s_next

            held = np.int64(min(written + (t + 1) * episodes, ring.shape[1]))
            for k in range(batch):
                at = min(np.int64(drawn[2 * episodes + k] * np.float32(held)), held - 1)
                s, s_next = np.int64(ring[task, at, 0]), np.int64(ring[task, at, 2])
                replayed[0, k], replayed[1, k], replayed[2, k] = s, ring[task, at, 1], s_next
                r[k] = rewards[task, s_next // 4]
                if potentials.shape[1]:
                    after = np.float32(discount) * potentials[task, s_next]
                    r[k] = r[k] + after - potentials[task, s]
            _normalise(r, renewed, running[0][task], running[1][task])

            _values(target, inputs[task], replayed[2], units, q_after)
            asked[:batch], asked[batch:] = replayed[0], replayed[2]
            _values(network, inputs[task], asked if double else asked[:batch], units, q)
            q_flow[:] = 0.0
            loss = _ZERO
            for k in range(batch):
                best = _argmax(q[batch + k]) if double else _argmax(q_after[k])
                a = replayed[1, k]
                apart = q[k, a] - (r[k] + np.float32(discount) * q_after[k, best])
                loss += _huber(apart)
                q_flow[k, a] = min(max(apart, -_ONE), _ONE) / np.float32(batch)
            total += np.float64(loss / np.float32(batch))

            _backward(network, inputs[task], replayed[0], units, q_flow, flows, gradient)
            rates = fresh, kept_square, fresh_square, epsilon, step_size, correction
            _descend(network[0], mean[0], square[0], gradient[0], rates)
            _descend(network[1], mean[1], square[1], gradient[1], rates)
            _descend(network[2], mean[2], square[2], gradient[2], rates)
            _descend(network[3], mean[3], square[3], gradient[3], rates)
            _descend(network[4], mean[4], square[4], gradient[4], rates)
            if (learned + t + 1) % interval == 0:
                target[0][:], target[1][:], target[2][:] = network[0], network[1], network[2]
                target[3][:], target[4][:] = network[3], network[4]
        losses[task] = total


@_compiled
def _of(arrays, task):
    """The arrays of one agent."""
    return arrays[0][task], arrays[1][task], arrays[2][task], arrays[3][task], arrays[4][task]


@_compiled
def _mix(bits):
    """As `draws`: SplitMix64's finaliser."""
    bits = (bits ^ (bits >> np.uint64(30))) * _FIRST
    bits = (bits ^ (bits >> np.uint64(27))) * _SECOND
    return bits ^ (bits >> np.uint64(31))


@_compiled
def _uniform(seed, place):
    """The number of a mixed seed at a place of its stream, in [0, 1)."""
    return np.float32(_mix(seed + _mix(place * _STEP)) >> np.uint64(40)) * _UNIT


@_compiled
def _argmax(values):
    """The first of the largest of four."""
    best = 0
    for a in range(1, 4):
        if values[a] > values[best]:
            best = a
    return best


@_compiled
def _huber(apart):
    size = abs(apart)
    return _HALF * size * size if size < _ONE else size - _HALF


@_compiled
def _values(network, inputs, states, units, q):
    """Q(s, .) of some states into `q`, and what the hidden layers put out into `units`."""
    count, hidden = len(states), network[0].shape[1]
    low, high = units[0][:count], units[1][:count]
    for n in range(count):
        active = inputs[states[n]]
        heading, moved, tile = active[0], active[1], active[2]
        for j in range(hidden):
            total = (network[0][heading, j] + network[0][moved, j]) + network[0][tile, j]
            low[n, j] = _ZERO if total < _ZERO else total
    np.dot(low, network[1], high)
    for n in range(count):
        for j in range(hidden):
            total = high[n, j] + network[3][0, j]
            high[n, j] = _ZERO if total < _ZERO else total
    np.dot(high, network[2], q[:count])
    for n in range(count):
        for a in range(4):
            q[n, a] += network[4][0, a]


@_rounded
def _normalise(r, weight, mean, square):
    """Normalise R by its running mean and spread, which are updated; as `DqnAgents`."""
    total, squares = _ZERO, _ZERO
    for k in range(len(r)):
        total += r[k]
        squares += r[k] * r[k]
    mean[0] = _lerp(mean[0], total / np.float32(len(r)), weight)
    square[0] = _lerp(square[0], squares / np.float32(len(r)), weight)
    spread = np.sqrt(max(square[0] - mean[0] * mean[0], _ZERO))
    # Where all rewards are equal, their spread is rounding error and must not be amplified.
    spread = max(spread, np.float32(1e-3) * np.sqrt(square[0]) + np.float32(1e-8))
    for k in range(len(r)):
        r[k] = (r[k] - mean[0]) / spread


@_rounded
def _lerp(old, new, weight):
    """As torch's: exact at both ends."""
    if weight < _HALF:
        return old + weight * (new - old)
    return new - (new - old) * (_ONE - weight)


@_compiled
def _backward(network, inputs, states, units, q_flow, flows, gradient):
    """The gradient of the network's weights, given that of `q` and the units of `_values`."""
    count, hidden = q_flow.shape[0], network[0].shape[1]
    low, high = units[0][:count], units[1][:count]
    low_flow, high_flow = flows
    np.dot(high.T, q_flow, gradient[2])
    np.dot(q_flow, network[2].T, high_flow)
    gradient[3][:], gradient[4][:] = 0.0, 0.0
    for n in range(count):
        for a in range(4):
            gradient[4][0, a] += q_flow[n, a]
        for j in range(hidden):
            flow = high_flow[n, j] if high[n, j] > _ZERO else _ZERO
            high_flow[n, j] = flow
            gradient[3][0, j] += flow
    np.dot(low.T, high_flow, gradient[1])
    np.dot(high_flow, network[1].T, low_flow)
    gradient[0][:] = 0.0
    for n in range(count):
        active = inputs[states[n]]
        heading, moved, tile = active[0], active[1], active[2]
        for j in range(hidden):
            flow = low_flow[n, j] if low[n, j] > _ZERO else _ZERO
            gradient[0][heading, j] += flow
            gradient[0][moved, j] += flow
            gradient[0][tile, j] += flow


@_compiled
def _descend(weights, mean, square, gradient, rates):
    """A step of Adam, as torch's fused one."""
    fresh, kept_square, fresh_square, epsilon, step_size, correction = rates
    rows, columns = weights.shape
    for row in range(rows):
        for column in range(columns):
            g = gradient[row, column]
            m = mean[row, column] + fresh * (g - mean[row, column])
            v = kept_square * square[row, column] + fresh_square * (g * g)
            mean[row, column], square[row, column] = m, v
            weights[row, column] -= step_size * m / (np.sqrt(v) / correction + epsilon)
