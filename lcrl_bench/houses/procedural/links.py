"""Which adjacent rooms a door or an opening links: almost always a tree, as in real homes.

Living rooms, kitchens, dining rooms and hallways are linked first; bedrooms and offices open onto
them; bathrooms come last and are never passed through.

Source: shares of links by room pair in published house datasets.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import RoomType

BATH, BED, DINING = RoomType.BATHROOM, RoomType.BEDROOM, RoomType.DINING_ROOM
HALL, KITCHEN, LIVING = RoomType.HALLWAY, RoomType.KITCHEN, RoomType.LIVING_ROOM
OFFICE = RoomType.OFFICE
WEIGHTS: Final[dict[frozenset[RoomType], float]] = {
    frozenset({KITCHEN, LIVING}): 8.0,
    frozenset({KITCHEN, DINING}): 8.0,
    frozenset({DINING, LIVING}): 8.0,
    frozenset({HALL, LIVING}): 9.0,
    frozenset({HALL, BED}): 9.0,
    frozenset({HALL, BATH}): 5.0,
    frozenset({HALL, OFFICE}): 8.0,
    frozenset({HALL, KITCHEN}): 5.0,
    frozenset({HALL, DINING}): 4.0,
    frozenset({LIVING, BED}): 6.0,
    frozenset({LIVING, BATH}): 6.5,
    frozenset({LIVING, OFFICE}): 6.5,
    frozenset({BED, BATH}): 7.5,
    frozenset({BED, OFFICE}): 5.0,
    frozenset({DINING, OFFICE}): 4.0,
    frozenset({DINING, BATH}): 3.0,
    frozenset({DINING, BED}): 3.0,
    frozenset({OFFICE, BATH}): 3.0,
    frozenset({BED}): 2.5,
}
"""Link weights by pair of room types; missing pairs are never linked."""
PUBLIC: Final = frozenset({KITCHEN, LIVING, DINING, HALL})
ENTRANCES: Final = {HALL: 6.0, LIVING: 1.0, KITCHEN: 0.7}
"""Weights of the room types that can have the front door."""
SHORTEST: Final = 3
"""Cells of straight shared wall needed for a door: one for the door and one on either side."""
CYCLES: Final = 0.15
"""Share of houses with one more link than a tree has."""


@dataclass(frozen=True)
class Border:
    """A straight stretch of the lattice between two rooms, or between a room and the outside."""

    low: int
    """Room to the west (or south) of it; -1 is outside."""
    high: int
    """Room to the east (or north) of it; -1 is outside."""
    upright: bool
    """Whether it runs north-south."""
    line: int
    """The lattice line it lies on."""
    start: int
    end: int
    """Its span along that line, in cells."""


@dataclass(frozen=True)
class Link:
    """Two rooms one can walk between, and the border they share there."""

    rooms: tuple[int, int]
    border: Border


def borders(cells: NDArray[np.int64]) -> tuple[Border, ...]:
    """Every straight stretch of wall of a layout."""
    found = []
    for upright in (False, True):
        grid = np.pad(cells.T if upright else cells, 1, constant_values=-1)
        for line in range(grid.shape[0] - 1):
            lower, upper = grid[line, 1:-1], grid[line + 1, 1:-1]
            start = 0
            for cell in range(1, len(lower) + 1):
                ends = cell == len(lower)
                if ends or (lower[cell], upper[cell]) != (lower[start], upper[start]):
                    if lower[start] != upper[start]:
                        a, b = int(lower[start]), int(upper[start])
                        found.append(Border(a, b, upright, line, start, cell))
                    start = cell
    return tuple(found)


def choose_links(
    cells: NDArray[np.int64], types: tuple[RoomType, ...], rng: np.random.Generator
) -> tuple[tuple[Link, ...], float] | None:
    """The links of a layout and their score; None if some room can't be linked."""
    shared: dict[tuple[int, int], Border] = {}
    for border in borders(cells):
        pair = (min(border.low, border.high), max(border.low, border.high))
        if pair[0] < 0 or border.end - border.start < SHORTEST:
            continue
        if pair not in shared or border.end - border.start > shared[pair].end - shared[pair].start:
            shared[pair] = border
    weights = {
        pair: WEIGHTS.get(frozenset({types[pair[0]], types[pair[1]]}), 0.0) + rng.normal(0.0, 0.8)
        for pair in shared
        if frozenset({types[pair[0]], types[pair[1]]}) in WEIGHTS
    }
    chosen = _tree(types, weights)
    if chosen is None:
        return None
    score = sum(weights[pair] for pair in chosen) / len(chosen) - _oddity(types, chosen)
    cycle = [
        pair
        for pair in weights
        if pair not in chosen and types[pair[0]] in PUBLIC and types[pair[1]] in PUBLIC
    ]
    if cycle and rng.random() < CYCLES:
        chosen.append(cycle[0])
    return tuple(Link(pair, shared[pair]) for pair in chosen), score


def _oddity(types: tuple[RoomType, ...], chosen: list[tuple[int, int]]) -> float:
    """Penalty for odd layouts: bathrooms only behind bedrooms, or off unusual rooms."""
    kinds = [{types[a], types[b]} for a, b in chosen]
    private = types.count(BED) > 1 and all(pair == {BATH, BED} for pair in kinds if BATH in pair)
    remote = sum(BATH in pair and not pair & {BED, LIVING} for pair in kinds)
    return 1.5 * private + 2.0 * kinds.count({BED}) + 1.5 * remote


def _tree(
    types: tuple[RoomType, ...], weights: dict[tuple[int, int], float]
) -> list[tuple[int, int]] | None:
    ranks = [0 if t in PUBLIC else 2 if t is BATH else 1 for t in types]
    joined = {types.index(LIVING)}
    chosen: list[tuple[int, int]] = []
    for rank in (0, 1, 2):
        waiting = {room for room in range(len(types)) if ranks[room] == rank} - joined
        while waiting:
            pair = _best(weights, joined, waiting, types)
            if pair is None:
                return None
            chosen.append(pair)
            new = pair[0] if pair[0] in waiting else pair[1]
            waiting.remove(new)
            joined.add(new)
    return chosen


def _best(
    weights: dict[tuple[int, int], float],
    joined: set[int],
    waiting: set[int],
    types: tuple[RoomType, ...],
) -> tuple[int, int] | None:
    best, best_value = None, -np.inf
    for pair, value in weights.items():
        ours = [room for room in pair if room in joined]
        theirs = [room for room in pair if room in waiting]
        passed = len(ours) == 1 and types[ours[0]] is not BATH
        if len(theirs) == 1 and passed and value > best_value:
            best, best_value = pair, value
    return best
