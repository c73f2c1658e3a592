"""`lcrl-bench doctor`: is this machine ready? Versions, devices, the renderer and its speed.

A known house is drawn from the same points by every renderer that starts, so a machine whose
OpenGL starts but draws something else is found too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.examination import examine
from lcrl_bench.cli.output import print_json, print_table, stdout_kept_clean, suggest, warn
from lcrl_bench.errors import ExitCode

SAME_PICTURE: Final = 0.995
"""Least share of equal pixels between two renderers; they differ at edges only."""


@dataclass(frozen=True)
class DoctorArguments:
    """Find out whether this machine is ready, and what it will run on.

    Ends with exit code 4 if nothing can render or no cache can be written, and 1 if the two
    renderers draw different pictures.
    """

    json: bool = False
    """Print one JSON object and nothing else on stdout."""


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
    """What a person should know about a report, a sentence or two each."""
    gl, torch, drawn = report["gl"], report["torch"], report["panorama_ms"]
    instead = " Rays draw the same pictures without it." * (drawn["rays"] is not None)
    spared = report["renderer"] == "rays"
    chosen = "Rays are used unless --renderer gl asks for it." if spared else "It takes longer."
    share = f"{report['agreement'] or 0:.2%}"
    sentences = (
        (
            report["mujoco_error"],
            f"MuJoCo can't be imported: {report['mujoco_error']}.",
        ),
        (
            gl["software"],
            f"software renderer: {gl['renderer']} draws with the processor, not with a graphics "
            f"card. The pictures are the same. {chosen}",
        ),
        (gl["error"], f"no OpenGL: {gl['error']}{instead}"),
        (report["rays_error"], f"no rays: {report['rays_error']}"),
        (
            _differs(report),
            f"the renderers agree in {share} of pixels only: report it, and use --renderer rays.",
        ),
        (
            not report["cache_writable"],
            f"{report['cache']} can't be written: set LCRL_BENCH_HOME to a folder that can.",
        ),
        (torch["cuda"] is None, "no CUDA device: networks run on the processor."),
    )
    return [sentence for holds, sentence in sentences if holds]


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
        ("renderer", f"{report['renderer']} (--renderer auto)"),
        ("drawn by OpenGL", drawn["gl"]),
        ("drawn by rays", drawn["rays"]),
        ("same picture", "-" if report["agreement"] is None else f"{report['agreement']:.3%}"),
        ("cache", report["cache"]),
        ("ready", "yes" if report["ok"] else "no"),
    ]
