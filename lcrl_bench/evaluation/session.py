"""Output folder and device of runs, and a benchmark loaded once per process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.control_store import controls_path, read_controls, write_controls
from lcrl_bench.evaluation.controls import CONTROLS
from lcrl_bench.evaluation.results import Results

ImageSize = tuple[int, int]
"""Width and height of a view, in pixels."""


@dataclass(frozen=True)
class Workplace:
    """Where runs are written, and how they are computed."""

    out: Path
    """Runs are written to `out/<benchmark>/<method>[-<variant>]/seed<k>`."""
    device: torch.device = field(default_factory=lambda: torch.device("cpu"))
    threads: int | None = 1
    """Torch threads used by runs; None for the current number."""
    renderer: str = "auto"
    """`"auto"`, `"gl"`, `"rays"` or `"warp"`, for views that are neither frozen nor cached."""
    fresh: bool = False
    """Set aside a different run found in the folder, instead of raising."""


def resolve_device(name: str) -> torch.device:
    """The device called `name`; `auto` means CUDA if available, else the CPU.

    Raises:
        UsageError: If this machine has no such device.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    try:
        device = torch.device(name)
    except RuntimeError as error:
        raise UsageError(f"--device {name}: {error}. Valid: auto, cpu, cuda.") from error
    if device.type == "cuda" and not torch.cuda.is_available():
        raise UsageError("--device cuda: torch finds no GPU here. Use --device cpu.")
    return device


class Session:
    """A benchmark in one process, with its task sets and controls computed once."""

    def __init__(
        self,
        benchmark: Benchmark,
        place: Workplace,
    ) -> None:
        """Take a benchmark, and the output folder, device and renderer; load no house yet."""
        self.benchmark = benchmark
        self.place = place
        self._size: ImageSize | None = None
        self._sets: Sequence[TaskSet] | None = None
        self._controls: dict[str, Results] | None = None

    def task_sets(
        self,
        image_size: ImageSize | None = None,
        *,
        progress: Callable[[str], None] = lambda _: None,
    ) -> Sequence[TaskSet]:
        """The task sets with views of a size; only one size is kept in memory.

        Args:
            image_size: Width and height in pixels; None for the benchmark's own.
            progress: Called with each house once its tasks are loaded.
        """
        if self._sets is None or self._size != image_size:
            self._sets = None
            self._sets = load_task_sets(
                self.benchmark,
                device=self.place.device,
                renderer=self.place.renderer,
                image_size=image_size,
                progress=progress,
            )
            self._size = image_size
        return self._sets

    def controls(self) -> dict[str, Results]:
        """Results of the controls: random and optimal policy, constant and lexical reward.

        They are read from the cache if they are there.
        """
        if self._controls is None:
            sets, place = self.task_sets(self._size), self.place
            threads = torch.get_num_threads() if place.threads is None else place.threads
            path = controls_path(
                self.benchmark.fingerprint, sets, device=place.device, threads=threads
            )
            found = None if path is None else read_controls(path, tuple(CONTROLS), sets)
            if found is None:
                found = {
                    name: Results.of(name, 0, outcomes_of(sets))
                    for name, outcomes_of in CONTROLS.items()
                }
                if path is not None:
                    write_controls(path, found)
            self._controls = found
        return self._controls
