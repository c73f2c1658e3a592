"""Things on walls: pictures, mirrors, cabinets, heaters, televisions and curtains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from lcrl_bench.houses.house import OpeningKind
from lcrl_bench.houses.procedural.furnish import SHAPES
from lcrl_bench.houses.procedural.lattice import FRONTS, WALL, Rect, as_rects, distances
from lcrl_bench.houses.procedural.recipes import (
    Hanging,
    Kind,
    draw,
    draw_count,
    draw_size,
    kinds,
    room_recipes,
)
from lcrl_bench.houses.procedural.roomfloor import Piece, RoomFloor, Side, bounds

Box = tuple[float, float, float, float, float, float]
"""x0, y0, z0, x1, y1, z1 in metres."""
TRIES: Final = 16
OFF_WALL: Final = 0.002
"""Metres between a wall and what hangs on it."""
MARGIN: Final = 0.05
"""Metres kept around doors, windows and other hung things."""
PASSAGE: Final = 0.16
"""Metres from a door within which nothing hangs, on any wall."""
SIGHT: Final = (1.5, 5.0)
"""Shortest and longest distance of a television from the sofa it faces, in metres."""


@dataclass(frozen=True)
class Hung:
    """A thing on a wall."""

    label: str
    kind: str
    size: tuple[float, float, float]
    center: tuple[float, float]
    base: float
    quarter: int
    rect: Rect
    shape: int

    @property
    def box(self) -> Box:
        """Its bounding box."""
        x0, y0, x1, y1 = self.rect
        return x0, y0, self.base, x1, y1, self.base + self.size[2]


def hang(room: RoomFloor, rng: np.random.Generator) -> list[Hung]:
    """Hang a furnished room's curtains and whatever else its recipe names."""
    recipe = room_recipes()[room.type]
    hung: list[Hung] = []
    if rng.random() < recipe.curtains:
        shape = int(rng.integers(SHAPES))
        for side in room.sides:
            for gap in side.gaps:
                if gap.kind is OpeningKind.WINDOW:
                    hung += _curtains(
                        room, side, (gap.start, gap.end), gap.top, gap.bottom, hung, shape, rng
                    )
    for item in recipe.hanging:
        there = item.instead and any(piece.kind == item.instead for piece in room.pieces)
        if there or rng.random() >= item.chance:
            continue
        for _ in range(draw_count(item.count, rng)):
            found = _place(room, item, hung, rng)
            if found is not None:
                hung.append(found)
    return hung


def _place(
    room: RoomFloor, item: Hanging, hung: list[Hung], rng: np.random.Generator
) -> Hung | None:
    kind = kinds()[item.kind]
    size, shape = draw_size(kind, rng), int(rng.integers(SHAPES))
    for side, along, above in _spots(room, item, size, rng)[:TRIES]:
        base = _base(kind, above, rng)
        if above is not None and item.only_over and size[0] > above.size[0]:
            size = (max(round(above.size[0] * 0.98, 3), 0.3), size[1], size[2])
        found = _against(side, along, item.kind, kind, size, base, shape)
        if _is_clear(room, side, found, hung):
            return found
    return None


def _base(kind: Kind, above: Piece | None, rng: np.random.Generator) -> float:
    base = draw(kind.base, rng)
    return round(base if above is None else max(base, above.size[2] + 0.1), 3)


def _spots(
    room: RoomFloor, item: Hanging, size: tuple[float, float, float], rng: np.random.Generator
) -> list[tuple[Side, float, Piece | None]]:
    """Candidate places along walls, best first."""
    wanted: list[tuple[Side, float, Piece | None]] = []
    others: list[tuple[Side, float, Piece | None]] = []
    for side in room.sides:
        axis = 1 if side.upright else 0
        for piece in room.pieces:
            if (piece.kind in item.over or piece.label in item.over) and _backs(piece, side):
                wanted.append((side, piece.center[axis], piece))
            if piece.kind == item.opposite and _watches(piece, side):
                middle = piece.center[axis]
                wanted += [(side, middle + shift, None) for shift in (0.0, -0.3, 0.3)]
        if item.exterior and side.exterior:
            wanted += [
                (side, (gap.start + gap.end) / 2, None)
                for gap in side.gaps
                if gap.kind is OpeningKind.WINDOW
            ]
        low, high = side.start + WALL / 2 + size[0] / 2, side.end - WALL / 2 - size[0] / 2
        if high > low:
            others += [(side, float(along), None) for along in rng.uniform(low, high, size=3)]
    shuffled = [wanted[i] for i in rng.permutation(len(wanted))]
    if item.only_over or item.opposite:
        return shuffled
    return shuffled + [others[i] for i in rng.permutation(len(others))]


