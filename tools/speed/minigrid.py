"""MiniGrid in an environment of its own: what users would otherwise pick, and no dependency."""

from __future__ import annotations

import os
import shutil
import subprocess
import venv
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import cache_dir, write_bytes

REQUIREMENT: Final = "minigrid==3.2.0"
"""The version that docs/speed.md quotes."""
TASKS: Final = ("MiniGrid-Empty-8x8-v0", "BabyAI-GoToLocal-v0")
"""Its simplest environment, and one with a command like ours."""


def minigrid_python() -> Path:
    """The interpreter of an environment with MiniGrid, which is created the first time.

    Raises:
        EnvironmentMissingError: If it can't be created.
    """
    folder = cache_dir() / "comparisons" / REQUIREMENT.replace("==", "-")
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    ready = folder / "ready"
    if not ready.exists():
        # What a stop in the middle has left is of no use.
        shutil.rmtree(folder, ignore_errors=True)
        try:
            venv.create(folder, with_pip=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise _can_not_install(f"no virtual environment in {folder}: {error}") from error
        _run([str(python), "-m", "pip", "install", "--quiet", REQUIREMENT])
        write_bytes(ready, b"")
    return python


def _run(words: Sequence[str]) -> None:
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        lines = (done.stderr or done.stdout).strip().splitlines()
        raise _can_not_install(lines[-1] if lines else f"{words[0]} ended with {done.returncode}")


def _can_not_install(reason: str) -> EnvironmentMissingError:
    return EnvironmentMissingError(
        f"{REQUIREMENT} can't be installed ({reason}). Check the network or pip's settings, or "
        "measure without --minigrid."
    )
