"""Rendering: all panoramas of a house, beside a loop over `mujoco.Renderer`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import torch

from lcrl_bench.cli.bench import Figure
from lcrl_bench.errors import EnvironmentMissingError
from lcrl_bench.scenes.arrangement import Arrangement
from lcrl_bench.scenes.scene import Scene
from tools.speed.rendering import PIXEL_LIMIT, cannot_render, panorama_comparison
from tools.speed.timing import time_variants

GOALS: Final = {"rays": 60, "OpenGL": 20}
"""How many times less CPU time than the loop."""
_REPEATS: Final = 2


def measure_rendering(
    houses: Sequence[tuple[Scene, Sequence[Arrangement]]],
) -> tuple[Figure, ...]:
    """Draw every arrangement from every tile, by rays and by OpenGL.

    Args:
        houses: Scenes, and the arrangements to draw.

    Raises:
        EnvironmentMissingError: If there is no OpenGL here, or no Embree.
    """
    if reason := cannot_render():
        raise EnvironmentMissingError(reason)
    seconds: dict[str, float] = {}
    apart: dict[str, float] = {}
    loop = 0.0
    for scene, arrangements in houses:
        with panorama_comparison(scene, arrangements) as comparison:
            timings = time_variants(comparison, repeats=_REPEATS, device=torch.device("cpu"))
        loop += min(timings[0].seconds)
        for variant, timing in zip(comparison.variants[1:], timings[1:], strict=True):
            seconds[variant.name] = seconds.get(variant.name, 0.0) + min(timing.seconds)
            apart[variant.name] = max(apart.get(variant.name, 0.0), timing.difference)
    return tuple(
        Figure(
            "rendering",
            f"all panoramas of {len(houses)} houses, by {name}",
            "mujoco.Renderer in a loop",
            loop / seconds[name],
            "x",
            goal,
            difference=apart[name],
            limit=PIXEL_LIMIT,
            detail={"ours_s": seconds[name], "theirs_s": loop, "houses": len(houses)},
        )
        for name, goal in GOALS.items()
    )
