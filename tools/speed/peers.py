"""Other libraries that the suite is measured beside, each in an environment of its own.

They are no dependencies, and pin old versions of what the suite uses. An environment is made once,
on request, in the cache folder.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import venv
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import cache_dir, write_bytes


@dataclass(frozen=True)
class Peer:
    """A library in an environment of its own."""

    requirement: str
    """What pip installs, in the version that docs/performance.md quotes: `"minigrid==3.2.0"`."""
    torch: bool = False
    """Whether it depends on torch: then it gets the version that is used here."""

    @property
    def folder(self) -> Path:
        """Where the environment is or will be."""
        return cache_dir() / "comparisons" / self.requirement.replace("==", "-")

    @property
    def python(self) -> Path:
        """Its interpreter."""
        return self.folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")

    @property
    def is_ready(self) -> bool:
        """Whether it has been made."""
        return (self.folder / "ready").exists()

    def make(self) -> Path:
        """Make the environment, unless it is there: a minute or more.

        Returns:
            Its interpreter.

        Raises:
            EnvironmentMissingError: If it can't be made.
        """
        if self.is_ready:
            return self.python
        # What a stop in the middle has left is of no use.
        shutil.rmtree(self.folder, ignore_errors=True)
        try:
            venv.create(self.folder, with_pip=True)
        except (OSError, subprocess.CalledProcessError) as error:
            reason = f"no virtual environment in {self.folder}: {error}"
            raise self._can_not_install(reason) from error
        wanted = [self.requirement]
        if self.torch:
            # The registry's default may be a build for CUDA of several gigabytes.
            wanted.append(f"torch=={metadata.version('torch').split('+')[0]}")
        words = [str(self.python), "-m", "pip", "install", "--quiet", *wanted]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode:
            shutil.rmtree(self.folder, ignore_errors=True)
            lines = (done.stderr or done.stdout).strip().splitlines()
            raise self._can_not_install(lines[-1] if lines else "pip says nothing")
        write_bytes(self.folder / "ready", b"")
        return self.python

    def require(self) -> Path:
        """Its interpreter.

        Raises:
            EnvironmentMissingError: If it has not been made.
        """
        if not self.is_ready:
            raise EnvironmentMissingError(
                f"{self.requirement} is not installed. Run: lcrl-bench bench --peers"
            )
        return self.python

    def _can_not_install(self, reason: str) -> EnvironmentMissingError:
        return EnvironmentMissingError(
            f"{self.requirement} can't be installed ({reason}). Check the network or pip's "
            "settings, or measure without it."
        )


MINIGRID: Final = Peer("minigrid==3.2.0")
IMITATION: Final = Peer("imitation==1.0.1", torch=True)
