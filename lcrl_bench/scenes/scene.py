"""`Scene`: a house with all that is derived from it once: its meshes and its grid."""

from __future__ import annotations

from dataclasses import dataclass

from lcrl_bench.houses.house import House
from lcrl_bench.scenes.furnishing import house_surfaces
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.scenes.walkable import build_grid
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics


@dataclass(frozen=True, eq=False)
class Scene:
    """A house, what it looks like and where one can walk."""

    house: House
    surfaces: tuple[Surface, ...]
    """The labelled meshes of everything in it."""
    grid: Grid
    semantics: Semantics
    """The constants the grid was derived under."""


def build_scene(house: House, semantics: Semantics = DEFAULT_SEMANTICS) -> Scene:
    """Derive the meshes and the grid of a house.

    Raises:
        InvalidHouseError: If the agent can stand nowhere.
    """
    return Scene(house, house_surfaces(house), build_grid(house, semantics), semantics)
