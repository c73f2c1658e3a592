"""Where a piece of furniture could stand: candidate places and how much people would like them.

A candidate is (x, y, quarter turns); its liking is a number to which chance adds some noise. The
best candidates that keep the laws of `RoomFloor` are tried in order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from lcrl_bench.houses.house import OpeningKind
from lcrl_bench.houses.procedural.lattice import (
    FRONTS,
    WALL,
    Rects,
    as_rects,
    distances,
    local_point,
    overlaps,
)
from lcrl_bench.houses.procedural.recipes import Furniture, Kind
from lcrl_bench.houses.procedural.roomfloor import Piece, RoomFloor, Side, bounds

Place = tuple[float, float, int]
Size = tuple[float, float, float]

STEP: Final = 0.125
"""Metres between candidate places along a wall."""
NOISE: Final = 0.7
"""How far chance moves a liking."""
TRIES: Final = 14
"""Most candidates whose walkways are checked."""
NEAR_DOOR: Final = 0.5
"""Metres from a door within which furniture is disliked."""


@dataclass(frozen=True)
class Candidates:
    """Places and the liking of each."""

    places: list[Place]
    likings: list[float]

    def add(self, place: Place, liking: float) -> None:
        """Append one."""
        self.places.append(place)
        self.likings.append(liking)


def best_place(
    room: RoomFloor,
    item: Furniture,
    kind: Kind,
    size: Size,
    turn: float,
    parent: Piece | None,
    rng: np.random.Generator,
) -> Place | None:
    """The place most liked of those that keep every law; None if there is none."""
    found = _candidates(room, item, kind, size, parent, rng)
    if not found.places:
        return None
    both = [bounds(size, place, turn, kind.front) for place in found.places]
    rects, zones = as_rects([rect for rect, _ in both]), as_rects([zone for _, zone in both])
    if kind.flat:
        fit = room.holds(rects)
    else:
        ignored = (parent,) if parent and item.place in ("around", "seat", "before") else ()
        fit = room.fits(rects, zones, ignored)
        if ignored and item.place == "before":
            fit &= _clear_of(rects, ignored[0])
    liking = np.array(found.likings) + NOISE * rng.gumbel(size=len(found.likings))
    liking -= 1.2 * (distances(rects, room.thresholds) < NEAR_DOOR).any(1)
    order = [int(i) for i in np.argsort(-liking, kind="stable") if fit[i]]
    if kind.flat:
        return _clearest(room, rects, order, found.places, parent)
    for i in order[:TRIES]:
        if room.walkable(rects[i : i + 1]):
            return found.places[i]
    return None


def _clearest(
    room: RoomFloor, rects: Rects, order: list[int], places: list[Place], parent: Piece | None
) -> Place | None:
    """Of the places for a rug, one with the least furniture half on it, and no other rug."""
    rugs = as_rects([piece.rect for piece in room.pieces if piece.flat])
    solid = as_rects([p.rect for p in room.pieces if not p.flat and p is not parent])
    order = [i for i in order if not overlaps(rects[i : i + 1], rugs).any()]
    crowd = overlaps(rects, solid).sum(1)
    return places[min(order, key=lambda i: int(crowd[i]))] if order else None


def _clear_of(rects: Rects, parent: Piece) -> np.ndarray:
    return distances(rects, as_rects([parent.rect]))[:, 0] > 0


def _candidates(
    room: RoomFloor,
    item: Furniture,
    kind: Kind,
    size: Size,
    parent: Piece | None,
    rng: np.random.Generator,
) -> Candidates:
    if item.place == "wall":
        return _along_walls(room, item, kind, size, rng)
    if item.place == "facing" and parent is not None:
        return _facing(room, item, kind, size, parent, rng)
    if item.place == "middle" or parent is None:
        return _in_the_middle(room, item, size, rng)
    return _with_parent(item, size, parent, rng)


def _along_walls(
    room: RoomFloor, item: Furniture, kind: Kind, size: Size, rng: np.random.Generator
) -> Candidates:
    found = Candidates([], [])
    gap = rng.uniform(*item.gap)
    for side in room.sides:
        low, high = side.start + WALL / 2, side.end - WALL / 2
        if high - low < size[0]:
            continue
        marks = _marks(room, side, item, size, rng)
        for along in marks:
            if not low - 1e-6 <= along - size[0] / 2 <= along + size[0] / 2 <= high + 1e-6:
                continue
            if _blocked(side, along, size):
                continue
            place = _against(side, along, size[1], gap)
            found.add(place, _wall_liking(room, side, item, size, along))
    return found


def _marks(
    room: RoomFloor, side: Side, item: Furniture, size: Size, rng: np.random.Generator
) -> list[float]:
    """Middles along a side: at a steady step, in its corners, and flush to what stands there."""
    half = size[0] / 2
    low, high = side.start + WALL / 2 + half, side.end - WALL / 2 - half
    marks = np.arange(low + rng.uniform(0.0, STEP), high, STEP).tolist()
    snug = 0.012 if item.touch else float(rng.uniform(*item.gap)) + 0.005
    marks += [low + snug, high - snug, (low + high) / 2]
    axis = 1 if side.upright else 0
    for piece in room.pieces:
        if not piece.flat and piece.quarter == side.quarter:
            marks += [piece.rect[axis] - half - 0.012, piece.rect[axis + 2] + half + 0.012]
    return marks


def _against(side: Side, along: float, depth: float, gap: float) -> Place:
    away = WALL / 2 + gap + depth / 2
    fx, fy = FRONTS[side.quarter]
    if side.upright:
        return side.line + fx * away, along, side.quarter
    return along, side.line + fy * away, side.quarter


def _blocked(side: Side, along: float, size: Size) -> bool:
    """Whether it would stand in a door or well above a window's sill."""
    for gap in side.gaps:
        if gap.start - 0.02 < along + size[0] / 2 and along - size[0] / 2 < gap.end + 0.02:
            if gap.kind is not OpeningKind.WINDOW or size[2] > gap.bottom + 0.35:
                return True
    return False


