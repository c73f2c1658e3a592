"""A small benchmark of generated houses, built once a test process."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.build import BuildConfig, build_benchmark
from lcrl_bench.benchmarks.projections import Projection, project_reward
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.evaluation.session import Session, Workplace
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.tensors import TensorReward

CONFIG = BuildConfig(name="tiny", nav=6, pick=4, test_houses=0.34, test_tasks=0.25)
SEEDS = (11, 12, 13)


@lru_cache(maxsize=1)
def tiny_benchmark() -> Benchmark:
    """Three generated houses of four rooms: two to train in, one held out; drawn by rays."""
    houses = [generate_house(seed, rooms=4) for seed in SEEDS]
    return build_benchmark(houses, CONFIG, renderer="rays")


@lru_cache(maxsize=1)
def tiny_task_sets() -> tuple[TaskSet, ...]:
    """The task sets of `tiny_benchmark`."""
    return load_task_sets(tiny_benchmark(), device=torch.device("cpu"), renderer="rays")


def tiny_session(out: Path, **means: Any) -> Session:
    """A session of `tiny_benchmark` that writes to a folder."""
    return Session(tiny_benchmark(), Workplace(out, renderer="rays", **means))


class TrueRewardBySight(TensorReward):
    """The true reward of every task as a function of what is seen, and 0 for any other sentence."""

    def __init__(
        self,
        sets: Sequence[TaskSet],
        projection: Projection = Projection.CELLS,
    ) -> None:
        self.asked: list[tuple[str, str]] = []
        self._worth: dict[tuple[str, str], torch.Tensor] = {}
        for tasks in sets:
            house = tasks.views.observed
            rewards = project_reward(tasks, projection)
            for command, panoramas, reward in zip(
                tasks.commands, tasks.panoramas, rewards, strict=True
            ):
                worth = torch.zeros(len(house.views), dtype=reward.dtype)
                worth[house.place[panoramas]] = reward
                self._worth[house.views.house, command] = worth

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        self.asked += [(views.house, command) for command in commands]
        nothing = torch.zeros(len(views), dtype=torch.float64)
        return torch.stack([self._worth.get((views.house, c), nothing) for c in commands])
