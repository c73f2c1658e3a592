"""What commands can name in a house: rooms, furniture and objects, and where each is reached."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.grammar import NAMED_ROOMS, named_classes
from lcrl_bench.houses.house import House, PlacedObject, RoomType
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.reach import within_reach
from lcrl_bench.semantics import Semantics


@dataclass(frozen=True, eq=False)
class Target:
    """Something a command can name in a house."""

    name: str
    """Class name or room type."""
    instances: tuple[str, ...]
    """Ids of the objects or rooms meant: all of them count."""
    is_room: bool
    tiles: NDArray[np.bool_]
    """bool [tile]: where the agent is at the target."""


def find_targets(house: House, grid: Grid, semantics: Semantics) -> dict[str, Target]:
    """Every target of a house that can be reached, by name, in a fixed order."""
    targets: dict[str, Target] = {}
    for kind in NAMED_ROOMS:
        rooms = tuple(room.id for room in house.rooms if room.type == kind)
        tiles = np.isin(np.array(grid.rooms), rooms)
        if tiles.any():
            targets[kind.value] = Target(kind.value, rooms, True, tiles)
    for label in named_classes():
        things = [thing for thing in house.objects if thing.label == label]
        tiles = tiles_near(house, grid, things, semantics)
        if tiles.any():
            targets[label] = Target(label, tuple(thing.id for thing in things), False, tiles)
    return targets


def tiles_near(
    house: House, grid: Grid, things: list[PlacedObject], semantics: Semantics
) -> NDArray[np.bool_]:
    """Where any of `things` is within reach: bool [tile]."""
    near = np.zeros(grid.tiles, bool)
    for thing in things:
        near |= within_reach(house, grid, thing, semantics)
    return near


def goal_tiles(house: House, grid: Grid, target: str, semantics: Semantics) -> NDArray[np.bool_]:
    """Where "go to the `target`" is fulfilled: bool [tile].

    A room counts where the agent stands in any room of that type; a class of things where any
    instance is within reach.
    """
    if target in set(RoomType):
        rooms = [room.id for room in house.rooms if room.type == target]
        return np.isin(np.array(grid.rooms), rooms)
    things = [thing for thing in house.objects if thing.label == target]
    return tiles_near(house, grid, things, semantics)
