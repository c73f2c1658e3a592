"""A small benchmark of generated houses, built once a test process."""

from __future__ import annotations

from functools import lru_cache

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.build import BuildConfig, build_benchmark
from lcrl_bench.evaluation.problems import Problem, compile_problems
from lcrl_bench.houses.procedural import generate_house

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
