"""The convex hulls of the hollows, read from `assets/hulls` and checked against their hashes.

They are made offline by `scripts/make_hulls.py`: CoACD takes seconds per mesh and bundles its own
OpenMP runtime, so it never runs while a house is loaded.
"""

from __future__ import annotations

import io
import json
from functools import lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.scenes.shapes.primitives import Template
from lcrl_bench.storage import sha256_of

_FIX = "Restore assets/hulls, or rebuild the hulls: python scripts/make_hulls.py"
_MADE = "Rebuild the hulls: python scripts/make_hulls.py"


@lru_cache(maxsize=1)
def hull_manifest() -> dict[str, dict[str, Any]]:
    """Name of a hollow → `mesh` and `file`: the SHA-256 of the template and of its hull file."""
    file = resources.files("lcrl_bench.assets").joinpath("hulls/manifest.json")
    return json.loads(file.read_text("utf-8"))["hollows"]


def mesh_hash(template: Template) -> str:
    """SHA-256 of a template's shape, rounded to a micrometre of the unit box."""
    vertices = np.round(template.vertices * 1e6).astype("<i8")
    return sha256_of(vertices.tobytes() + template.faces.astype("<i4").tobytes())


@lru_cache(maxsize=128)
def hollow_hulls(name: str) -> tuple[Template, ...]:
    """The convex hulls of the hollow `name`, in the unit box.

    Raises:
        InvalidFileError: If it has no hulls.
        IntegrityError: If the file's hash is not the manifest's.
    """
    path = resources.files("lcrl_bench.assets").joinpath(f"hulls/{name}.npz")
    if name not in hull_manifest() or not path.is_file():
        raise InvalidFileError(str(path), "this hollow has no hulls", fix=_MADE)
    data = path.read_bytes()
    expected, found = hull_manifest()[name]["file"], sha256_of(data)
    if found != expected:
        raise IntegrityError(Path(str(path)), expected, found, fix=_FIX)
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        count = len(arrays.files) // 2
        return tuple(
            Template(arrays[f"v{k}"].astype(np.float64), arrays[f"f{k}"].astype(np.int32))
            for k in range(count)
        )
