"""Re-rendering a benchmark: compares both renderers with its views."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.observation import arrangements_of
from lcrl_bench.panoramas import Panoramas


@dataclass(frozen=True)
class Agreement:
    """How far a renderer agrees with a benchmark's panoramas."""

    panoramas: int
    equal: float
    """Share of equal pixels, 0..1."""
    worst: float
    """The lowest share in any panorama."""


def rerender(
    benchmark: Benchmark,
    backends: Sequence[str],
    *,
    houses: Sequence[str] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, Agreement]:
    """Render a benchmark's panoramas again and compare them with the ones in use.

    Args:
        benchmark: The benchmark; its frozen views are the reference, if it has them.
        backends: `"gl"`, `"rays"` or both.
        houses: Ids of the houses to render; None means all.
        progress: Called with each house when it is done.

    Returns:
        Backend → agreement.

    Raises:
        EnvironmentMissingError: If a backend can't start here.
    """
    names = tuple(benchmark.houses) if houses is None else tuple(houses)
    shares: dict[str, list[NDArray[np.float64]]] = {backend: [] for backend in backends}
    for name in names:
        scene, arrangements = benchmark.scene(name), arrangements_of(benchmark.select(house=name))
        known = scene.panoramas(arrangements)
        for backend in backends:
            again = scene.render(arrangements, backend)
            equal = [
                (one == other).mean() for one, other in zip(_each(known), _each(again), strict=True)
            ]
            shares[backend].append(np.array(equal))
        progress(name)
    joined = {backend: np.concatenate(rows) for backend, rows in shares.items()}
    return {
        backend: Agreement(len(rows), float(rows.mean()), float(rows.min()))
        for backend, rows in joined.items()
    }


def _each(panoramas: Panoramas) -> Iterator[NDArray[np.uint8]]:
    """Yield panoramas one by one: all of a large house at once would take gigabytes."""
    return map(panoramas.pixels, range(len(panoramas)))
