"""`lcrl-bench doctor`: is this machine ready? Versions, devices, the renderer and its speed.

Every renderer that starts draws the same house from the same points, so that a machine whose OpenGL
starts but draws something else is found too.
"""

from __future__ import annotations

import os
import platform
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

SAME_PICTURE: Final = 0.995
"""Smallest share of equal pixels between two renderers, which may differ at edges."""
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
"""Name shown → distribution whose version is reported."""

HOUSE_SEED: Final = 0
"""Seed of the house that is drawn."""

POINTS: Final = 16
"""Number of standing points drawn from."""

SECONDS: Final = 0.3
"""Seconds for which each renderer is timed."""


@dataclass(frozen=True)
class DoctorArguments:
    """Check whether this machine is ready, and what it will run on.

    Exits with code 4 if nothing can render or the cache can't be written, and with 1 if the two
    renderers draw different pictures.
    """

    json: bool = False
    """Print only a JSON object on stdout."""


def main(argv: Sequence[str]) -> int:
    """Print the report."""
    arguments = parse_arguments(DoctorArguments, argv, verb="doctor")
    with stdout_kept_clean(arguments.json):
        report = examine()
    code = verdict(report)
    report["ok"] = code == ExitCode.DONE
    if arguments.json:
        print_json(report)
    else:
        print_table(("what", "found"), _rows(report))
    for trap in traps(report):
        warn(trap)
    if report["ok"]:
        suggest(("lcrl-bench", "run", "--method", "lcrl"), "train and evaluate")
    return code


def verdict(report: dict[str, Any]) -> ExitCode:
    """The exit code of a report (see `DoctorArguments`)."""
    draws = any(each is not None for each in report["panorama_ms"].values())
    if not (draws and report["cache_writable"]):
        return ExitCode.ENVIRONMENT
    return ExitCode.RED if _differs(report) else ExitCode.DONE


def _differs(report: dict[str, Any]) -> bool:
    return report["agreement"] is not None and report["agreement"] < SAME_PICTURE


def traps(report: dict[str, Any]) -> list[str]:
    """Warnings about a report, a sentence or two each."""
    gl, torch, drawn = report["gl"], report["torch"], report["panorama_ms"]
    instead = " Rays draw the same pictures without it." * (drawn["rays"] is not None)
    spared = report["renderer"] == "rays"
    chosen = "Rays are used unless you pass --renderer gl." if spared else "It is slower."
    share = f"{report['agreement'] or 0:.2%}"
    sentences = (
        (
            report["mujoco_error"],
            f"MuJoCo can't be imported: {report['mujoco_error']}.",
        ),
        (
            gl["software"],
            f"software renderer: {gl['renderer']} draws on the CPU, not on a graphics card. The "
            f"pictures are the same. {chosen}",
        ),
        (gl["error"], f"no OpenGL: {gl['error']}{instead}"),
        (report["rays_error"], f"no rays: {report['rays_error']}"),
        (
            _differs(report),
            f"the renderers agree in only {share} of pixels: report it, and use --renderer rays.",
        ),
        (
            not report["cache_writable"],
            f"{report['cache']} can't be written: set LCRL_BENCH_HOME to a writable folder.",
        ),
        (torch["cuda"] is None, "no CUDA device: networks run on the CPU."),
    )
    return [sentence for holds, sentence in sentences if holds]


def _rows(report: dict[str, Any]) -> list[tuple[str, str]]:
    gl, torch = report["gl"], report["torch"]
    kind = "software" if gl["software"] else "hardware"
    drawn = {
        backend: "-" if each is None else f"{each:.2f} ms per panorama"
        for backend, each in report["panorama_ms"].items()
    }
    return [
        ("python", f"{report['python']} on {report['platform']}"),
        *((name, found or "not installed") for name, found in report["versions"].items()),
        ("torch device", f"{torch['cuda'] or 'cpu'}, {torch['threads']} threads"),
        ("OpenGL", f"{gl['renderer']} ({gl['backend']}, {kind})" if gl["backend"] else "none"),
        ("renderer", f"{report['renderer']} (--renderer auto)"),
        ("drawn by OpenGL", drawn["gl"]),
        ("drawn by rays", drawn["rays"]),
        ("same picture", "-" if report["agreement"] is None else f"{report['agreement']:.3%}"),
        ("cache", report["cache"]),
        ("ready", "yes" if report["ok"] else "no"),
    ]


def examine() -> dict[str, Any]:
    """The report, as plain JSON values."""
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
    """OpenGL, milliseconds per panorama, and whether the renderers agree.

    `renderer` is what `--renderer auto` means here. `agreement` is the share of equal pixels of the
    two renderers, 0..1; None unless both draw.
    """
    from lcrl_bench.scenes.panoramas import automatic_backend, describe_gl

    found = describe_gl()
    gl = asdict(found)
    milliseconds: dict[str, float | None] = {"gl": None, "rays": None}
    report = {"gl": gl, "renderer": automatic_backend(found), "rays_error": ""}
    report |= {"panorama_ms": milliseconds, "agreement": None}
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
    try:
        import lcrl_bench.scenes.mujoco_import  # noqa: F401
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
    """Milliseconds per panorama, and the pictures: uint8 [point, 4, height, width]."""
    from lcrl_bench.scenes.panoramas import open_renderer, time_panoramas

    with open_renderer(surfaces, backend=backend) as renderer:
        pictures = renderer.render(points)
        return round(time_panoramas(renderer, points, seconds=SECONDS), 3), pictures
