"""`TrainSet`: everything a method may learn from, made from a benchmark's task sets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.house_sets import House, by_house, change_houses
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.mdp.expert import expert_policy, shortest_way_policy
from lcrl_bench.mdp.rollouts import sample_trajectories
from lcrl_bench.panoramas import ObservedHouse
from lcrl_bench.storage import sha256_of


@dataclass(frozen=True, eq=False)
class TrainSet:
    """The commands, demonstrations, dynamics and views of the training tasks."""

    tasks: Sequence[TaskSet]
    """One set per house and kind, without tasks, scenes and, unless the method is an oracle,
    goals. With very many houses, the latest used are in memory, the others memory-mapped."""
    vocabulary: tuple[str, ...]
    """The words of the training commands, in a fixed order."""

    @cached_property
    def houses(self) -> Sequence[House]:
        """The sets grouped by house: those of a group share their `views`."""
        return by_house(self.tasks)


def select_split(tasks: TaskSet, split: Split) -> TaskSet | None:
    """The tasks of one split; None if there are none."""
    rows = [row for row, task in enumerate(tasks.tasks) if task.split == split]
    return tasks.rows(rows) if rows else None


def train_set(
    benchmark: Benchmark, sets: Sequence[TaskSet], *, oracle: bool, expert: bool = False
) -> TrainSet:
    """What a method may learn from: training tasks, their dynamics and demonstrations.

    Args:
        benchmark: The benchmark.
        sets: Its task sets.
        oracle: Whether the method is given true rewards; otherwise no goal is marked.
        expert: Whether it is given the optimal action probabilities of every state.
    """
    shown = change_houses(
        sets,
        partial(_shown, benchmark, oracle=oracle, expert=expert),
        keep=lambda task: task.split == Split.TRAIN,
        name=None,
    )
    return TrainSet(shown, benchmark.vocabulary)


def _shown(benchmark: Benchmark, house: House, *, oracle: bool, expert: bool) -> House:
    """What is shown of a house with training tasks."""
    chosen = [select_split(tasks, Split.TRAIN) for tasks in house]
    kept = [tasks for tasks in chosen if tasks is not None]
    # Arrangements that only test tasks produce are left out: they would reveal their goals.
    used = torch.cat([tasks.panoramas.flatten() for tasks in kept]).unique()
    seen = ObservedHouse.of(house[0].views, used)
    views = replace(seen.views, house=house[0].views.house)
    return tuple(
        replace(
            tasks,
            views=views,
            goal=tasks.goal if oracle else torch.zeros_like(tasks.goal),
            panoramas=seen.place[tasks.panoramas],
            demonstrations=demonstrate(benchmark, tasks),
            expert=shortest_way_policy(tasks) if expert else None,
            tasks=(),
            origin=None,
        )
        for tasks in kept
    )


def demonstrate(benchmark: Benchmark, tasks: TaskSet) -> torch.Tensor:
    """Sample the demonstrations of a set of tasks from the optimal policy under the true reward.

    The draw depends on the benchmark and the task alone, so every method and every seed learns
    from the same demonstrations. Source: paper, section "Experimental Procedure": "we use 10
    demonstrations per task, sampled from the computed optimal policy".

    Returns:
        int64 [task, demonstration, horizon + 1]: states visited.
    """
    policy = expert_policy(tasks, benchmark.semantics.success_reward)
    name = f"{benchmark.fingerprint}:{tasks.tasks[0].house}:{tasks.kind}"
    generator = torch.Generator().manual_seed(int(sha256_of(name.encode())[:15], 16))
    return sample_trajectories(
        tasks, policy, episodes=benchmark.semantics.demonstrations, generator=generator
    ).states
