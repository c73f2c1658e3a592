"""Which run is meant: its folder, or the newest finished one below a folder of runs."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lcrl_bench.errors import NothingSelectedError, UsageError
from lcrl_bench.evaluation.run_folder import RunFolder, is_set_aside

RUNS: Final = Path("runs")
"""Where `run` writes to if nothing else is said."""
_DEPTHS: Final = ("*", "*/*", "*/*/*")
"""Where runs are below a folder: beside each other, by method, by benchmark and method."""


def find_run(folder: Path = RUNS) -> Path:
    """The run that a folder stands for.

    Args:
        folder: A run, `runs/<benchmark>/<method>/seed<k>`; or a folder above it, which stands for
            the run below it that was finished last.

    Raises:
        UsageError: If there is no such folder.
        NothingSelectedError: If no finished run is below it.
    """
    if (folder / "config.json").is_file():
        return folder
    train = "Train one: lcrl-bench run --method lcrl --benchmark mini"
    if not folder.is_dir() and folder != RUNS:
        raise UsageError(f"{folder} is no folder. Name a run: runs/<benchmark>/<method>/seed<k>.")
    runs = finished_runs(folder)
    if not runs:
        raise NothingSelectedError(f"No finished run in {folder}. {train}")
    return runs[0]


def finished_runs(folder: Path) -> tuple[Path, ...]:
    """The finished runs up to three folders below a folder, the one finished last first."""
    found = [path for depth in _DEPTHS for path in folder.glob(depth) if RunFolder(path).done]
    runs = [path for path in found if (path / "config.json").is_file() and not is_set_aside(path)]
    return tuple(sorted(runs, key=lambda path: (-(path / "DONE").stat().st_mtime_ns, path)))
