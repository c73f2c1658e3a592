"""`Scene`: a house in MuJoCo, with its model, walkable grid, meshes and panoramas.

Everything is derived on first use, and kept.
"""

# mujoco creates its attributes at run time, where pyright can't see them.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import logging
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.houses.document import house_digest
from lcrl_bench.houses.house import House, PlacedObject, Point
from lcrl_bench.panoramas import Panoramas
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.panoramas import choose_backend, movable_objects, open_renderer
from lcrl_bench.scenes.reach import solid_segments, within_reach
from lcrl_bench.scenes.store import cached_panoramas, load_panoramas, save_panoramas, store_key
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

if TYPE_CHECKING:
    from lcrl_bench.scenes.mujoco_import import mujoco

FROZEN_BACKEND: Final = "gl"
"""The renderer of frozen views: the reference."""

_logger = logging.getLogger(__name__)


class Scene:
    """A house in MuJoCo.

    Example:
        >>> scene = lcrl_bench.Scene(lcrl_bench.generate_house(0))
        >>> scene.model.nbody, scene.grid.tiles
        (74, 112)
    """

    def __init__(
        self,
        house: House,
        semantics: Semantics = DEFAULT_SEMANTICS,
        *,
        grid: Grid | None = None,
        renderer: str = "auto",
        frozen: Path | None = None,
    ) -> None:
        """Store the house; nothing is derived yet.

        Args:
            house: The house.
            semantics: Size and cameras of the agent, side of a tile.
            grid: A grid frozen with a benchmark; None derives it from collision queries.
            renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for
                views that are neither frozen nor cached.
            frozen: A file of frozen views, used with `"auto"` only; a damaged file, or one of
                another house, is skipped with a notice.
        """
        self.house = house
        self.semantics = semantics
        self.renderer = renderer
        self._given_grid = grid
        self._frozen = frozen

    def __repr__(self) -> str:
        """The house's id and size."""
        house = self.house
        return f"Scene({house.id}: {len(house.rooms)} rooms, {len(house.objects)} objects)"

    @cached_property
    def grid(self) -> Grid:
        """The tiles the agent can stand on.

        Raises:
            InvalidHouseError: If it can't stand anywhere.
        """
        if self._given_grid is not None:
            return self._given_grid
        from lcrl_bench.scenes.walkable import build_grid

        return build_grid(self.house, self.semantics)

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The compiled MuJoCo model, with a body per object and the agent with its four cameras.

        Raises:
            InvalidHouseError: If MuJoCo rejects it.
        """
        from lcrl_bench.scenes.mjcf import compile_scene, house_mjcf

        return compile_scene(house_mjcf(self.house, self.semantics))

    @cached_property
    def surfaces(self) -> tuple[Surface, ...]:
        """The labelled meshes of the building and of everything in it."""
        return house_surfaces(self.house)

    def reach(self, thing: PlacedObject | Sequence[Point]) -> NDArray[np.bool_]:
        """Bool [tile]: whether a thing is within reach; see `scenes.reach.within_reach`."""
        return within_reach(self.house, self.grid, thing, self.semantics, walls=self._walls)

    @cached_property
    def _walls(self) -> NDArray[np.float64]:
        return solid_segments(self.house)

    def panoramas(self, arrangements: Sequence[Arrangement] = (AS_FOUND,)) -> Panoramas:
        """The panoramas of every tile in every arrangement: frozen, cached, or rendered now.

        A panorama depends on the tile and on where the moved object is, not on the heading. Its
        index is `arrangement * tiles + tile`.

        Args:
            arrangements: Where the moved object is; by default everything is at its original place.
        """
        if self._frozen is not None and self.renderer == "auto":
            try:
                key = self._key(arrangements, FROZEN_BACKEND)
                return self._named(load_panoramas(self._frozen, key=key))
            except (InvalidFileError, IntegrityError) as error:
                _logger.warning("notice: rendering instead of using frozen views: %s", error)
        return self._cached(arrangements, choose_backend(self.renderer))

    def render(self, arrangements: Sequence[Arrangement], backend: str) -> Panoramas:
        """Render panoramas now, even if they are frozen or cached.

        Args:
            arrangements: As in `panoramas`.
            backend: `"gl"` or `"rays"`.

        Raises:
            EnvironmentMissingError: If the backend can't start here.
        """
        movable = movable_objects(self.house)
        with open_renderer(
            self.surfaces, self.semantics, movable=movable, backend=backend
        ) as camera:
            views = camera.render_arrangements(self.grid.points, arrangements)
            return self._named(Panoramas.build(views))

    def freeze(self, arrangements: Sequence[Arrangement], path: Path) -> Panoramas:
        """Write panoramas of the reference renderer into a file for shipping.

        What it has rendered before, and is in the cache, is taken from there.

        Raises:
            EnvironmentMissingError: If no OpenGL context can be started here.
        """
        panoramas = self._cached(arrangements, FROZEN_BACKEND)
        save_panoramas(path, panoramas, key=self._key(arrangements, FROZEN_BACKEND))
        return panoramas

    def _cached(self, arrangements: Sequence[Arrangement], backend: str) -> Panoramas:
        key = self._key(None, backend)
        found = cached_panoramas(key, arrangements, lambda missing: self.render(missing, backend))
        return self._named(found)

    def _named(self, panoramas: Panoramas) -> Panoramas:
        return Panoramas(panoramas.views, panoramas.panorama_views, self.house.id)

    def _key(self, arrangements: Sequence[Arrangement] | None, backend: str) -> str:
        return store_key(
            house_digest=house_digest(self.house),
            semantics=self.semantics,
            backend=backend,
            points=self.grid.points,
            arrangements=arrangements,
        )
