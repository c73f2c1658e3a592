"""Expert demonstrations: sampled from the optimal policy under the true reward.

The random numbers depend only on the benchmark and the task, so every method and every seed learns
from the same demonstrations. Source: paper, section "Experimental Procedure": "we use 10
demonstrations per task, sampled from the computed optimal policy".
"""

from __future__ import annotations

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.expert import expert_policy
from lcrl_bench.mdp.rollouts import sample_trajectories
from lcrl_bench.storage import sha256_of


def demonstrate(benchmark: Benchmark, tasks: TaskSet) -> torch.Tensor:
    """Sample the demonstrations of a set of tasks.

    Returns:
        int64 [task, demonstration, horizon + 1]: states visited.
    """
    policy = expert_policy(tasks, benchmark.semantics.success_reward)
    name = f"{benchmark.fingerprint}:{tasks.tasks[0].house}:{tasks.kind}"
    generator = torch.Generator().manual_seed(int(sha256_of(name.encode())[:15], 16))
    return sample_trajectories(
        tasks, policy, episodes=benchmark.semantics.demonstrations, generator=generator
    ).states
