"""The speed of the Gymnasium environments: opening, memory, and steps per CPU second.

Every measurement has a process of its own, on one thread.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from lcrl_bench.envs import HOUSE_ID
from lcrl_bench.errors import LcrlError
from tools.speed.peers import MINIGRID

TASKS: Final = ("MiniGrid-Empty-8x8-v0", "BabyAI-GoToLocal-v0")
"""MiniGrid's simplest environment, and one with a command like ours."""
COUNTS: Final = (0, 16, 256)
"""What is measured unless told otherwise: a single environment, and vectors of 16 and 256."""
WARM_UP: Final = 500
"""Episodes begun before the clock starts: most houses have been loaded then."""
_ENTRY_POINTS: Final = ("lcrl_bench.envs.environment", "lcrl_bench.envs.vector_environment")
_THREADS: Final = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")


@dataclass(frozen=True)
class Stepping:
    """How fast an environment is opened and stepped."""

    environment: str
    """Its id."""
    environments: int
    """Number of sub-environments; 0 for a single environment."""
    opening: float
    """CPU seconds to make and reset it, without imports."""
    opened: float
    """Megabytes by which the peak of the memory grew by then."""
    used: float
    """The same after all steps."""
    steps: float
    """Steps per CPU second, summed over sub-environments: the most in one go."""
    median: float
    """The same: the median."""


def measure_environments(
    benchmark: str,
    *,
    renderer: str = "auto",
    counts: Sequence[int] = COUNTS,
    minigrid: bool = False,
    seconds: float = 1.0,
    progress: Callable[[str], None] = lambda _: None,
) -> tuple[Stepping, ...]:
    """Measure House-v1 with panoramas.

    Args:
        benchmark: A name or a folder.
        renderer: Draws views that are not in the cache.
        counts: Numbers of sub-environments; 0 is a single environment.
        minigrid: Whether to measure MiniGrid too, which is installed first if necessary.
        seconds: CPU seconds to step for, each.
        progress: Called with the id of each environment when it is measured.

    Raises:
        EnvironmentMissingError: If MiniGrid can't be installed.
    """
    ours = {"benchmark": benchmark, "renderer": renderer}
    jobs = [(Path(sys.executable), HOUSE_ID, count, _ENTRY_POINTS, ours) for count in counts]
    if minigrid:
        theirs = MINIGRID.make()
        jobs += [(theirs, name, count, ("minigrid",), {}) for name in TASKS for count in counts]
    found = []
    for python, name, count, modules, arguments in jobs:
        job = {
            "modules": modules,
            "id": name,
            "environments": count,
            "arguments": arguments,
            "warm_up": WARM_UP if name == HOUSE_ID else 0,
            "seconds": seconds,
        }
        found.append(Stepping(name, count, **_measure(python, job)))
        progress(name)
    return tuple(found)


def times_faster(ours: Stepping, others: Sequence[Stepping]) -> dict[str, float]:
    """How many times as many steps are taken as in each other environment, as many at once."""
    return {
        other.environment: ours.steps / other.steps
        for other in others
        if other.environments == ours.environments and other.environment != ours.environment
    }


def _measure(python: Path, job: Mapping[str, Any]) -> dict[str, float]:
    script = Path(__file__).with_name("stepping.py")
    done = subprocess.run(
        # -P: modules are not looked for beside the script, where one is called like a package.
        [str(python), "-P", str(script), json.dumps(job)],
        env=os.environ | _THREADS,
        capture_output=True,
        text=True,
    )
    if done.returncode:
        raise LcrlError(f"{job['id']} can't be measured: {done.stderr.strip().splitlines()[-1]}")
    # BabyAI, for one, prints while it steps.
    return json.loads(done.stdout.strip().splitlines()[-1])
