"""A small benchmark of generated houses, built once a test process."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import torch
from lcrl_bench.evaluation.problems import Problem, compile_problems

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.build import BuildConfig, build_benchmark
from lcrl_bench.benchmarks.projections import Projection, project_reward
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.methods.contract import HouseViews
from lcrl_bench.methods.tensors import TensorReward

CONFIG = BuildConfig(name="tiny", nav=6, pick=4, test_houses=0.34, test_tasks=0.25)
SEEDS = (11, 12, 13)


@lru_cache(maxsize=1)
def tiny_benchmark() -> Benchmark:
    """Three generated houses of four rooms: two to train in, one held out; drawn by rays."""
    houses = [generate_house(seed, rooms=4) for seed in SEEDS]
    return build_benchmark(houses, CONFIG, renderer="rays")


@lru_cache(maxsize=1)
def tiny_problems() -> tuple[Problem, ...]:
    """The houses of `tiny_benchmark`, compiled."""
    return compile_problems(tiny_benchmark(), device=torch.device("cpu"), renderer="rays")


class TrueRewardBySight(TensorReward):
    """The true reward of every task as a function of what is seen, and 0 for any other sentence."""

    def __init__(
        self,
        benchmark: Benchmark,
        problems: Sequence[Problem],
        projection: Projection = Projection.CELLS,
    ) -> None:
        self.asked: list[tuple[str, str]] = []
        self._worth: dict[tuple[str, str], torch.Tensor] = {}
        for problem in problems:
            house = problem.observed
            for tasks in problem.compiled.sets:
                rewards = project_reward(problem.compiled, tasks, benchmark.semantics, projection)
                for task, panoramas, reward in zip(
                    tasks.tasks, tasks.panoramas, rewards, strict=True
                ):
                    worth = torch.zeros(len(house.views.panorama_views), dtype=reward.dtype)
                    worth[house.place[panoramas]] = reward
                    self._worth[house.views.house, task.command] = worth

    def score(self, views: HouseViews, commands: Sequence[str]) -> torch.Tensor:
        self.asked += [(views.house, command) for command in commands]
        nothing = torch.zeros(len(views.panorama_views), dtype=torch.float64)
        return torch.stack([self._worth.get((views.house, c), nothing) for c in commands])
