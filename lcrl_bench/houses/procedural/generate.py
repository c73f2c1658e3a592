"""`generate_house`: from a seed to a valid furnished house."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from lcrl_bench.errors import LcrlError, UsageError
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.procedural.floorplan import draw_floorplan
from lcrl_bench.houses.procedural.furnish import furnish
from lcrl_bench.houses.procedural.hangings import Box, Hung, hang
from lcrl_bench.houses.procedural.lattice import yaw_of
from lcrl_bench.houses.procedural.openings import Shell, build_shell
from lcrl_bench.houses.procedural.program import FEWEST, MOST
from lcrl_bench.houses.procedural.roomfloor import Piece, RoomFloor
from lcrl_bench.houses.procedural.surfaces import set_out
from lcrl_bench.houses.procedural.walkability import faults
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.names import check_name

ATTEMPTS: Final = 12
"""Maximum number of attempts per seed."""
ROOM_SHARES: Final = (0.22, 0.3, 0.28, 0.2)
"""Share of houses with 4, 5, 6 and 7 rooms."""


def house_id(seed: int) -> str:
    """The id of the house of a seed: `procedural-7`."""
    return f"procedural-{seed}"


def generate_house(seed: int, *, rooms: int | None = None, id: str | None = None) -> House:
    """Generate a house from a seed, deterministically.

    Args:
        seed: Any non-negative integer.
        rooms: Number of rooms, 4 to 7; drawn if None.
        id: The house's id; `procedural-<seed>` if None.

    Raises:
        UsageError: If `seed` is negative or `rooms` is not 4 to 7.
        InvalidNameError: If `id` is not a valid name.
        LcrlError: If no house could be finished (not seen in practice).

    Example:
        >>> lcrl_bench.generate_house(7, rooms=4).id
        'procedural-7'
    """
    if seed < 0:
        raise UsageError(f"The seed {seed} is negative; use a non-negative integer.")
    if rooms is not None and not FEWEST <= rooms <= MOST:
        raise UsageError(f"A house of {rooms} rooms can't be built; use {FEWEST} to {MOST}.")
    name = check_name("house", house_id(seed) if id is None else id)
    reasons: list[str] = []
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, 0 if rooms is None else rooms, attempt])
        count = rooms or FEWEST + int(rng.choice(len(ROOM_SHARES), p=ROOM_SHARES))
        shell = build_shell(draw_floorplan(count, rng), rng)
        floors, missing = furnish(shell, rng)
        if missing:
            reasons = [f"{missing} pieces of furniture could not be placed"]
            continue
        house = _assemble(name, seed, shell, floors, rng)
        reasons = faults(house)
        if not reasons:
            validate_house(house)
            return house
    raise LcrlError(f"Seed {seed} gives no valid house: {reasons[0]}.")


def _assemble(
    name: str,
    seed: int,
    shell: Shell,
    floors: tuple[RoomFloor, ...],
    rng: np.random.Generator,
) -> House:
    counts: dict[str, int] = {}
    furniture, on_walls = [], []
    hung: dict[str, list[Box]] = {}
    for room in floors:
        furniture += [_furniture(piece, room.name, counts) for piece in room.pieces]
    for room in floors:
        things = hang(room, rng)
        hung[room.name] = [thing.box for thing in things]
        on_walls += [_hung(thing, room.name, counts) for thing in things]
    standing = set_out(floors, furniture, hung, counts, rng)
    return House(
        id=name,
        source="procedural",
        rooms=shell.rooms,
        walls=shell.walls,
        objects=(*furniture, *on_walls, *standing),
        height=shell.height,
        provenance={"seed": str(seed)},
    )


def _number(label: str, counts: dict[str, int]) -> str:
    counts[label] = counts.get(label, 0) + 1
    return f"{label.replace('_', '-')}-{counts[label]}"


def _furniture(piece: Piece, room: str, counts: dict[str, int]) -> PlacedObject:
    return PlacedObject(
        id=_number(piece.label, counts),
        label=piece.label,
        room=room,
        position=(*piece.center, piece.size[2] / 2),
        size=piece.size,
        yaw=math.remainder(yaw_of(piece.quarter) + piece.turn, math.tau),
        shape=piece.shape,
        source_label="" if piece.kind == piece.label else piece.kind,
    )


def _hung(thing: Hung, room: str, counts: dict[str, int]) -> PlacedObject:
    return PlacedObject(
        id=_number(thing.label, counts),
        label=thing.label,
        room=room,
        position=(*thing.center, thing.base + thing.size[2] / 2),
        size=thing.size,
        yaw=yaw_of(thing.quarter),
        shape=thing.shape,
        source_label="" if thing.kind == thing.label else thing.kind,
    )
