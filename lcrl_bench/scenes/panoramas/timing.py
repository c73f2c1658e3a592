"""Rendering time of a panorama."""

from __future__ import annotations

import time
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.renderer import PanoramaRenderer

_SECONDS: Final = 1.0
_WARM: Final = 16


def time_panoramas(
    renderer: PanoramaRenderer, points: NDArray[np.float64], *, seconds: float = _SECONDS
) -> float:
    """Time the rendering of panoramas, repeatedly.

    Args:
        renderer: An open renderer.
        points: [point, 2] metres, at least one: standing points of its house.
        seconds: How long to measure; at least one pass over all points.

    Returns:
        Milliseconds per panorama in the fastest pass over all points: other load on the machine
        can only slow it down.
    """
    renderer.render(points[:_WARM])
    best, end = float("inf"), time.perf_counter() + seconds
    while True:
        start = time.perf_counter()
        renderer.render(points)
        stop = time.perf_counter()
        best = min(best, stop - start)
        if stop >= end:
            return 1000 * best / len(points)
