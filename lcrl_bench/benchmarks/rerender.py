"""Re-rendering a benchmark: compares both renderers with its views."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
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
    found = []
    for name in names:
        found.append(house_agreement(benchmark, name, backends))
        progress(name)
    return join_agreements(found)


def house_agreement(
    benchmark: Benchmark, house: str, backends: Sequence[str]
) -> dict[str, Agreement]:
    """`rerender` for one house."""
    scene, arrangements = benchmark.scene(house), arrangements_of(benchmark.select(house=house))
    known = scene.panoramas(arrangements)
    return {backend: _compare(known, scene.render(arrangements, backend)) for backend in backends}


def join_agreements(houses: Sequence[Mapping[str, Agreement]]) -> dict[str, Agreement]:
    """The agreement in all houses, from that in each, backend by backend."""
    found = {}
    for backend in houses[0]:
        rows = [house[backend] for house in houses]
        count = sum(row.panoramas for row in rows)
        equal = math.fsum(row.equal * row.panoramas for row in rows) / count
        found[backend] = Agreement(count, equal, min(row.worst for row in rows))
    return found


def _compare(known: Panoramas, again: Panoramas) -> Agreement:
    pairs = zip(_each(known), _each(again), strict=True)
    shares = np.array([(one == other).mean() for one, other in pairs])
    return Agreement(len(shares), float(shares.mean()), float(shares.min()))


def _each(panoramas: Panoramas) -> Iterator[NDArray[np.uint8]]:
    """Yield panoramas one by one: all of a large house at once would take gigabytes."""
    return map(panoramas.pixels, range(len(panoramas)))
