"""An environment of its own for the libraries that the suite is measured beside.

They pin old versions of what the suite uses, so they can't share an environment with it. It is made
once, on request, in the cache folder.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import venv
from importlib import metadata
from pathlib import Path
from typing import Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import cache_dir, sha256_of, write_bytes

REQUIREMENTS: Final = ("imitation==1.0.1", "minigrid==3.2.0")
"""What is measured, in the versions that docs/performance.md quotes."""

SCRIPTS: Final = Path(__file__).with_name("peers")


def peer_folder() -> Path:
    """Where the environment is or will be: `$LCRL_BENCH_PEERS`, else a folder per version."""
    named = os.environ.get("LCRL_BENCH_PEERS")
    if named:
        return Path(named)
    name = json.dumps([sys.version_info[:2], _requirements()])
    return cache_dir() / "bench" / f"peers-{sha256_of(name.encode())[:12]}"


def is_ready() -> bool:
    """Whether the environment has been made."""
    return (peer_folder() / "ready").exists()


def make_peers() -> None:
    """Make the environment, unless it is there: minutes, and about 1.5 GB.

    Raises:
        EnvironmentMissingError: If it can't be made or pip can't install.
    """
    if is_ready():
        return
    folder = peer_folder()
    shutil.rmtree(folder, ignore_errors=True)
    try:
        venv.create(folder, with_pip=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise EnvironmentMissingError(f"{folder}: no environment can be made: {error}.") from error
    words = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", *_requirements()]
    done = subprocess.run([_python(), *words], capture_output=True, text=True, check=False)
    if done.returncode:
        shutil.rmtree(folder, ignore_errors=True)
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise EnvironmentMissingError(
            f"pip can't install {' '.join(REQUIREMENTS)} into {folder}: {last}. With the network "
            "back, run it again; without --peers, what needs them is left out."
        )
    write_bytes(folder / "ready", b"")


def run_script(name: str, *words: str) -> str:
    """Run a program of `peers/` in the environment, on one thread.

    Args:
        name: Its file.
        words: Its arguments.

    Returns:
        What it prints.

    Raises:
        EnvironmentMissingError: If it fails.
    """
    single = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    if not is_ready():
        raise EnvironmentMissingError(
            f"{' and '.join(REQUIREMENTS)} are not installed. Run: lcrl-bench bench --peers"
        )
    command = [_python(), "-W", "ignore", str(SCRIPTS / name), *words]
    done = subprocess.run(
        command, env={**os.environ, **single}, capture_output=True, text=True, check=False
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise EnvironmentMissingError(
            f"{name} failed in {peer_folder()}: {last}. Delete the folder to make it anew."
        )
    return done.stdout


def _requirements() -> list[str]:
    # The build of torch that is used here: the default of the registry may be one for CUDA.
    return [*REQUIREMENTS, f"torch=={metadata.version('torch').split('+')[0]}"]


def _python() -> str:
    return str(peer_folder() / "bin" / "python")
