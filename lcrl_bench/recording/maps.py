"""Maps over a house: one number per tile and per place of the object.

The paper's figures show two of a PICK task's three object states, before and after the object is
taken; in the third, the object at B, a reward on observations pays for success.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from lcrl_bench.benchmarks.task import Kind
from lcrl_bench.houses.house import House
from lcrl_bench.mdp.task_batch import HEADINGS, ObjectState
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.palette import diverging, rising, unit_interval
from lcrl_bench.scenes.grid import Grid

NEAR_AN_END: Final = 0.2
"""Share of a scale that counts as near one of its ends."""


@dataclass(frozen=True, eq=False)
class TileMap:
    """A quantity over the tiles of a house, one layer per object state, on one scale."""

    key: str
    """Identifier: `"reward"`, `"value"`, `"visits"`, `"expert_visits"`."""
    name: str
    """In words."""
    layers: NDArray[np.float64]
    """[object state, tile]."""
    limits: tuple[float, float]
    """Ends of the scale: the smallest and the largest number of all layers."""
    visits: bool = False
    """Whether it counts visits: its scale starts at zero and is stretched at the low end."""
    titles: tuple[str, ...] = ("",)
    """What each layer stands for; one empty title if there is one layer."""

    @staticmethod
    def of(
        key: str, name: str, layers: NDArray[np.float64], titles: tuple[str, ...] = ("",)
    ) -> TileMap:
        """A map whose scale spans all its layers."""
        limits = float(layers.min()), float(layers.max())
        return TileMap(key, name, layers, limits, titles=titles)

    def title(self, layer: int) -> str:
        """Name of a layer: `"value, with the cup in hand"`."""
        return f"{self.name}, {self.titles[layer]}" if self.titles[layer] else self.name

    def colors(self, layer: int) -> NDArray[np.uint8]:
        """The colours of a layer's tiles: uint8 [tile, 3]."""
        return self._color(unit_interval(self.layers[layer], self.limits))

    def signs(self, layer: int) -> dict[str, NDArray[np.bool_]]:
        """Tiles near the ends of the scale: `"+"` and `"-"` → bool [tile].

        Both ends are dark: printed in grey, only a sign tells them apart. Visits need none.
        """
        if self.visits:
            return {}
        shares = unit_interval(self.layers[layer], self.limits)
        return {"+": shares >= 1 - NEAR_AN_END, "-": shares <= NEAR_AN_END}

    def ramp(self, count: int) -> NDArray[np.uint8]:
        """Colours of evenly spaced numbers from one end of the scale to the other.

        Returns:
            uint8 [count, 3].
        """
        return self._color(np.linspace(0.0, 1.0, count))

    def _color(self, shares: NDArray[np.float64]) -> NDArray[np.uint8]:
        # Waiting counts at every step; a linear scale would hide the path there.
        return rising(np.sqrt(shares)) if self.visits else diverging(shares)


def tile_maps(episode: Episode) -> tuple[TileMap, ...]:
    """The maps that explain an episode.

    Of a learned reward: the reward and its value V_0 (best of a tile's four headings). Of a learned
    policy: `visit_maps`.
    """
    if episode.reward is None or episode.value is None:
        return visit_maps(episode)
    best = episode.value.reshape(-1, HEADINGS).max(axis=1)
    named = (("reward", "learned reward", episode.reward), ("value", "value", best))
    shape = (len(episode.parts), episode.scene.grid.tiles)
    titles = layer_titles(episode)
    return tuple(TileMap.of(key, name, array.reshape(shape), titles) for key, name, array in named)


def visit_maps(episode: Episode) -> tuple[TileMap, ...]:
    """Discounted visits of the policy and of the expert, on one scale from zero."""
    named = (
        ("visits", "visits", episode.occupancy),
        ("expert_visits", "expert's visits", episode.expert_occupancy),
    )
    known = [(key, name, array) for key, name, array in named if array is not None]
    most = max((float(array.max()) for _, _, array in known), default=0.0)
    titles = layer_titles(episode)
    shape = (len(episode.parts), episode.scene.grid.tiles)
    return tuple(
        TileMap(key, name, array.reshape(shape), (0.0, most), visits=True, titles=titles)
        for key, name, array in known
    )


def whole_visits(episode: Episode) -> tuple[TileMap, ...]:
    """`visit_maps` summed over object states: one layer each."""
    sums = [(tile_map, tile_map.layers.sum(axis=0)) for tile_map in visit_maps(episode)]
    most = max((float(numbers.max()) for _, numbers in sums), default=0.0)
    return tuple(
        replace(tile_map, layers=numbers[None], limits=(0.0, most), titles=("",))
        for tile_map, numbers in sums
    )


