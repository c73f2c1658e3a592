"""Furniture on the floor: each room's recipe is followed piece by piece, group by group.

A group (a bed and its side tables, a table and its chairs) is placed as a whole; of a few tries
the fullest is kept. A room that lacks a required piece is started over.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from lcrl_bench.houses.procedural.openings import Shell
from lcrl_bench.houses.procedural.placement import best_place
from lcrl_bench.houses.procedural.recipes import (
    Furniture,
    Kind,
    draw_count,
    draw_size,
    kinds,
    room_recipes,
)
from lcrl_bench.houses.procedural.roomfloor import Piece, RoomFloor, make_piece, room_floors

ROOM_TRIES: Final = 6
GROUP_TRIES: Final = 5
FEWEST_PIECES: Final = 2
"""Minimum number of pieces of furniture per room."""
SHAPES: Final = 2**31 - 1
"""Upper bound of the shape numbers drawn."""


@dataclass
class Style:
    """What things in one house have in common, such as the chairs of a set."""

    twins: dict[str, tuple[tuple[float, float, float], int]] = field(default_factory=dict)

    def draw(self, name: str, rng: np.random.Generator) -> tuple[tuple[float, float, float], int]:
        """Size and shape of a thing of the kind `name`."""
        kind = kinds()[name]
        shape = int(rng.integers(SHAPES))
        drawn = draw_size(kind, rng), shape if kind.shape is None else kind.shape
        return self.twins.setdefault(name, drawn) if kind.twins else drawn


def furnish(shell: Shell, rng: np.random.Generator) -> tuple[tuple[RoomFloor, ...], int]:
    """Furnish every room of a building.

    Returns:
        The rooms, and how many required pieces are missing (0 for a proper home).
    """
    style = Style()
    rooms = room_floors(shell)
    return rooms, sum(_furnish_room(room, style, rng) for room in rooms)


def _furnish_room(room: RoomFloor, style: Style, rng: np.random.Generator) -> int:
    best: list[Piece] = []
    least = 1_000
    for _ in range(ROOM_TRIES):
        room.pieces = []
        missing = _carry_out(room, style, rng)
        missing += max(0, FEWEST_PIECES - sum(not piece.flat for piece in room.pieces))
        if missing < least:
            best, least = room.pieces, missing
        if least == 0:
            break
    room.pieces = best
    return least


def _carry_out(room: RoomFloor, style: Style, rng: np.random.Generator) -> int:
    missing = 0
    for item in room_recipes()[room.type].furniture:
        there = item.instead and any(piece.kind == item.instead for piece in room.pieces)
        if there or room.area < item.area or rng.random() >= item.chance:
            continue
        for _ in range(draw_count(item.count, rng)):
            placed = _place_group(room, item, None, style, rng)
            missing += item.must and not placed
    return missing


def _place_group(
    room: RoomFloor,
    item: Furniture,
    parent: Piece | None,
    style: Style,
    rng: np.random.Generator,
) -> bool:
    """Place a thing and its companions; return whether the thing itself could be placed."""
    wanted = [
        companion
        for companion in item.companions
        if rng.random() < companion.chance and room.area >= companion.area
        for _ in range(draw_count(companion.count, rng))
    ]
    before, best = list(room.pieces), list(room.pieces)
    for _ in range(GROUP_TRIES if wanted else 1):
        room.pieces = list(before)
        first = _place(room, item, parent, style, rng)
        if first is None:
            break
        placed = [_place_group(room, companion, first, style, rng) for companion in wanted]
        whole = all(done or not c.must for done, c in zip(placed, wanted, strict=True))
        if whole and len(room.pieces) > len(best):
            best = room.pieces
        if all(placed):
            break
    room.pieces = best
    return len(best) > len(before)


def _place(
    room: RoomFloor,
    item: Furniture,
    parent: Piece | None,
    style: Style,
    rng: np.random.Generator,
) -> Piece | None:
    kind = kinds()[item.kind]
    drawn, shape = style.draw(item.kind, rng)
    turn = float(rng.uniform(-kind.turn, kind.turn))
    for shrink in (0.0, 0.6, 1.0):
        size = _shrunk(drawn, kind, shrink, room)
        place = best_place(room, item, kind, size, turn, parent, rng)
        if place is not None:
            piece = make_piece(item.kind, kind, size, place, turn, shape)
            room.pieces.append(piece)
            return piece
        if kind.twins or (shrink == 0.0 and not item.must and item.place == "around"):
            break
    return None


def _shrunk(
    size: tuple[float, float, float], kind: Kind, share: float, room: RoomFloor
) -> tuple[float, float, float]:
    """A size reduced by `share` of the way to the kind's smallest."""
    width = size[0] + share * (min(size[0], kind.width[0]) - size[0])
    depth = size[1] + share * (min(size[1], kind.depth[0]) - size[1])
    height = room.height - kind.headroom if kind.full_height else size[2]
    return round(width, 3), round(depth, 3), round(height, 3)
