"""`Benchmark`: frozen houses, grids and tasks, and the fingerprint that names them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from lcrl_bench.benchmarks.grammar import tokens
from lcrl_bench.benchmarks.observation import resize_views
from lcrl_bench.benchmarks.task import Kind, Split, Task, Tasks
from lcrl_bench.errors import UnknownNameError
from lcrl_bench.houses.document import house_digest
from lcrl_bench.houses.house import House
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.scene import Scene
from lcrl_bench.semantics import Semantics
from lcrl_bench.storage import canonical_json, sha256_of


@dataclass(frozen=True, repr=False)
class Benchmark:
    """Everything a method is trained and tested on.

    Example:
        >>> benchmark = lcrl_bench.load_benchmark("mini")
        >>> len(benchmark.houses), len(benchmark.tasks), len(benchmark.tasks["test-house"])
        (12, 237, 58)
    """

    name: str
    semantics: Semantics
    houses: Mapping[str, House]
    """By id."""
    grids: Mapping[str, Grid]
    """By house id. Frozen with the benchmark, so that tile numbers mean the same everywhere;
    `benchmark check` derives them again from physics."""
    tasks: Tasks
    """In order of ids; `tasks["test-house"]` are those of a split."""
    views: Mapping[str, Path] = field(default_factory=dict)
    """Files of frozen views by house id, if the benchmark ships them. They only save time: they
    hold what rendering gives."""

    def __post_init__(self) -> None:
        """Accept tasks as any sequence."""
        object.__setattr__(self, "tasks", Tasks(self.tasks))

    def __repr__(self) -> str:
        """Name, size and start of the fingerprint."""
        size = f"{len(self.houses)} houses, {len(self.tasks)} tasks"
        return f"Benchmark({self.name}: {size}, fingerprint {self.fingerprint[:12]})"

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 over houses, grids, tasks, vocabulary and semantics; 64 hexadecimal digits."""
        return content_fingerprint(
            self.semantics,
            {key: house_digest(house) for key, house in self.houses.items()},
            {key: canonical_json(grid_to_json(grid)) for key, grid in self.grids.items()},
            canonical_json([task.to_json() for task in self.tasks]),
            self.vocabulary,
        )

    def known_as(self, fingerprint: str) -> Benchmark:
        """Itself, with a fingerprint that was computed elsewhere."""
        vars(self)["fingerprint"] = fingerprint
        return self

    @cached_property
    def vocabulary(self) -> tuple[str, ...]:
        """The words of the training commands, sorted."""
        return vocabulary_of(self.tasks)

    def select(
        self, *, house: str | None = None, split: Split | None = None, kind: Kind | None = None
    ) -> tuple[Task, ...]:
        """The tasks of a house, a split and a kind; None means all."""
        # A house's own tasks, since going through all for each house would take houses squared.
        among = self.tasks if house is None else self._tasks_by_house.get(house, ())
        return tuple(
            task for task in among if split in (None, task.split) and kind in (None, task.kind)
        )

    @cached_property
    def _tasks_by_house(self) -> Mapping[str, Sequence[Task]]:
        found: dict[str, list[Task]] = {}
        for task in self.tasks:
            found.setdefault(task.house, []).append(task)
        return found

    def scene(
        self, house: str, *, renderer: str = "auto", image_size: tuple[int, int] | None = None
    ) -> Scene:
        """A house in MuJoCo, with its frozen grid and views.

        Args:
            house: Its id.
            renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for
                views that are neither frozen nor cached.
            image_size: Width and height of the views in pixels; None means the benchmark's own,
                which alone are frozen with it.

        Raises:
            UnknownNameError: If the benchmark has no such house.
            UsageError: If there can be no views of that size.
        """
        if house not in self.houses:
            raise UnknownNameError("house", house, self.houses)
        semantics = resize_views(self.semantics, image_size)
        return Scene(
            self.houses[house],
            semantics,
            grid=self.grids[house],
            renderer=renderer,
            frozen=self.views.get(house) if semantics == self.semantics else None,
        )

    def houses_of(self, split: Split) -> tuple[str, ...]:
        """Ids of the houses that have tasks in a split, sorted."""
        return tuple(sorted({task.house for task in self.select(split=split)}))


def content_fingerprint(
    semantics: Semantics,
    houses: Mapping[str, str],
    grids: Mapping[str, bytes],
    tasks: bytes,
    vocabulary: Sequence[str],
) -> str:
    """The fingerprint of a benchmark: SHA-256 of its content as canonical JSON.

    Args:
        semantics: Its constants.
        houses: The digest of each house.
        grids: The canonical JSON of each grid, see `grid_to_json`.
        tasks: The canonical JSON of the list of tasks, see `Task.to_json`.
        vocabulary: Its words.
    """
    # Put together by hand, as most of it is JSON already; keys are sorted.
    each = [canonical_json(name) + b":" + grids[name] for name in sorted(grids)]
    return sha256_of(
        b'{"grids":{%b},"houses":%b,"semantics":%b,"tasks":%b,"vocabulary":%b}'
        % (
            b",".join(each),
            canonical_json(houses),
            canonical_json(asdict(semantics)),
            tasks,
            canonical_json(vocabulary),
        )
    )


def vocabulary_of(tasks: Iterable[Task]) -> tuple[str, ...]:
    """The words of the training commands among some tasks, sorted."""
    train = (task.command for task in tasks if task.split == Split.TRAIN)
    return tuple(sorted({word for command in train for word in tokens(command)}))


def grid_to_json(grid: Grid) -> dict[str, Any]:
    """A grid as plain values, without rounding."""
    return {
        "tile": grid.tile,
        "origin": list(grid.origin),
        "cells": grid.cells.tolist(),
        "points": grid.points.tolist(),
        "neighbours": grid.neighbours.tolist(),
        "rooms": list(grid.rooms),
    }