def _backs(piece: Piece, side: Side) -> bool:
    """Whether a piece stands with its back to a side."""
    axis, across = (1, 0) if side.upright else (0, 1)
    away = abs(piece.center[across] - side.line) - piece.size[1] / 2
    return (
        piece.quarter == side.quarter and away < 0.35 and side.start < piece.center[axis] < side.end
    )


def _watches(piece: Piece, side: Side) -> bool:
    """Whether a piece faces a side from a distance within `SIGHT`."""
    axis, across = (1, 0) if side.upright else (0, 1)
    ahead = (side.line - piece.center[across]) * FRONTS[piece.quarter][across]
    facing = piece.quarter == (side.quarter + 2) % 4
    return facing and SIGHT[0] < ahead < SIGHT[1] and side.start < piece.center[axis] < side.end


def _against(
    side: Side,
    along: float,
    name: str,
    kind: Kind,
    size: tuple[float, float, float],
    base: float,
    shape: int,
) -> Hung:
    away = WALL / 2 + OFF_WALL + size[1] / 2
    fx, fy = FRONTS[side.quarter]
    x, y = (side.line + fx * away, along) if side.upright else (along, side.line + fy * away)
    center = round(x, 4), round(y, 4)
    rect, _ = bounds(size, (*center, side.quarter), 0.0, 0.0)
    return Hung(kind.label, name, size, center, base, side.quarter, rect, shape)


def _is_clear(room: RoomFloor, side: Side, found: Hung, hung: list[Hung]) -> bool:
    axis = 1 if side.upright else 0
    start, end = found.rect[axis], found.rect[axis + 2]
    if start < side.start + WALL / 2 or end > side.end - WALL / 2:
        return False
    x0, y0, z0, x1, y1, z1 = found.box
    if z1 > room.height - 0.03:
        return False
    beside_door = bool((distances(as_rects([found.rect]), room.thresholds) < PASSAGE).any())
    if beside_door and found.label != "curtain":
        return False
    for gap in side.gaps:
        beside = start < gap.end + MARGIN and end > gap.start - MARGIN
        level = z0 < gap.top + MARGIN and z1 > gap.bottom - MARGIN
        if beside and level and found.label != "curtain":
            return False
        if beside and gap.kind is not OpeningKind.WINDOW and z0 < gap.top + MARGIN:
            return False
    boxes = [other.box for other in hung]
    boxes += [(p.rect[0], p.rect[1], 0.0, p.rect[2], p.rect[3], p.size[2]) for p in room.pieces]
    return not any(_meet((x0, y0, z0, x1, y1, z1), box) for box in boxes)


def _meet(a: Box, b: Box) -> bool:
    gap = 0.015
    return all(a[i] < b[i + 3] + gap and b[i] < a[i + 3] + gap for i in range(3))


def _curtains(
    room: RoomFloor,
    side: Side,
    span: tuple[float, float],
    top: float,
    sill: float,
    hung: list[Hung],
    shape: int,
    rng: np.random.Generator,
) -> list[Hung]:
    """A drawn-back curtain on either side of a window, down to the floor where it is free."""
    kind = kinds()["curtain"]
    width, depth, _ = draw_size(kind, rng)
    rail = round(min(top + float(rng.uniform(0.08, 0.2)), room.height - 0.05), 3)
    long, short = round(draw(kind.base, rng), 3), round(sill - 0.12, 3)
    middles = (span[0] - 0.3 * width, span[1] + 0.3 * width)
    for base in (long, short):
        size = (width, depth, round(rail - base, 3))
        pair = [_against(side, m, "curtain", kind, size, base, shape) for m in middles]
        if all(_is_clear(room, side, panel, hung) for panel in pair):
            return pair
    return []
