"""Episodes in the two-room sample house, by the suite's own scenes, cameras and solvers."""

from __future__ import annotations

import pytest
import torch
from episode_samples import ForwardPolicy, SeenReward, make_episode, sample_benchmark

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.recording.episode import Episode


@pytest.fixture(scope="session")
def benchmark_sample() -> Benchmark:
    """A NAV and a PICK task in the two-room house."""
    return sample_benchmark()


@pytest.fixture(scope="session")
def sets(benchmark_sample: Benchmark) -> tuple[TaskSet, ...]:
    """The tasks of the two-room house."""
    return load_task_sets(benchmark_sample, device=torch.device("cpu"), renderer="rays")


@pytest.fixture(scope="session")
def nav_episode(sets: tuple[TaskSet, ...], benchmark_sample: Benchmark) -> Episode:
    """Going to the bed."""
    return make_episode(SeenReward(), sets, benchmark_sample, Kind.NAV)


@pytest.fixture(scope="session")
def pick_episode(sets: tuple[TaskSet, ...], benchmark_sample: Benchmark) -> Episode:
    """Moving the cup to the bed."""
    return make_episode(SeenReward(), sets, benchmark_sample, Kind.PICK)


@pytest.fixture(scope="session")
def policy_episode(sets: tuple[TaskSet, ...], benchmark_sample: Benchmark) -> Episode:
    """A policy that has no reward."""
    return make_episode(ForwardPolicy(), sets, benchmark_sample, Kind.PICK)
