"""The room program: which rooms a house has, and how large they should be."""

from __future__ import annotations

from typing import Final

import numpy as np

from lcrl_bench.houses.house import RoomType
from lcrl_bench.houses.procedural.lattice import CELL
from lcrl_bench.houses.procedural.recipes import room_recipes

ALWAYS: Final[tuple[RoomType, ...]] = (
    RoomType.KITCHEN,
    RoomType.LIVING_ROOM,
    RoomType.BEDROOM,
    RoomType.BATHROOM,
)
EXTRA: Final[dict[RoomType, tuple[float, int]]] = {
    RoomType.BEDROOM: (0.50, 2),
    RoomType.HALLWAY: (0.18, 1),
    RoomType.BATHROOM: (0.80, 1),
    RoomType.OFFICE: (0.14, 1),
    RoomType.DINING_ROOM: (0.12, 1),
}
"""Weight of each optional room type, and how many more of it a house may have."""
FEWEST: Final = 4
MOST: Final = 7


def draw_program(rooms: int, rng: np.random.Generator) -> tuple[RoomType, ...]:
    """The types of `rooms` rooms: kitchen, living room, bedroom, bathroom and others."""
    types: list[RoomType] = list(ALWAYS)
    while len(types) < rooms:
        left = {
            room_type: weight
            for room_type, (weight, most) in EXTRA.items()
            if types.count(room_type) - ALWAYS.count(room_type) < most
        }
        # Homes don't get a second bathroom before a second bedroom.
        if types.count(RoomType.BEDROOM) < 2:
            left.pop(RoomType.BATHROOM, None)
        weights = np.array(list(left.values()))
        choice = rng.choice(len(weights), p=weights / weights.sum())
        types.append(list(left)[int(choice)])
    return tuple(types)


def draw_areas(types: tuple[RoomType, ...], rng: np.random.Generator) -> tuple[float, ...]:
    """The target area of each room in cells, uniform in its range."""
    areas = []
    for room_type in types:
        low, high = room_recipes()[room_type].area
        share = rng.beta(0.45, 0.6)
        areas.append((low + share * (high - low)) / CELL**2)
    return tuple(areas)
