"""`PanoramaRenderer`: the interface that turns a house's surfaces into panoramas.

A panorama is uint8[4, height, width] of class ids: the views N, E, S, W in the house frame from
one standing point, with a pinhole camera at eye height (paper, appendix "Observation Caching": it
depends on the position and the arrangement, not on the heading).
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from functools import cached_property
from types import TracebackType
from typing import ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.houses.house import PlacedObject
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.panoramas.camera import VIEWS, eye_positions
from lcrl_bench.scenes.panoramas.footprint import covered_pixels
from lcrl_bench.scenes.panoramas.layers import Composition, Layer, StillHouse
from lcrl_bench.scenes.panoramas.merged import MergedMesh, merge_surfaces
from lcrl_bench.scenes.panoramas.occlusion import Occluders, find_occluders
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import Semantics

RENDERER_VERSION: Final = 1
"""Incremented whenever the same surfaces may give other pixels, to invalidate stored views."""

Change = tuple[NDArray[np.int64], NDArray[np.uint8]]
"""Which panoramas an arrangement changes, [changed], and those, [changed, 4, height, width]."""

_SECONDS: Final = 1.0
_WARM: Final = 16


class PanoramaRenderer(ABC):
    """Renders panoramas of one house; a context manager, as it may hold a drawing context."""

    backend: ClassVar[str]
    """`"gl"`, `"rays"` or `"warp"`."""

    def __init__(
        self, surfaces: Sequence[Surface], semantics: Semantics, movable: Sequence[PlacedObject]
    ) -> None:
        """Merge the surfaces.

        Args:
            surfaces: Everything in the house, each object at its original place.
            semantics: Eye height, pitch, field of view and size of a view.
            movable: The objects an arrangement may hide or move, at their original places.
        """
        self.semantics = semantics
        self.movable = {thing.id: thing for thing in movable}
        self.meshes: tuple[MergedMesh, ...] = merge_surfaces(surfaces, self.movable)

    def render(
        self, points: NDArray[np.float64], arrangement: Arrangement = AS_FOUND
    ) -> NDArray[np.uint8]:
        """The panoramas from some standing points.

        Args:
            points: [point, 2] metres, house frame.
            arrangement: Which movable object is away from its place, and where it is now.

        Returns:
            [point, 4, height, width] class ids 0..60 (0 is empty), views N, E, S, W, row 0 at the
            top.

        Raises:
            UsageError: If `points` is not an array of finite [point, 2], or the arrangement
                places another object than it hides.
            UnknownNameError: If the arrangement hides an object that is not movable.
        """
        eyes = _checked(points)
        self._check(arrangement)
        return self._draw(eyes, arrangement)

    def render_arrangements(
        self, points: NDArray[np.float64], arrangements: Sequence[Arrangement]
    ) -> Iterator[NDArray[np.uint8]]:
        """`render` for each arrangement in turn, drawing only what it may change.

        Arguments and errors as in `render`; yields [point, 4, height, width] per arrangement.
        """
        changes = self.changes(points, arrangements)
        _, found = next(changes)
        for changed, views in changes:
            panoramas = found.copy()
            panoramas[changed] = views
            yield panoramas

    def changes(
        self, points: NDArray[np.float64], arrangements: Sequence[Arrangement]
    ) -> Iterator[Change]:
        """The original panoramas, then for each arrangement in turn those that differ from them.

        Arguments and errors as in `render`. Some may be among the changed that don't differ.
        """
        eyes = _checked(points)
        for arrangement in arrangements:
            self._check(arrangement)
        return self._changes(eyes, arrangements)

    def _changes(
        self, points: NDArray[np.float64], arrangements: Sequence[Arrangement]
    ) -> Iterator[Change]:
        """`changes` with checked arguments."""
        eyes = eye_positions(points, self.semantics)
        shape = (-1, VIEWS, self.semantics.view_height, self.semantics.view_width)
        still = self._draw_still(eyes)
        layers = {name: self._draw_layer(name, AS_FOUND, eyes, still) for name in self._objects}
        composition = Composition(still.classes, layers)
        yield np.arange(len(points)), composition.found.reshape(shape)
        for arrangement in arrangements:
            hidden, placed = arrangement.hidden, None
            if arrangement.placed is not None and hidden in layers:
                placed = self._draw_layer(hidden, arrangement, eyes, still)
            changed, views = composition.change(hidden, placed)
            yield changed, views.reshape(shape)

    @property
    def _objects(self) -> tuple[str, ...]:
        """Ids of the movable objects; at equal depths, the first is seen."""
        return tuple(dict.fromkeys(mesh.object for mesh in self.meshes if mesh.object is not None))

    @cached_property
    def _occluders(self) -> Occluders:
        return find_occluders(self.meshes)

    @abstractmethod
    def _draw(self, points: NDArray[np.float64], arrangement: Arrangement) -> NDArray[np.uint8]:
        """`render` with checked arguments."""

    @abstractmethod
    def _draw_still(self, eyes: NDArray[np.float64]) -> StillHouse:
        """The panoramas without movable objects, from `eyes` [panorama, 3]."""

    @abstractmethod
    def _draw_layer(
        self,
        name: str,
        arrangement: Arrangement,
        eyes: NDArray[np.float64],
        still: StillHouse,
    ) -> Layer:
        """Where an object, visible in the arrangement, is in front of the still house."""

    def _footprint(
        self,
        vertices: Sequence[NDArray[np.float64]],
        eyes: NDArray[np.float64],
        still: StillHouse,
    ) -> NDArray[np.int64]:
        """The pixels, as in `Layer`, where an object may be in front of the still house."""
        every = np.concatenate(vertices)
        box = np.stack([every.min(axis=0), every.max(axis=0)])
        return covered_pixels(box, eyes, still.depths, self.semantics)

    @abstractmethod
    def close(self) -> None:
        """Release the renderer's resources; it can't render afterwards."""

    def __enter__(self) -> Self:
        """The renderer itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the renderer."""
        self.close()

    def _check(self, arrangement: Arrangement) -> None:
        hidden, placed = arrangement.hidden, arrangement.placed
        if hidden is not None and hidden not in self.movable:
            raise UnknownNameError("movable object", hidden, self.movable)
        if placed is None:
            return
        if placed.id != hidden:
            raise UsageError(
                f"The arrangement places '{placed.id}' but hides {hidden!r}: an object that is "
                "placed must be hidden at its old place."
            )
        found = self.movable[placed.id]
        if (placed.label, placed.size, placed.shape) != (found.label, found.size, found.shape):
            raise UsageError(
                f"'{placed.id}' is placed as a {placed.label} of {placed.size} m, but it was found "
                f"as a {found.label} of {found.size} m: placing may only move and turn an object."
            )


def _checked(points: NDArray[np.float64]) -> NDArray[np.float64]:
    eyes = np.asarray(points, dtype=np.float64)
    if eyes.ndim != 2 or eyes.shape[1] != 2 or not np.isfinite(eyes).all():
        found = f"an array of shape {eyes.shape}"
        raise UsageError(f"Standing points must be finite (x, y) pairs, not {found}.")
    return eyes


def time_panoramas(
    renderer: PanoramaRenderer, points: NDArray[np.float64], *, seconds: float = _SECONDS
) -> float:
    """Render panoramas over and over for a while.

    Args:
        renderer: An open renderer.
        points: [point, 2] metres, at least one: standing points of its house.
        seconds: How long to measure, at least once through all points.

    Returns:
        Milliseconds per panorama, the fastest time through all points: other work on the machine
        only ever adds.
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
