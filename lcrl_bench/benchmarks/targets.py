"""Targets: the rooms, furniture and objects that commands can name, and their goal tiles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.grammar import NAMED_ROOMS, named_classes
from lcrl_bench.houses.house import RoomType
from lcrl_bench.scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class Target:
    """Something a command can name in a house."""

    name: str
    """Class name or room type."""
    instances: tuple[str, ...]
    """Ids of the objects or rooms of that name; any of them counts."""
    is_room: bool
    tiles: NDArray[np.bool_]
    """bool [tile]: whether the agent is at the target."""


def find_targets(scene: Scene) -> dict[str, Target]:
    """All reachable targets of a house by name, in a fixed order."""
    house = scene.house
    targets: dict[str, Target] = {}
    for kind in NAMED_ROOMS:
        tiles = goal_tiles(scene, kind.value)
        if tiles.any():
            rooms = tuple(room.id for room in house.rooms if room.type == kind)
            targets[kind.value] = Target(kind.value, rooms, True, tiles)
    for label in named_classes():
        tiles = goal_tiles(scene, label)
        if tiles.any():
            things = tuple(thing.id for thing in house.objects if thing.label == label)
            targets[label] = Target(label, things, False, tiles)
    return targets


def goal_tiles(scene: Scene, target: str) -> NDArray[np.bool_]:
    """The tiles that fulfil "go to the `target`": bool [tile].

    For a room type, all tiles in any such room; for a class of objects, all tiles with an instance
    within reach.
    """
    house, grid = scene.house, scene.grid
    if target in set(RoomType):
        rooms = [room.id for room in house.rooms if room.type == target]
        return np.isin(np.array(grid.rooms), rooms)
    near = np.zeros(grid.tiles, bool)
    for thing in house.objects:
        if thing.label == target:
            near |= scene.reach(thing)
    return near