def every_map(episode: Episode) -> tuple[TileMap, ...]:
    """The maps that explain an episode, then its visits if they are not among them."""
    maps = tile_maps(episode)
    shown = {tile_map.key for tile_map in maps}
    return (*maps, *(each for each in visit_maps(episode) if each.key not in shown))


def layer_titles(episode: Episode) -> tuple[str, ...]:
    """A title for each object state: one empty title for NAV."""
    if episode.task.moved is None:
        return ("",)
    thing = episode.scene.house.object(episode.task.moved).label.replace("_", " ")
    titles = {
        ObjectState.AT_A: f"before the {thing} is taken",
        ObjectState.HELD: f"with the {thing} in hand",
        ObjectState.AT_B: f"after the {thing} is put",
    }
    return tuple(titles[part] for part in episode.parts)


def goal_tiles(episode: Episode) -> NDArray[np.bool_]:
    """[tile]: the goal of NAV; for PICK, where the object can be put at B."""
    if episode.task.kind == Kind.NAV:
        return episode.goal
    if episode.near_end is None:
        return np.zeros(episode.scene.grid.tiles, bool)
    return episode.near_end


def take_tiles(episode: Episode) -> NDArray[np.bool_]:
    """[tile]: where the object of PICK can be taken at A; nowhere for NAV."""
    if episode.near_start is None:
        return np.zeros(episode.scene.grid.tiles, bool)
    return episode.near_start


def tile_centers(grid: Grid) -> NDArray[np.float64]:
    """[tile, 2] metres: the centre of each tile's square (the agent may stand beside it)."""
    return np.asarray(grid.origin, np.float64) + grid.cells * np.float64(grid.tile)


def tile_shapes(house: House, grid: Grid) -> tuple[BaseGeometry, ...]:
    """The floor of each tile in metres: the part of its square inside the house.

    A grid is laid so that rooms connect, not so that its squares end at walls.
    """
    floor = shapely.union_all([shapely.Polygon(room.polygon) for room in house.rooms])
    half = grid.tile / 2
    squares = [shapely.box(x - half, y - half, x + half, y + half) for x, y in tile_centers(grid)]
    return tuple(square.intersection(floor) for square in squares)


def rings(shape: BaseGeometry) -> list[NDArray[np.float64]]:
    """The closed border lines of a shape, [point, 2] metres, the first point repeated at the end.

    Outer borders come first; an empty shape has none.
    """
    polygons = [part for part in shapely.get_parts(shape) if isinstance(part, shapely.Polygon)]
    lines = [part.exterior for part in polygons]
    lines += [hole for part in polygons for hole in part.interiors]
    return [np.array(line.coords) for line in lines if not line.is_empty]


def outline(
    shapes: Sequence[BaseGeometry], tiles: NDArray[np.bool_], inset: float = 0.0
) -> list[NDArray[np.float64]]:
    """The border of a set of tiles, as closed lines.

    Args:
        shapes: What `tile_shapes` returned.
        tiles: bool [tile].
        inset: Metres the border is drawn inside the tiles, so that two borders both show.

    Returns:
        [point, 2] metres each.
    """
    chosen = [shape for shape, wanted in zip(shapes, tiles, strict=True) if wanted]
    whole = shapely.union_all(chosen, grid_size=1e-6)
    return rings(whole.buffer(-inset, join_style="mitre") if inset else whole)


@dataclass(frozen=True, eq=False)
class Floor:
    """The tiles of an episode's house and the borders of those that matter, in metres."""

    shapes: tuple[BaseGeometry, ...]
    """The floor of each tile."""
    centers: NDArray[np.float64]
    """[tile, 2]."""
    take: list[NDArray[np.float64]]
    """Closed lines [point, 2] around the tiles of `take_tiles`."""
    goal: list[NDArray[np.float64]]
    """The same of `goal_tiles`; inset less, so that both borders show."""


def episode_floor(episode: Episode) -> Floor:
    """The floor of an episode."""
    grid = episode.scene.grid
    shapes = tile_shapes(episode.scene.house, grid)
    take = outline(shapes, take_tiles(episode), inset=0.07)
    goal = outline(shapes, goal_tiles(episode), inset=0.03)
    return Floor(shapes, tile_centers(grid), take, goal)