def _wall_liking(room: RoomFloor, side: Side, item: Furniture, size: Size, along: float) -> float:
    low, high = side.start + WALL / 2, side.end - WALL / 2
    left, right = along - size[0] / 2 - low, high - along - size[0] / 2
    nearest, touching = _neighbours(room, side, along, size, item.touch)
    left, right = min(left, nearest[0]), min(right, nearest[1])
    liking = 0.0
    in_corner = min(along - size[0] / 2 - low, high - along - size[0] / 2) < 0.12
    liking += item.corner * in_corner
    middle = 1.0 - abs(2 * (along - low) / (high - low) - 1.0)
    liking += item.centre * middle
    liking += 3.0 * touching
    # A gap too narrow to use beside it looks odd.
    liking -= 0.6 * sum(0.06 < gap < 0.3 for gap in (left, right))
    for gap in side.gaps:
        if gap.kind is OpeningKind.WINDOW:
            shared = min(gap.end, along + size[0] / 2) - max(gap.start, along - size[0] / 2)
            above = size[2] > gap.bottom
            liking += (item.window - 1.0 * above) * max(0.0, shared) / (gap.end - gap.start)
    return liking


def _neighbours(
    room: RoomFloor, side: Side, along: float, size: Size, touch: tuple[str, ...]
) -> tuple[tuple[float, float], bool]:
    """Free metres to the next piece along a wall on either side, and whether it touches a friend."""
    axis, across = (1, 0) if side.upright else (0, 1)
    left = right = math.inf
    touching = False
    for piece in room.pieces:
        away = min(abs(piece.rect[across] - side.line), abs(piece.rect[across + 2] - side.line))
        if piece.flat or away > 0.5:
            continue
        before = along - size[0] / 2 - piece.rect[axis + 2]
        after = piece.rect[axis] - along - size[0] / 2
        if before > -1e-6:
            left = min(left, before)
        if after > -1e-6:
            right = min(right, after)
        friend = piece.kind in touch or piece.label in touch
        touching |= friend and -1e-6 < max(before, after) < 0.05
    return (left, right), touching


