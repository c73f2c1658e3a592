"""Episodes in the two-room sample house, by the suite's own scenes, cameras and solvers."""

from __future__ import annotations

import pytest
import torch
from episode_samples import ForwardPolicy, SeenReward, make_episode, sample_benchmark
from lcrl_bench.evaluation.problems import Problem, compile_problems

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.recording.episode import Episode


@pytest.fixture(scope="session")
def benchmark_sample() -> Benchmark:
    """A NAV and a PICK task in the two-room house."""
    return sample_benchmark()


@pytest.fixture(scope="session")
def problem(benchmark_sample: Benchmark) -> Problem:
    """The two-room house, compiled."""
    (only,) = compile_problems(benchmark_sample, device=torch.device("cpu"), renderer="rays")
    return only


@pytest.fixture(scope="session")
def nav_episode(problem: Problem, benchmark_sample: Benchmark) -> Episode:
    """Going to the bed."""
    return make_episode(SeenReward(), problem, benchmark_sample, Kind.NAV)


@pytest.fixture(scope="session")
def pick_episode(problem: Problem, benchmark_sample: Benchmark) -> Episode:
    """Moving the cup to the bed."""
    return make_episode(SeenReward(), problem, benchmark_sample, Kind.PICK)


@pytest.fixture(scope="session")
def policy_episode(problem: Problem, benchmark_sample: Benchmark) -> Episode:
    """A policy that has no reward."""
    return make_episode(ForwardPolicy(), problem, benchmark_sample, Kind.PICK)
