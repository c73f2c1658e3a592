"""One stage of the work on a benchmark, in a process of its own: its CPU time and peak memory.

    python -m tools.speed.growing build|open|train|evaluate FOLDER HOUSES
    python -m tools.speed.growing pass FOLDER KEPT

`FOLDER` holds `benchmark`, and what earlier stages left; for `pass` it is a benchmark's. Prints a
JSON object in its last line. Imports, and the compilation of kernels, are not in the CPU time.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.house_sets import HOUSES_KEPT
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.evaluation.harness import evaluate_each, own_command
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.mdp.policy_outcome import follow_greedy
from lcrl_bench.methods.contract import Reward
from lcrl_bench.methods.practice import practice_train_set
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.train_set import TrainSet, train_set
from tools.speed.stepping import peak_kb

METHOD: Final = "lcrl"
"""The method that is trained."""
_CPU: Final = torch.device("cpu")


def build(folder: Path, houses: int) -> None:
    """Generate, prove, render and freeze, as `lcrl-bench benchmark build` does, in one process."""
    from lcrl_bench.cli.main import main

    words = ("benchmark", "build", "--procedural", str(houses), "--workers", "1", "--json")
    if code := main([*words, "--out", str(folder / "benchmark"), "--name", "grown"]):
        sys.exit(code)


def open_benchmark(folder: Path, houses: int) -> None:
    """Open the benchmark, as every command does."""
    read_benchmark(folder / "benchmark")


def train(folder: Path, houses: int) -> None:
    """Prepare all houses and go over them once, one step of Adam per training house."""
    benchmark = read_benchmark(folder / "benchmark")
    sets = load_task_sets(benchmark)
    fit_once(train_set(benchmark, sets, oracle=False)).save(folder / "learned")


def evaluate(folder: Path, houses: int) -> None:
    """Evaluate what `train` learned on every split, and under every language control."""
    learned: Any = resolve_method(METHOD).learns.load(folder / "learned")
    evaluate_all(learned, load_task_sets(read_benchmark(folder / "benchmark")))


def one_pass(folder: Path, kept: int) -> None:
    """Train over a benchmark's houses once and evaluate, with so many of them in memory."""
    benchmark = read_benchmark(folder)
    sets = load_task_sets(benchmark, houses_kept=kept)
    evaluate_all(fit_once(train_set(benchmark, sets, oracle=False)), sets)


def fit_once(data: TrainSet) -> Any:  # noqa: ANN401 - the method's reward
    """What one pass learns."""
    method: Any = resolve_method(METHOD)
    return method(method.Config(passes=1, least_steps=1)).fit(
        data, generator=torch.Generator().manual_seed(0), device=_CPU, log=lambda _: None
    )


def evaluate_all(learned: Reward, sets: Sequence[TaskSet]) -> None:
    """Evaluate under the tasks' own commands and every language control."""
    evaluate_each(learned, sets, {"command": own_command, **language_controls(sets)})


STAGES: Final[Mapping[str, Callable[[Path, int], None]]] = {
    "build": build,
    "open": open_benchmark,
    "train": train,
    "evaluate": evaluate,
    "pass": one_pass,
}
"""In the order in which they depend on each other; the last one stands alone."""


def _warm_up() -> None:
    """Compile what training and evaluation run, or load it."""
    practice = practice_train_set(0, oracle=True)
    fit_once(practice)
    for tasks in practice.tasks:
        follow_greedy(tasks, tasks.goal.float(), waypoint=tasks.held)


def measure(stage: str, folder: Path, number: int) -> dict[str, float]:
    """Do a stage; returns CPU seconds, and the peak of the process's memory in MB."""
    torch.set_num_threads(1)
    if stage not in ("build", "open"):
        _warm_up()
    began = time.process_time()
    STAGES[stage](folder, number)
    seconds = time.process_time() - began
    return {"cpu_s": round(seconds, 3), "peak_mb": round(peak_kb() / 1024, 1)}


if __name__ == "__main__":
    name, where, *rest = sys.argv[1:]
    print(json.dumps(measure(name, Path(where), int(rest[0]) if rest else HOUSES_KEPT)))
