"""A program for tests to run and to kill: asynchronous environments equal those of one process.

    python vector_program.py <start method|by-hand> <cold|warm> <true|learned> <nothing|gl|torch>

The parent first opens OpenGL or lets torch compute on two threads; then the environments are made
by the start method, with no views in the cache (cold) or all (warm). Ends with 0 if all that they
return equals what a `SyncVectorEnv` returns afterwards. `by-hand` goes on with an environment of
the parent after `os.fork()`.
"""

from __future__ import annotations

import os
import sys

import gymnasium
import numpy as np
import torch
from environment_samples import CountingReward, sample_benchmark
from gymnasium.utils.env_checker import data_equivalence

from lcrl_bench.benchmarks.task_sets import house_task_sets
from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.storage import cache_dir

ENVIRONMENTS = 2


class ThreadedReward(CountingReward):
    """Scores as `CountingReward`, after work that torch shares among all threads it has."""

    def score(self, *arguments, **more) -> torch.Tensor:
        ones = torch.ones(500, 500)
        assert float((ones @ ones).exp().log().mean()) != 0
        return super().score(*arguments, **more)


def make(mode: str, reward: str, **more) -> gymnasium.vector.VectorEnv:
    return gymnasium.make_vec(
        HOUSE_ID,
        num_envs=ENVIRONMENTS,
        vectorization_mode=mode,
        vector_kwargs=more,
        benchmark=sample_benchmark(),
        split=None,
        reward=ThreadedReward() if reward == "learned" else "true",
    )


def use(what: str) -> None:
    """Do in this process what a fork can't go on with."""
    torch.set_num_threads(2)
    if what == "gl":
        house_task_sets(sample_benchmark(), "rooms-a", renderer="gl")
    if what == "torch":
        square = torch.rand(500, 500, requires_grad=True)
        (square @ square).exp().sum().backward()


def play(vector: gymnasium.vector.VectorEnv) -> list:
    """All that is returned in some steps."""
    returned: list = [vector.reset(seed=3)]
    returned += [vector.step(np.full(ENVIRONMENTS, step % 4)) for step in range(33)]
    vector.close()
    return returned


def forget_views() -> None:
    for path in (cache_dir() / "views").rglob("*.npz"):
        path.unlink()


def play_in_a_fork(reward: str) -> None:
    """Play an environment of this process in a fork of it; end with what the fork ends with."""
    inherited = make("sync", reward)
    inherited.reset(seed=3)
    child = os.fork()
    if child == 0:
        equal = data_equivalence(play(inherited), play(make("sync", reward)))
        os._exit(0 if equal else 1)
    sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))


def main(method: str, views: str, reward: str, parent: str) -> None:
    # Before, so that the parent does render; after, so that the environments have to.
    forget_views()
    use(parent)
    forget_views()
    if views == "warm":
        make("sync", reward).reset()
        for house in sample_benchmark().houses:
            house_task_sets(sample_benchmark(), house)
    if method == "by-hand":
        play_in_a_fork(reward)
    found = play(make("async", reward, context=method))
    expected = play(make("sync", reward))
    assert data_equivalence(found, expected), (found, expected)


if __name__ == "__main__":
    main(*sys.argv[1:])
