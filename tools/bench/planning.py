"""Planning: discounted visits of the soft-optimal policy, beside `imitation`.

`imitation` plans for one task at a time with dense transition matrices; the suite plans for all
tasks of a house and kind at once, by look-ups.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.cli.bench import Figure
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.mdp.dynamics import fold_cells, spread_cells
from lcrl_bench.mdp.maximum_entropy import soft_marginals
from tools.speed.peers import IMITATION
from tools.speed.timing import torch_threads

GOAL: Final = 1000
"""How many times less CPU time than `imitation`."""

_REPEATS: Final = 3
_SCRIPT: Final = Path(__file__).with_name("peers") / "imitation_planner.py"
_THREADS: Final = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")


def measure_planning(sets: Sequence[TaskSet], *, sample: int = 2) -> Figure:
    """Plan for all tasks, and for a sample of them with `imitation`.

    Args:
        sets: Task sets of some houses.
        sample: Tasks per set that `imitation` plans for; its time for the set is as many times
            longer as the set has more tasks.

    Raises:
        EnvironmentMissingError: If the environment with `imitation` is missing or fails.
    """
    generator = torch.Generator().manual_seed(0)
    rewards = [torch.randn(tasks.goal.shape, generator=generator) for tasks in sets]
    chosen = [(k, row) for k, tasks in enumerate(sets) for row in range(min(sample, len(tasks)))]
    with torch_threads(1):
        found = [_plan(tasks, r) for tasks, r in zip(sets, rewards, strict=True)]
    seconds, visits = _imitate([(sets[k].rows([row]), rewards[k][row]) for k, row in chosen])
    theirs = 0.0
    for k, tasks in enumerate(sets):
        own = [s for (number, _), s in zip(chosen, seconds, strict=True) if number == k]
        theirs += len(tasks) * sum(own) / len(own)
    apart = max(
        _difference(found[k][1][row], expected)
        for (k, row), expected in zip(chosen, visits, strict=True)
    )
    ours, count = sum(s for s, _ in found), sum(map(len, sets))
    return Figure(
        "planning",
        f"soft Q-iteration and visits of {count:,} tasks",
        "imitation 1.0.1",
        theirs / ours,
        "x",
        GOAL,
        difference=apart,
        detail={"ours_s": ours, "theirs_s": theirs, "tasks": count, "sampled": len(chosen)},
    )


def _plan(tasks: TaskSet, reward: torch.Tensor) -> tuple[float, torch.Tensor]:
    """CPU seconds, the fastest of some tries after one that compiles; and visits [task, cell]."""
    occupancy = soft_marginals(tasks, reward, temperature=1.0).occupancy
    seconds = []
    for _ in range(_REPEATS):
        began = time.process_time()
        soft_marginals(tasks, reward, temperature=1.0)
        seconds.append(time.process_time() - began)
    return min(seconds), occupancy


def _imitate(
    problems: Sequence[tuple[TaskSet, torch.Tensor]],
) -> tuple[list[float], list[NDArray[np.float64]]]:
    """CPU seconds of `imitation` and its visits [state], for each task and reward [cell]."""
    first = problems[0][0]
    arrays = {"horizon": np.array(first.horizon), "discount": np.array(first.discount)}
    for k, (task, reward) in enumerate(problems):
        arrays[f"next_state_{k}"] = task.next_state[0].numpy()
        arrays[f"reward_{k}"] = spread_cells(reward.double()).numpy()
        arrays[f"start_{k}"] = task.start[0].numpy()
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "tasks.npz", Path(folder) / "answer.npz"
        np.savez(given, allow_pickle=False, **arrays)
        _run([str(IMITATION.require()), "-W", "ignore", str(_SCRIPT), str(given), str(answer)])
        with np.load(answer) as read:
            return read["seconds"].tolist(), [read[f"visits_{k}"] for k in range(len(problems))]


def _run(words: Sequence[str]) -> None:
    done = subprocess.run(words, env=os.environ | _THREADS, capture_output=True, text=True)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["it says nothing"])[-1]
        raise EnvironmentMissingError(
            f"imitation can't be measured: {last}. Delete {IMITATION.folder} to install it anew."
        )


def _difference(found: torch.Tensor, expected: NDArray[np.float64]) -> float:
    """Relative, of visits [cell] and visits [state]."""
    cells = fold_cells(torch.from_numpy(expected))
    return float((found - cells).norm() / cells.norm())
