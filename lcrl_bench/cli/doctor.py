"""`lcrl-bench doctor`: is this machine ready? Versions, devices, the renderer and its speed.

A known house is drawn from the same points by every renderer that starts, so a machine whose
OpenGL starts but draws something else is found too.
"""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any, Final

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_json, print_table, stdout_kept_clean, suggest, warn
from lcrl_bench.errors import EnvironmentMissingError, ExitCode
from lcrl_bench.storage import cache_dir

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lcrl_bench.scenes.surface import Surface

DISTRIBUTIONS: Final = {
    "lcrl_bench": "lcrl-bench",
    "mujoco": "mujoco",
    "dm_control": "dm-control",
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

POINTS: Final = 8
"""Standing points drawn from; enough for a steady time, few enough for a slow machine."""

REPEATS: Final = 3
"""Times each renderer draws them; the best counts."""

SAME_PICTURE: Final = 0.995
"""Least share of equal pixels between two renderers; they differ at edges only."""


@dataclass(frozen=True)
class DoctorArguments:
    """Find out whether this machine is ready, and what it will run on.

    Ends with exit code 4 if nothing can render here, 1 if the renderers disagree.
    """

    json: bool = False
    """Print one JSON object and nothing else on stdout."""


def main(argv: Sequence[str]) -> int:
    """Print the report."""
    arguments = parse_arguments(DoctorArguments, argv, verb="doctor")
    with stdout_kept_clean(arguments.json):
        report = examine()
    if arguments.json:
        print_json(report)
    else:
        print_table(("what", "found"), _rows(report))
    for trap in traps(report):
        warn(trap)
    if report["ok"]:
        suggest("lcrl-bench run --method lcrl", "train and evaluate")
    return exit_code(report)


def examine() -> dict[str, Any]:
    """Everything `doctor` says, as plain JSON values."""
    rendering = _rendering()
    report = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "versions": {name: _version(each) for name, each in DISTRIBUTIONS.items()},
        "torch": _torch(),
        "cache": str(cache_dir()),
        "cache_writable": _cache_is_writable(),
        **rendering,
    }
    return {**report, "ok": exit_code(report) == ExitCode.DONE}


def exit_code(report: dict[str, Any]) -> ExitCode:
    """0 if all is well, 4 if nothing can render, 1 if two renderers draw different pictures."""
    if all(milliseconds is None for milliseconds in report["panorama_ms"].values()):
        return ExitCode.ENVIRONMENT
    if not report["cache_writable"]:
        return ExitCode.ENVIRONMENT
    agreement = report["agreement"]
    if agreement is not None and agreement < SAME_PICTURE:
        return ExitCode.RED
    return ExitCode.DONE


def traps(report: dict[str, Any]) -> list[str]:
    """What a person should know about the report, a sentence each."""
    found = []
    gl = report["gl"]
    if gl["software"]:
        found.append(
            f"software renderer: {gl['renderer']} draws with the processor, not a graphics card. "
            "The pictures are right; they are slower."
        )
    elif gl["backend"] is None:
        found.append(f"no OpenGL: {gl['error']} Rays draw the same pictures without it.")
    if report["rays_error"]:
        found.append(f"no rays: {report['rays_error']}")
    if report["agreement"] is not None and report["agreement"] < SAME_PICTURE:
        share = f"{report['agreement']:.2%}"
        found.append(f"the two renderers agree on {share} of the pixels only: use --renderer rays.")
    if not report["cache_writable"]:
        found.append(f"{report['cache']} can't be written: set LCRL_BENCH_HOME to a folder.")
    if report["torch"]["cuda"] is None:
        found.append("no CUDA device: networks run on the processor.")
    return found


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
    """The report's part on pictures: OpenGL, milliseconds a panorama, agreement."""
    from lcrl_bench.scenes.panoramas.context import describe_gl

    gl = asdict(describe_gl())
    pictures: dict[str, NDArray[np.uint8]] = {}
    milliseconds: dict[str, float | None] = {"gl": None, "rays": None}
    errors = {"gl": "", "rays": ""}
    surfaces, points = _known_scene()
    for backend in milliseconds:
        try:
            milliseconds[backend], pictures[backend] = _draw(backend, surfaces, points)
        except (EnvironmentMissingError, ImportError) as error:
            errors[backend] = str(error)
    both = len(pictures) == len(milliseconds)
    agreement = float((pictures["gl"] == pictures["rays"]).mean()) if both else None
    gl["error"] = gl["error"] or errors["gl"]
    return {
        "gl": gl,
        "rays_error": errors["rays"],
        "panorama_ms": milliseconds,
        "agreement": agreement,
    }


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
    """Milliseconds a panorama, and the pictures."""
    from lcrl_bench.scenes.panoramas import open_renderer
    from lcrl_bench.semantics import DEFAULT_SEMANTICS

    with open_renderer(surfaces, DEFAULT_SEMANTICS, backend=backend) as renderer:
        pictures = renderer.render(points)
        seconds = []
        for _ in range(REPEATS):
            began = time.perf_counter()
            renderer.render(points)
            seconds.append(time.perf_counter() - began)
    return round(min(seconds) / len(points) * 1000, 3), pictures


def _rows(report: dict[str, Any]) -> list[tuple[str, str]]:
    gl, torch = report["gl"], report["torch"]
    kind = "software" if gl["software"] else "hardware"
    drawn = {
        backend: "-" if each is None else f"{each:.2f} ms a panorama"
        for backend, each in report["panorama_ms"].items()
    }
    return [
        ("python", f"{report['python']} on {report['platform']}"),
        *((name, found or "not installed") for name, found in report["versions"].items()),
        ("torch device", f"{torch['cuda'] or 'cpu'}, {torch['threads']} threads"),
        ("OpenGL", f"{gl['renderer']} ({gl['backend']}, {kind})" if gl["backend"] else "none"),
        ("drawn by OpenGL", drawn["gl"]),
        ("drawn by rays", drawn["rays"]),
        ("same picture", "-" if report["agreement"] is None else f"{report['agreement']:.3%}"),
        ("cache", report["cache"]),
        ("ready", "yes" if report["ok"] else "no"),
    ]
