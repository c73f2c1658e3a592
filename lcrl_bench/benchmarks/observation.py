"""What is seen in a house under every arrangement its tasks bring about.

A panorama depends on the tile and on where the moved object is, not on the heading, so a house has
`arrangements x tiles` panoramas, indexed `arrangement * tiles + tile`. Most of their views are
equal and are stored once (paper, appendix "Observation Caching").
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.dynamics import OBJECT_STATES
from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.errors import IntegrityError, InvalidFileError, UsageError
from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.houses.document import house_digest
from lcrl_bench.houses.house import House
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.panoramas import choose_backend, movable_objects, open_renderer
from lcrl_bench.scenes.store import ViewStore, load_or_build, store_key
from lcrl_bench.semantics import Semantics

_logger = logging.getLogger(__name__)


def arrangements_of(tasks: Sequence[Task]) -> tuple[Arrangement, ...]:
    """Every arrangement the tasks of a house bring about, as found first, each once."""
    wanted = [AS_FOUND]
    for task in tasks:
        wanted.extend(_states_of(task)[1:])
    return tuple(dict.fromkeys(wanted))


def _states_of(task: Task) -> tuple[Arrangement, ...]:
    """The arrangement of each object state of a task."""
    if task.kind == Kind.NAV:
        return (AS_FOUND,)
    return AS_FOUND, Arrangement(task.moved), Arrangement(task.moved, task.placement)


def cell_panoramas(
    tasks: Sequence[Task], arrangements: Sequence[Arrangement], tiles: int
) -> NDArray[np.int64]:
    """The panorama seen in each cell of each task; the tasks share a kind.

    Returns:
        int64 [task, cell], with `cell = object_state * tiles + tile`.
    """
    place = {arrangement: index for index, arrangement in enumerate(arrangements)}
    states = OBJECT_STATES if tasks and tasks[0].kind == Kind.PICK else 1
    rows = np.array([[place[a] for a in _states_of(task)] for task in tasks], np.int64)
    rows = rows.reshape(len(tasks), states, 1) * tiles + np.arange(tiles)
    return rows.reshape(len(tasks), states * tiles)


SIDES = range(8, 257, 2)
"""Pixels a side of a view may have: even, as the networks halve it."""


def resize_views(semantics: Semantics, image_size: tuple[int, int] | None) -> Semantics:
    """The same cameras with other pictures.

    The horizontal field of view stays, so the four views still close the circle, and pixels stay
    square: a picture that is taller for its width sees further up and down.

    Args:
        semantics: A benchmark's.
        image_size: Width and height in pixels; None leaves them as they are.

    Raises:
        UsageError: If a side is odd, too short or too long.
    """
    if image_size is None:
        return semantics
    width, height = image_size
    if width not in SIDES or height not in SIDES:
        raise UsageError(
            f"Views of {width} x {height} pixels: each side must be even and within"
            f" {SIDES[0]} .. {SIDES[-1]}. Example: 64 x 64."
        )
    return replace(semantics, view_width=width, view_height=height)


FROZEN_BACKEND = "gl"
"""The renderer of frozen views: the reference."""


def house_views(
    house: House,
    grid: Grid,
    arrangements: Sequence[Arrangement],
    semantics: Semantics,
    *,
    renderer: str = "auto",
    frozen: Path | None = None,
) -> ViewStore:
    """The views of a house: frozen ones, or from the cache, or rendered now.

    Args:
        house: The house.
        grid: Its grid: one panorama a standing point.
        arrangements: In the order of the panoramas.
        semantics: Optics of the camera.
        renderer: `"auto"`, `"gl"` or `"rays"`; frozen views are used with `"auto"` only.
        frozen: A file of frozen views; one that is damaged or of another house is passed over,
            with a notice.
    """
    if frozen is not None and renderer == "auto":
        try:
            key = _key(house, grid, arrangements, semantics, FROZEN_BACKEND)
            return ViewStore.load(frozen, key=key)
        except (InvalidFileError, IntegrityError) as error:
            _logger.warning("notice: rendering instead of using frozen views: %s", error)
    backend = choose_backend(renderer)
    key = _key(house, grid, arrangements, semantics, backend)
    return load_or_build(
        key, lambda: render_views(house, grid, arrangements, semantics, backend=backend)
    )


def render_views(
    house: House,
    grid: Grid,
    arrangements: Sequence[Arrangement],
    semantics: Semantics,
    *,
    backend: str,
) -> ViewStore:
    """Render the views of a house now, whatever is frozen or cached; arguments as `house_views`."""
    camera = open_renderer(
        house_surfaces(house), semantics, movable=movable_objects(house), backend=backend
    )
    with camera:
        return ViewStore.build(camera.render_arrangements(grid.points, arrangements))


def freeze_views(benchmark: Benchmark, house_id: str, path: Path) -> ViewStore:
    """Render the views of a benchmark's house with the reference renderer into a file.

    Raises:
        EnvironmentMissingError: If no OpenGL context can be started here.
    """
    house, grid = benchmark.houses[house_id], benchmark.grids[house_id]
    arrangements = arrangements_of(benchmark.select(house=house_id))
    store = render_views(house, grid, arrangements, benchmark.semantics, backend=FROZEN_BACKEND)
    key = _key(house, grid, arrangements, benchmark.semantics, FROZEN_BACKEND)
    store.save(path, key=key)
    return store


def _key(
    house: House,
    grid: Grid,
    arrangements: Sequence[Arrangement],
    semantics: Semantics,
    backend: str,
) -> str:
    return store_key(
        house_digest=house_digest(house),
        semantics=semantics,
        backend=backend,
        points=grid.points,
        arrangements=arrangements,
    )


def class_pixels(store: ViewStore) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """For each class, how many pixels of it each panorama shows: int64 [panorama]."""
    flat = store.views.reshape(len(store.views), -1)
    for entry in semantic_classes():
        counts = (flat == entry.id).sum(axis=1)
        yield entry.name, counts[store.panorama_views].sum(axis=1)
