"""How time and memory grow with the number of houses: build, open, train, evaluate.

Every stage of every size is measured in a process of its own, on one thread, and kept in a file, so
that a measurement that was interrupted goes on where it was.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from lcrl_bench.errors import LcrlError, UsageError
from lcrl_bench.storage import read_json, write_json

STAGES: Final = ("build", "open", "train", "evaluate")
GOAL: Final = 1.05
"""Largest slope that counts as linear growth."""
MEMORY_GOAL_MB: Final = 2000.0
"""Highest peak of memory of training and evaluation."""
_THREADS: Final = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
_CHECKOUT: Final = Path(__file__).parents[2]


@dataclass(frozen=True)
class Grown:
    """A stage at a size."""

    stage: str
    houses: int
    cpu_s: float
    peak_mb: float


def measure_growth(
    sizes: Sequence[int], folder: Path, *, progress: Callable[[str], None] = lambda _: None
) -> tuple[Grown, ...]:
    """Measure every stage at every size, the smallest first.

    Args:
        sizes: Numbers of houses.
        folder: Where benchmarks are built, with a cache of their own each, and results are kept.
        progress: Called with each stage and size when it is measured.

    Raises:
        UsageError: If there is no size, or one below 2: a benchmark has a house to test in.
        LcrlError: If a stage fails.
    """
    if not sizes or min(sizes) < 2:
        raise UsageError("--growth needs sizes of 2 houses or more. Example: --growth 8 76")
    found = []
    for houses in sorted(set(sizes)):
        for stage in STAGES:
            place = folder.resolve() / str(houses)
            kept = place / f"{stage}.json"
            if not kept.exists():
                write_json(kept, run_stage(stage, place, houses, home=place / "home"))
            row = read_json(kept)
            found.append(Grown(stage, houses, row["cpu_s"], row["peak_mb"]))
            progress(f"{stage}, {houses} houses")
    return tuple(found)


def run_stage(stage: str, folder: Path, number: int, *, home: Path | None = None) -> dict:
    """`growing.measure` in a process of its own.

    Args:
        stage: Its name.
        folder: Its folder.
        number: Its number.
        home: The cache folder; None for that of this process.

    Raises:
        LcrlError: If it fails.
    """
    own = {} if home is None else {"LCRL_BENCH_HOME": str(home)}
    words = [sys.executable, "-m", "tools.speed.growing", stage, str(folder), str(number)]
    done = subprocess.run(
        words, cwd=_CHECKOUT, env=os.environ | _THREADS | own, capture_output=True, text=True
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["it says nothing"])[-1]
        raise LcrlError(f"{stage} of {folder} can't be measured: {last}")
    return json.loads(done.stdout.strip().splitlines()[-1])


def slope(points: Sequence[Grown]) -> float:
    """The slope of log CPU time over log houses by least squares: 1 if time grows linearly.

    Args:
        points: One stage at two sizes or more.
    """
    x = [math.log(each.houses) for each in points]
    y = [math.log(max(each.cpu_s, 1e-3)) for each in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - mean_x) ** 2 for a in x)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / spread


def slopes(found: Sequence[Grown]) -> dict[str, float]:
    """The slope of each stage; nothing of a single size."""
    if len({each.houses for each in found}) < 2:
        return {}
    return {stage: slope([each for each in found if each.stage == stage]) for stage in STAGES}
