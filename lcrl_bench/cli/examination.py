"""The facts that `lcrl-bench doctor` reports: versions, devices, and pictures of a known house."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any, Final

from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.storage import cache_dir

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lcrl_bench.scenes.surface import Surface

DISTRIBUTIONS: Final = {
    "lcrl_bench": "lcrl-bench",
    "mujoco": "mujoco",
    "numba": "numba",
    "torch": "torch",
    "numpy": "numpy",
    "scipy": "scipy",
    "trimesh": "trimesh",
    "embreex": "embreex",
    "gymnasium": "gymnasium",
    "rerun": "rerun-sdk",
}
"""Name shown → distribution whose version it is."""

HOUSE_SEED: Final = 0
"""Seed of the known house."""

POINTS: Final = 16
"""Standing points drawn from."""

SECONDS: Final = 0.3
"""How long each renderer is timed."""


def examine() -> dict[str, Any]:
    """Everything there is to report, as plain JSON values."""
    return {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "versions": {name: _version(each) for name, each in DISTRIBUTIONS.items()},
        "torch": _torch(),
        "cache": str(cache_dir()),
        "cache_writable": _cache_is_writable(),
        **_rendering(),
    }


def _version(distribution: str) -> str | None:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None


def _torch() -> dict[str, Any]:
    import torch

    gpu = torch.cuda.get_device_name(0) if torch.cuda.is_available() else None
    return {
        "device": "cpu" if gpu is None else "cuda",
        "threads": torch.get_num_threads(),
        "cuda": gpu,
    }


def _cache_is_writable() -> bool:
    folder = cache_dir()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK)


def _rendering() -> dict[str, Any]:
    """What OpenGL there is, the milliseconds a panorama takes, whether the pictures agree.

    `agreement` is the share of pixels, 0..1, in which the two renderers are equal; None unless
    both draw.
    """
    from lcrl_bench.scenes.panoramas import describe_gl

    gl = asdict(describe_gl())
    milliseconds: dict[str, float | None] = {"gl": None, "rays": None}
    report = {"gl": gl, "rays_error": "", "panorama_ms": milliseconds, "agreement": None}
    report["mujoco_error"] = _mujoco_error()
    if report["mujoco_error"]:
        return report
    pictures: dict[str, NDArray[np.uint8]] = {}
    errors = {"gl": "", "rays": ""}
    surfaces, points = _known_scene()
    for backend in milliseconds:
        try:
            milliseconds[backend], pictures[backend] = _draw(backend, surfaces, points)
        except EnvironmentMissingError as error:
            errors[backend] = str(error)
    gl["error"] = gl["error"] or errors["gl"]
    report["rays_error"] = errors["rays"]
    if len(pictures) == len(milliseconds):
        report["agreement"] = float((pictures["gl"] == pictures["rays"]).mean())
    return report


def _mujoco_error() -> str:
    # With MUJOCO_GL set and its library missing, importing mujoco fails in PyOpenGL's words.
    try:
        import mujoco  # noqa: F401
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""


def _known_scene() -> tuple[Sequence[Surface], NDArray[np.float64]]:
    from lcrl_bench.houses.procedural import generate_house
    from lcrl_bench.scenes.furnishing import house_surfaces
    from lcrl_bench.scenes.walkable import build_grid

    house = generate_house(HOUSE_SEED)
    points = build_grid(house).points
    return house_surfaces(house), points[:: max(1, len(points) // POINTS)][:POINTS]


def _draw(
    backend: str, surfaces: Sequence[Surface], points: NDArray[np.float64]
) -> tuple[float, NDArray[np.uint8]]:
    """Milliseconds a panorama, and the pictures: uint8 [point, 4, height, width]."""
    from lcrl_bench.scenes.panoramas import open_renderer, time_panoramas

    with open_renderer(surfaces, backend=backend) as renderer:
        pictures = renderer.render(points)
        return round(time_panoramas(renderer, points, seconds=SECONDS), 3), pictures
