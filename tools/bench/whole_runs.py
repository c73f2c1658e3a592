"""Whole runs: what `run` does beside training, and the training that the first table takes."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.cli.bench import Figure
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.evaluation.harness import evaluate_each, own_command
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.reproduction.experiments import EXPERIMENTS, specs_of
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.settings import make_method
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.train_set import train_set
from tools.speed.timing import torch_threads

RUNNING_GOAL: Final = 12
"""CPU seconds."""
TABLE_GOAL: Final = 15
"""Minutes on two cores."""

_CORES: Final = 2
LONGEST_S: Final = 10.0
"""CPU seconds of a training that are measured, once it takes steps."""
_SHORTEST: Final = {"passes": 1, "least_steps": 1}


class EnoughError(Exception):
    """Ends a training that has been measured."""


def measure_running(benchmark: str) -> Figure:
    """Run the command with one pass of training and no recording, views and indices at hand.

    Raises:
        EnvironmentMissingError: If the command fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        # The first run leaves views and indices in the cache.
        _, seconds = [_run_once(benchmark, Path(folder) / name) for name in ("first", "second")]
    work = f"what run does on {benchmark} beside training, one pass included"
    return Figure("running", work, "", seconds, "s", RUNNING_GOAL, at_least=False)


def _run_once(benchmark: str, out: Path) -> float:
    """CPU seconds of a command in a process of its own."""
    settings = [f"{key}={value}" for key, value in _SHORTEST.items()]
    words = ["--method", "lcrl", "--benchmark", benchmark, "--out", str(out), "--no-record"]
    command = [sys.executable, "-m", "lcrl_bench.run", *words, "--set", *settings]
    before = os.times()
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise EnvironmentMissingError(f"{' '.join(command)} failed: {ended.stderr.strip()}")
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def measure_table(benchmark: Benchmark, *, longest_s: float = LONGEST_S) -> Figure:
    """Train each method of the first table for some seconds, and evaluate once.

    The whole follows from the number of steps and of runs. A process loads the benchmark once for
    all its runs, which is left out.

    Args:
        benchmark: The benchmark.
        longest_s: CPU seconds of each training that are measured, once it takes steps.
    """
    specs = specs_of([each for each in EXPERIMENTS if each.name == "table-1"], None, None)
    trainings = Counter(spec.method for spec in specs if not spec.control)
    sets = load_task_sets(benchmark)
    detail: dict[str, Any] = {}
    with torch_threads(1):
        for method, seeds in trainings.items():
            preparing, training = _training_time(RunSpec(method), benchmark, sets, longest_s)
            detail[method] = {"preparing_s": preparing, "training_s": training, "seeds": seeds}
        evaluating = _evaluation_s(benchmark, sets)
    total = sum(
        each["seeds"] * (each["preparing_s"] + each["training_s"] + evaluating)
        for each in detail.values()
    )
    detail["evaluating_s"] = evaluating
    return Figure(
        "table-1",
        f"Table 1 on {benchmark.name}, all seeds, from some steps of each method",
        "",
        total / 60 / _CORES,
        "min",
        TABLE_GOAL,
        at_least=False,
        detail=detail,
    )


def _training_time(
    spec: RunSpec, benchmark: Benchmark, sets: Sequence[TaskSet], longest_s: float
) -> tuple[float, float]:
    """CPU seconds until the first step, and of all steps by the median of those measured."""
    method, moments, steps = spec.make_method(), Moments(longest_s), 0
    began = time.process_time()
    try:
        method.fit(
            train_set(benchmark, sets, oracle=method.oracle, expert=method.expert),
            generator=torch.Generator().manual_seed(spec.seed),
            device=torch.device("cpu"),
            log=moments.take,
        )
    except EnoughError:
        steps = moments.steps
    if not steps:
        return 0.0, time.process_time() - began
    return moments.first - began, steps * moments.step_s()


def _evaluation_s(benchmark: Benchmark, sets: Sequence[TaskSet]) -> float:
    """CPU seconds to evaluate a run, under every language control."""
    method = make_method(resolve_method("lcrl"), {key: str(k) for key, k in _SHORTEST.items()})
    learned = method.fit(
        train_set(benchmark, sets, oracle=method.oracle, expert=method.expert),
        generator=torch.Generator().manual_seed(0),
        device=torch.device("cpu"),
        log=lambda _: None,
    )
    began = time.process_time()
    evaluate_each(learned, sets, {"command": own_command, **language_controls(sets)})
    return time.process_time() - began


class Moments:
    """When a training took its steps, in CPU seconds."""

    def __init__(self, longest_s: float, clock: Callable[[], float] = time.process_time) -> None:
        """Take no step yet.

        Args:
            longest_s: After how long enough is measured.
            clock: Returns CPU seconds.
        """
        self.steps = 0
        self._longest_s = longest_s
        self._clock = clock
        self._taken: list[tuple[int, float]] = []

    @property
    def first(self) -> float:
        """When the first row of the log was written."""
        return self._taken[0][1]

    def step_s(self) -> float:
        """CPU seconds of a step, by the median of the rows after the first."""
        pairs = zip(self._taken, self._taken[1:], strict=False)
        return median((t2 - t1) / (s2 - s1) for (s1, t1), (s2, t2) in pairs if s2 > s1)

    def take(self, row: dict[str, Any]) -> None:
        """Take a row of the log; raises `EnoughError` once enough was measured."""
        self.steps = int(row["steps"])
        self._taken.append((int(row["step"]), self._clock()))
        if len(self._taken) > 3 and self._clock() - self.first > self._longest_s:
            raise EnoughError
