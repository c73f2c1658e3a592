"""Steps one environment in a process of its own: opening time, memory, steps per CPU second.

    python stepping.py '<job as JSON>'

Prints an outcome as JSON in its last line. It imports nothing of the suite unless a job says so:
it also runs where only another environment's package is installed.
"""

from __future__ import annotations

import importlib
import json
import re
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any, Final

import gymnasium
import numpy as np

SINGLE_STEPS: Final = 300
"""Steps of a single environment that are timed in one go; ten episodes of House-v1."""
VECTOR_STEPS: Final = 62
"""The same for a vector; two episodes, each with the step that resets."""


def measure(job: dict[str, Any]) -> dict[str, float]:
    """Do a job.

    Args:
        job: `modules` to import before the clock starts; the `id` of an environment; the number of
            `environments`, 0 for a single one; `arguments` to make it with; how many episodes to
            begin as a `warm_up`; and CPU `seconds` to step for.

    Returns:
        CPU `opening` seconds of making and the first reset; by how many megabytes the memory's peak
        grew until then (`opened`) and until the end (`used`); and `steps` per CPU second, summed
        over sub-environments: the most in one go, and the `median`.
    """
    for module in job["modules"]:
        importlib.import_module(module)
    before, began = peak_kb() / 1e3, time.process_time()
    count = job["environments"]
    environment: Any = (
        gymnasium.make_vec(job["id"], num_envs=count, **job["arguments"])
        if count
        else gymnasium.make(job["id"], **job["arguments"])
    )
    environment.reset(seed=0)
    opening, opened = time.process_time() - began, peak_kb() / 1e3
    for _ in range(job["warm_up"] // max(count, 1)):
        environment.reset()
    step = _vector_steps(environment) if count else _single_steps(environment)
    seconds: list[float] = []
    while not seconds or sum(seconds) < job["seconds"]:
        seconds.append(step())
    total = VECTOR_STEPS * count if count else SINGLE_STEPS
    return {
        "opening": opening,
        "opened": opened - before,
        "used": peak_kb() / 1e3 - before,
        "steps": total / min(seconds),
        "median": total / median(seconds),
    }


def _single_steps(environment: gymnasium.Env[Any, Any]) -> Callable[[], float]:
    """A function that steps at random, resets where an episode is over, and returns CPU seconds."""
    rng, choices = np.random.default_rng(0), environment.action_space.n  # pyright: ignore

    def step() -> float:
        actions = rng.integers(choices, size=SINGLE_STEPS).tolist()
        began = time.process_time()
        for action in actions:
            _, _, terminated, truncated, _ = environment.step(action)
            if terminated or truncated:
                environment.reset()
        return time.process_time() - began

    return step


def _vector_steps(vector: gymnasium.vector.VectorEnv[Any, Any, Any]) -> Callable[[], float]:
    """The same for a vector, which resets by itself."""
    rng, choices = np.random.default_rng(0), vector.single_action_space.n  # pyright: ignore

    def step() -> float:
        actions = rng.integers(choices, size=(VECTOR_STEPS, vector.num_envs))
        began = time.process_time()
        for row in actions:
            vector.step(row)
        return time.process_time() - began

    return step


def peak_kb() -> float:
    """The peak of this process's memory so far, in kB as the system counts them."""
    try:
        status = Path("/proc/self/status").read_text("ascii")
    except FileNotFoundError:  # Not Linux. macOS counts in bytes.
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak / 1e3 if sys.platform == "darwin" else peak
    # Not ru_maxrss, which counts what the parent had in memory when it started this process.
    (peak,) = re.findall(r"VmHWM:\s+(\d+) kB", status)
    return float(peak)


if __name__ == "__main__":
    print(json.dumps(measure(json.loads(sys.argv[1]))))
