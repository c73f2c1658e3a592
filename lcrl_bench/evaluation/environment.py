"""Everything a result may depend on besides its configuration: `environment.json` of a run."""

from __future__ import annotations

import os
import platform
from contextlib import suppress
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Final

import torch

from lcrl_bench.mdp.kernels.dispatch import kernel_name
from lcrl_bench.storage import read_json
from lcrl_bench.version import __version__

PACKAGES: Final = (
    "dm-control",
    "embreex",
    "mujoco",
    "numba",
    "numpy",
    "rerun-sdk",
    "safetensors",
    "torch",
)
"""Packages whose versions a result depends on, if they are installed."""


@dataclass(frozen=True)
class Environment:
    """What a result may depend on besides its configuration."""

    lcrl_bench: str
    python: str
    platform: str
    machine: str
    device: str
    kernel: str
    """`numba` or `torch`: what computes (`mdp.kernels`)."""
    cores: int | None
    threads: int
    """Of torch."""
    versions: dict[str, str]
    """`installed_versions`."""


def environment(device: torch.device) -> Environment:
    """The environment of this process."""
    return Environment(
        lcrl_bench=__version__,
        python=platform.python_version(),
        platform=platform.platform(),
        machine=platform.machine(),
        device=str(device),
        kernel=kernel_name(device),
        cores=os.cpu_count(),
        threads=torch.get_num_threads(),
        versions=installed_versions(),
    )


def installed_versions() -> dict[str, str]:
    """Versions of the installed `PACKAGES`; some don't exist for every Python."""
    found = {}
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            found[name] = metadata.version(name)
    return found


def other_versions(run: Path) -> tuple[str, ...]:
    """Packages whose version differs from a run's: `torch 2.7.0 (2.8.0 here)`."""
    file, now = run / "environment.json", installed_versions()
    before = read_json(file).get("versions", {}) if file.exists() else {}
    return tuple(
        f"{name} {before[name]} ({now.get(name, 'not installed')} here)"
        for name in PACKAGES
        if name in before and before[name] != now.get(name)
    )
