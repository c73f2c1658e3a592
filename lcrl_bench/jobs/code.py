"""A digest of the code that jobs run: the package, its data files, and what computes for it."""

from __future__ import annotations

from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from lcrl_bench.storage import canonical_json, sha256_of

PACKAGES: Final = ("lcrl_bench", "lcrl_bench.assets", "lcrl_bench.baselines")
"""Packages whose files count."""
COUNTED: Final = (".csv", ".py", ".toml")
"""Suffixes of the files that count."""
INSTALLED: Final = ("embreex", "mujoco", "numba", "numpy", "scipy", "shapely", "torch", "trimesh")
"""Packages whose versions count."""


@cache
def code_digest() -> str:
    """SHA-256 over the suite's files and the versions of what it computes with, as of now.

    It is read once per process. Any change makes other jobs: their values are short-lived, so
    nothing is gained by telling apart which files a job really uses.
    """
    files = {
        f"{package}/{path.relative_to(folder)}": sha256_of(path.read_bytes())
        for package in PACKAGES
        for folder in _folders(package)
        for path in sorted(folder.rglob("*"))
        if path.suffix in COUNTED
    }
    versions = {name: _version(name) for name in INSTALLED}
    return sha256_of(canonical_json({"files": files, "versions": versions}))


def _folders(package: str) -> list[Path]:
    spec = find_spec(package)
    places = None if spec is None else spec.submodule_search_locations
    return [Path(place) for place in places or ()]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
