"""Time the planner of `imitation` on some tabular MDPs.

    python imitation_planner.py TASKS.npz RESULT.npz

`TASKS.npz` holds `discount`, `horizon` and per task k `next_state_k` int64 [state, action],
`reward_k` float64 [state] and `start_k`. `RESULT.npz` gets the CPU seconds of each task, and its
discounted visits float64 [state]. Building the dense transition matrix is not timed.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from imitation.algorithms import mce_irl  # pyright: ignore[reportMissingImports]
from numpy.typing import NDArray
from seals import base_envs  # pyright: ignore[reportMissingImports]


def environment(
    next_state: NDArray[np.int64], reward: NDArray[np.float64], start: int, horizon: int
) -> base_envs.TabularModelMDP:
    """The MDP as a model of `seals`, with dense transitions [state, action, state]."""
    states, actions = next_state.shape
    transitions = np.zeros((states, actions, states))
    transitions[np.arange(states)[:, None], np.arange(actions), next_state] = 1
    begin = np.zeros(states)
    begin[start] = 1
    return base_envs.TabularModelMDP(
        transition_matrix=transitions,
        reward_matrix=reward,
        horizon=horizon,
        initial_state_dist=begin,
    )


def main(given: str, wanted: str) -> None:
    """Plan every task and write what it took."""
    data = np.load(given)
    # Both count states, but ours are those of H actions: H + 1.
    steps, discount = int(data["horizon"]) + 1, float(data["discount"])
    seconds, visits = [], {}
    for k in range(sum(name.startswith("start_") for name in data.files)):
        task = environment(
            data[f"next_state_{k}"], data[f"reward_{k}"], int(data[f"start_{k}"]), steps
        )
        began = time.process_time()
        _, _, policy = mce_irl.mce_partition_fh(task, discount=discount)
        mass, _ = mce_irl.mce_occupancy_measures(task, pi=policy, discount=discount)
        seconds.append(time.process_time() - began)
        visits[f"visits_{k}"] = discount ** np.arange(steps) @ mass[:steps]
    np.savez(wanted, seconds=seconds, **visits)


if __name__ == "__main__":
    main(*sys.argv[1:])
