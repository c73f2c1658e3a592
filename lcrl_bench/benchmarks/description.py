"""What `lcrl-bench show` reports on a benchmark: counts, splits, words, lengths."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.houses.house import OpeningKind

OPENING_CLASSES = {
    OpeningKind.DOOR: "door_frame",
    OpeningKind.DOORWAY: "door_frame",
    OpeningKind.CLOSED_DOOR: "door",
    OpeningKind.WINDOW: "window",
}
"""The class visible at an opening of each kind."""


def describe_benchmark(benchmark: Benchmark) -> dict[str, Any]:
    """Statistics of a benchmark, as plain values."""
    moved = {
        benchmark.houses[task.house].object(task.moved).label
        for task in benchmark.tasks
        if task.moved is not None
    }
    lengths = {kind: [t.proof.optimal_length for t in benchmark.select(kind=kind)] for kind in Kind}
    return {
        "name": benchmark.name,
        "fingerprint": benchmark.fingerprint,
        "houses": len(benchmark.houses),
        "rooms": sum(len(house.rooms) for house in benchmark.houses.values()),
        "tiles": sum(grid.tiles for grid in benchmark.grids.values()),
        "tasks": len(benchmark.tasks),
        "pick": len(benchmark.select(kind=Kind.PICK)),
        "nav": len(benchmark.select(kind=Kind.NAV)),
        "splits": {split.value: len(benchmark.select(split=split)) for split in Split},
        "split_houses": {split.value: len(benchmark.houses_of(split)) for split in Split},
        "objects": len(moved),
        "classes": len(classes_of(benchmark)),
        "vocabulary": list(benchmark.vocabulary),
        "optimal_length": {
            kind.value: {
                "min": int(min(values)),
                "median": float(np.median(values)),
                "max": int(max(values)),
            }
            for kind, values in lengths.items()
            if values
        },
        "targets": dict(sorted(Counter(task.target for task in benchmark.tasks).items())),
    }


def classes_of(benchmark: Benchmark) -> set[str]:
    """Names of the classes in a benchmark's houses, including void, which is outside them."""
    found = {"void", "wall", "floor", "ceiling"}
    for house in benchmark.houses.values():
        found |= {thing.label for thing in house.objects}
        for wall in house.walls:
            found |= {OPENING_CLASSES[opening.kind] for opening in wall.openings}
    return found