def _facing(
    room: RoomFloor,
    item: Furniture,
    kind: Kind,
    size: Size,
    parent: Piece,
    rng: np.random.Generator,
) -> Candidates:
    """Against the wall its parent looks at, in line with it."""
    every = _along_walls(room, item.model_copy(update={"gap": (0.01, 0.04)}), kind, size, rng)
    found = Candidates([], [])
    fx, fy = FRONTS[parent.quarter]
    for (x, y, quarter), liking in zip(every.places, every.likings, strict=True):
        if quarter != (parent.quarter + 2) % 4:
            continue
        ahead = (x - parent.center[0]) * fx + (y - parent.center[1]) * fy
        aside = abs((x - parent.center[0]) * fy) + abs((y - parent.center[1]) * fx)
        gap = ahead - parent.size[1] / 2 - size[1] / 2
        if item.gap[0] <= gap <= item.gap[1] and aside <= item.along:
            found.add((x, y, quarter), liking - 3.0 * aside)
    return found


def _in_the_middle(
    room: RoomFloor, item: Furniture, size: Size, rng: np.random.Generator
) -> Candidates:
    """Anywhere on the floor, at least `gap[0]` from walls."""
    found = Candidates([], [])
    x0, y0 = room.tiles.min(0) - 0.3
    x1, y1 = room.tiles.max(0) + 0.3
    wanted = float(rng.uniform(*item.gap))
    for quarter in range(4) if wanted < 0.2 else (0, 1):
        w, d = (size[0], size[1]) if quarter % 2 == 0 else (size[1], size[0])
        xs = np.arange(x0 + w / 2 + rng.uniform(0, 0.1), x1 - w / 2, 0.15).tolist()
        ys = np.arange(y0 + d / 2 + rng.uniform(0, 0.1), y1 - d / 2, 0.15).tolist()
        xs += [x0 + w / 2 + 0.01, x1 - w / 2 - 0.01]
        ys += [y0 + d / 2 + 0.01, y1 - d / 2 - 0.01]
        spots = as_rects([(x - w / 2, y - d / 2, x + w / 2, y + d / 2) for x in xs for y in ys])
        if not spots.size:
            continue
        walls = distances(spots, room.strips).min(1)
        places = [(x, y, quarter) for x in xs for y in ys]
        for place, wall in zip(places, walls.tolist(), strict=True):
            if wall >= item.gap[0] and not 0.06 < wall < 0.25:
                found.add(place, -2.0 * abs(wall - wanted))
    return found


def _with_parent(
    item: Furniture, size: Size, parent: Piece, rng: np.random.Generator
) -> Candidates:
    found = Candidates([], [])
    width, depth = parent.size[0], parent.size[1]
    for _ in range(4):
        gap = float(rng.uniform(*item.gap))
        shift = float(rng.uniform(-item.along, item.along))
        for x, y, turn in _LOCAL[item.place](width, depth, size, gap, shift):
            px, py = local_point(parent.center, parent.quarter, x, y)
            found.add((px, py, (parent.quarter + turn) % 4), 0.0)
    return found


def _beside(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    x, y = width / 2 + gap + size[0] / 2, (size[1] - depth) / 2 + shift
    return [(-x, y, 0), (x, y, 0)]


def _before(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    return [(shift, depth / 2 + gap + size[1] / 2, 0)]


def _flank(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    """At either end of where the coffee table stands, facing it."""
    x, y = width / 2 + gap * 0.5 + size[1] / 2, depth / 2 + 0.35 + size[0] / 2 + shift
    return [(-x, y, 3), (x, y, 1), (-x + 0.3, y + 0.2, 3), (x - 0.3, y + 0.2, 1)]


def _around(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    """Places for chairs along the four sides of a table, facing it."""
    y, x = depth / 2 + gap + size[1] / 2, width / 2 + gap + size[1] / 2
    seats = 1 if width < 2 * size[0] + 0.25 else 2 if width < 3 * size[0] + 0.5 else 3
    spots: list[tuple[float, float, int]] = []
    for seat in range(seats):
        along = width * ((seat + 0.5) / seats - 0.5) * (0.92 if seats > 1 else 1.0)
        spots += [(along, y, 2), (along, -y, 0)]
    return [*spots, (x, 0.0, 1), (-x, 0.0, 3)]


def _seat(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    return [(shift, depth / 2 + gap + size[1] / 2, 2)]


def _under(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    """Below its parent, or, longer than it is wide, reaching out before it."""
    return [(shift, depth / 2 + size[1] / 2 - 0.35, 0), (shift, 0.0, 0), (shift, depth * 0.2, 0)]


_LOCAL: Final = {
    "beside": _beside,
    "before": _before,
    "flank": _flank,
    "around": _around,
    "seat": _seat,
    "under": _under,
}
