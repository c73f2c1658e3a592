"""How often panoramas, views and patches repeat in a house: total work beside distinct work."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.networks.patches import POOL, PatchIndex


@dataclass(frozen=True)
class Repetition:
    """One layer whose items are computed once each instead of once per occurrence."""

    name: str
    every: int
    """Number of occurrences."""
    distinct: int
    """Number of distinct items: only these are computed."""

    @property
    def times(self) -> float:
        """Occurrences per distinct item."""
        return self.every / max(self.distinct, 1)


def repetitions(houses: Sequence[tuple[Sequence[TaskSet], PatchIndex]]) -> tuple[Repetition, ...]:
    """Count over houses, from the tasks down to the layers of the image encoder.

    Args:
        houses: For each, what training sees of it, and the index of its distinct patches.
    """
    counted = [_of_house(house, index) for house, index in houses]
    return tuple(
        Repetition(
            layers[0].name,
            sum(layer.every for layer in layers),
            sum(layer.distinct for layer in layers),
        )
        for layers in zip(*counted, strict=True)
    )


def _of_house(house: Sequence[TaskSet], index: PatchIndex) -> tuple[Repetition, ...]:
    seen = sum(tasks.panoramas.numel() for tasks in house)
    views, height, width = house[0].views.views.shape
    panoramas, sides = house[0].views.panorama_views.shape
    cells = views * (height // POOL) * (width // POOL)
    return (
        Repetition("panoramas, of all tasks and cells", seen, panoramas),
        Repetition("views, of all panoramas", panoramas * sides, views),
        Repetition("patches, of all pixels", views * height * width, len(index.patches.index)),
        Repetition("pooled cells", cells, len(index.cell_rows)),
        Repetition("cells of the second convolution", cells, len(index.windows)),
    )
