"""Furniture placement: candidate places and their scores.

A candidate is (x, y, quarter turns); its score has some random noise added. Candidates that meet
the constraints of `RoomFloor` are tried in order of their scores.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import OpeningKind
from lcrl_bench.houses.procedural.lattice import (
    FRONTS,
    WALL,
    Rect,
    Rects,
    any_of,
    as_rects,
    distances,
    local_point,
    overlaps,
)
from lcrl_bench.houses.procedural.recipes import Furniture, Kind
from lcrl_bench.houses.procedural.roomfloor import (
    Piece,
    RoomFloor,
    Side,
    bounds,
    core_size,
    many_bounds,
)

Place = tuple[float, float, int]
Size = tuple[float, float, float]

STEP: Final = 0.125
"""Metres between candidate places along a wall."""
NOISE: Final = 0.7
"""Scale of the noise added to scores."""
FLUSH: Final = 0.012
"""Gap between pieces that stand side by side, in metres."""
UNDER: Final = 0.3
"""Largest share of a seat's depth that goes under a table."""
LOUNGE: Final = 1.3
"""Metres in front of a sofa kept free of dining tables."""
BEFORE_WINDOW: Final = 0.35
"""Metres that furniture in front of a window may rise above its sill."""
TRIES: Final = 14
"""Maximum number of candidates whose walkways are checked."""
NEAR_DOOR: Final = 0.5
"""Distance from a door within which furniture scores less, in metres."""


@dataclass(frozen=True, eq=False)
class Candidates:
    """Candidate places and their scores."""

    places: NDArray[np.float64]
    """[place, 3]: x, y and quarter turns."""
    scores: NDArray[np.float64]
    """[place]."""


def _listed(places: Sequence[Place], scores: Sequence[float]) -> Candidates:
    rows = np.array(places, dtype=np.float64).reshape(-1, 3)
    return Candidates(rows, np.array(scores, dtype=np.float64))


def best_place(
    room: RoomFloor,
    item: Furniture,
    kind: Kind,
    size: Size,
    turn: float,
    parent: Piece | None,
    rng: np.random.Generator,
) -> Place | None:
    """The highest-scoring feasible place; None if there is none."""
    found = _candidates(room, item, size, parent, rng)
    if not found.places.size:
        return None
    rects, zones = many_bounds(size, found.places, turn, kind.front)
    if kind.flat:
        fit = room.holds(rects)
    else:
        ignored = (parent,) if parent and item.place in ("around", "seat", "before") else ()
        fit = room.fits(rects, zones, ignored)
        tall = room.sills + BEFORE_WINDOW < size[2]
        fit &= ~any_of(overlaps(rects, room.windows[tall]))
        if ignored and item.place == "before":
            fit &= _clear_of(rects, ignored[0])
    score = found.scores + NOISE * rng.gumbel(size=len(found.scores))
    score -= 5.0 * (distances(rects, room.thresholds) < NEAR_DOOR).any(1)
    if item.place in ("wall", "corner"):
        score -= 2.0 * any_of(overlaps(rects, as_rects(_seating(room))))
    order = [int(i) for i in np.argsort(-score, kind="stable") if fit[i]]
    if kind.flat:
        chosen = _clearest(room, rects, order, parent)
    else:
        cores, _ = many_bounds(core_size(size, turn), found.places, 0.0, 0.0)
        fine = (i for i in order[:TRIES] if room.walkable(rects[i : i + 1], cores[i : i + 1]))
        chosen = next(fine, None)
    if chosen is None:
        return None
    x, y, quarter = found.places[chosen].tolist()
    return x, y, int(quarter)


def _clearest(room: RoomFloor, rects: Rects, order: list[int], parent: Piece | None) -> int | None:
    """The place for a rug with the fewest pieces of furniture partly on it, and no other rug."""
    rugs = as_rects([piece.rect for piece in room.pieces if piece.flat])
    # Pieces placed after its parent belong to the same group and may stand on it.
    known = next((i for i, piece in enumerate(room.pieces) if piece is parent), len(room.pieces))
    solid = as_rects([piece.rect for piece in room.pieces[:known] if not piece.flat])
    order = [i for i in order if not overlaps(rects[i : i + 1], rugs).any()]
    crowd = overlaps(rects, solid).sum(1)
    return min(order, key=lambda i: int(crowd[i])) if order else None


def _clear_of(rects: Rects, parent: Piece) -> NDArray[np.bool_]:
    return distances(rects, as_rects([parent.rect]))[:, 0] > 0


def _candidates(
    room: RoomFloor,
    item: Furniture,
    size: Size,
    parent: Piece | None,
    rng: np.random.Generator,
) -> Candidates:
    if item.place in ("wall", "row", "corner"):
        return _along_walls(room, item, size, rng)
    if item.place == "facing" and parent is not None:
        return _facing(room, item, size, parent, rng)
    if item.place == "middle" or parent is None:
        return _in_the_middle(room, item, size, rng)
    return _with_parent(item, size, parent, rng)


def _along_walls(
    room: RoomFloor, item: Furniture, size: Size, rng: np.random.Generator
) -> Candidates:
    gap = float(rng.uniform(*item.gap))
    places, scores = [np.zeros((0, 3))], [np.zeros(0)]
    for side in room.sides:
        low, high = side.start + WALL / 2, side.end - WALL / 2
        if high - low < size[0]:
            continue
        along = _marks(room, side, item, size, rng)
        score = _wall_score(room, side, item, size, along)
        inside = (along - size[0] / 2 > low - 1e-6) & (along + size[0] / 2 < high + 1e-6)
        usable = inside & ~_blocked(side, along, size) & np.isfinite(score)
        places.append(_against(side, along[usable], size[1], gap))
        scores.append(score[usable])
    return Candidates(np.concatenate(places), np.concatenate(scores))


def _marks(
    room: RoomFloor, side: Side, item: Furniture, size: Size, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Centres along a side: at regular steps, in its corners, and flush with what stands there."""
    half = size[0] / 2
    low, high = side.start + WALL / 2 + half, side.end - WALL / 2 - half
    steady = np.arange(low + rng.uniform(0.0, STEP), high, STEP)
    snug = 0.012 if item.touch else float(rng.uniform(*item.gap)) + 0.005
    marks = [low + snug, high - snug, (low + high) / 2]
    axis = 1 if side.upright else 0
    for piece in room.pieces:
        if not piece.flat and piece.quarter == side.quarter:
            marks += [piece.rect[axis] - half - FLUSH, piece.rect[axis + 2] + half + FLUSH]
    return np.concatenate([steady, np.array(marks)])


def _against(
    side: Side, along: NDArray[np.float64], depth: float, gap: float
) -> NDArray[np.float64]:
    away = WALL / 2 + gap + depth / 2
    fx, fy = FRONTS[side.quarter]
    line = np.full_like(along, side.line + (fx if side.upright else fy) * away)
    quarters = np.full_like(along, side.quarter)
    x, y = (line, along) if side.upright else (along, line)
    return np.stack([x, y, quarters], axis=1)


def _blocked(side: Side, along: NDArray[np.float64], size: Size) -> NDArray[np.bool_]:
    """[place]: whether it would block a door or rise well above a window's sill."""
    blocked = np.zeros(len(along), dtype=bool)
    for gap in side.gaps:
        if gap.kind is not OpeningKind.WINDOW or size[2] > gap.bottom + BEFORE_WINDOW:
            half = size[0] / 2 + 0.02
            blocked |= (gap.start < along + half) & (along - half < gap.end)
    return blocked


def _wall_score(
    room: RoomFloor, side: Side, item: Furniture, size: Size, along: NDArray[np.float64]
) -> NDArray[np.float64]:
    """[place]: the score; minus infinity where it misses its row or corner."""
    low, high = side.start + WALL / 2, side.end - WALL / 2
    start, end = along - size[0] / 2, along + size[0] / 2
    left, right, touching = _neighbours(room, side, start, end, item.touch)
    snug = np.minimum(start - low, high - end) < 0.12
    score = item.corner * snug
    score = score + item.centre * (1.0 - np.abs(2 * (along - low) / (high - low) - 1.0))
    score += 3.0 * touching
    if item.place == "row":
        score[~touching] = -np.inf
    if item.place == "corner":
        score[~snug] = -np.inf
    # An unusably narrow gap beside it looks odd.
    for gap in (np.minimum(left, start - low), np.minimum(right, high - end)):
        score -= 0.6 * ((gap > 0.06) & (gap < 0.3))
    for gap in side.gaps:
        if gap.kind is OpeningKind.WINDOW:
            shared = np.minimum(gap.end, end) - np.maximum(gap.start, start)
            share = np.maximum(0.0, shared) / (gap.end - gap.start)
            score += (item.window - 1.0 * (size[2] > gap.bottom)) * share
    return score


def _neighbours(
    room: RoomFloor,
    side: Side,
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    touch: tuple[str, ...],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """[place]: metres to the next piece on either side; whether it touches a kind in `touch`."""
    axis, across = (1, 0) if side.upright else (0, 1)
    left, right = np.full(len(start), np.inf), np.full(len(start), np.inf)
    touching = np.zeros(len(start), dtype=bool)
    for piece in room.pieces:
        away = min(abs(piece.rect[across] - side.line), abs(piece.rect[across + 2] - side.line))
        if piece.flat or away > 0.5:
            continue
        before, after = start - piece.rect[axis + 2], piece.rect[axis] - end
        left = np.where(before > -1e-6, np.minimum(left, before), left)
        right = np.where(after > -1e-6, np.minimum(right, after), right)
        if piece.kind in touch or piece.label in touch:
            nearest = np.maximum(before, after)
            touching |= (nearest > -1e-6) & (nearest < 0.05)
    return left, right, touching


def _facing(
    room: RoomFloor,
    item: Furniture,
    size: Size,
    parent: Piece,
    rng: np.random.Generator,
) -> Candidates:
    """Against the wall its parent faces, in line with it."""
    every = _along_walls(room, item.model_copy(update={"gap": (0.01, 0.04)}), size, rng)
    fx, fy = FRONTS[parent.quarter]
    east, north = every.places[:, 0] - parent.center[0], every.places[:, 1] - parent.center[1]
    gap = east * fx + north * fy - parent.size[1] / 2 - size[1] / 2
    aside = np.abs(east * fy) + np.abs(north * fx)
    opposite = every.places[:, 2] == (parent.quarter + 2) % 4
    chosen = opposite & (gap >= item.gap[0]) & (gap <= item.gap[1]) & (aside <= item.along)
    return Candidates(every.places[chosen], (every.scores - 3.0 * aside)[chosen])


def _in_the_middle(
    room: RoomFloor, item: Furniture, size: Size, rng: np.random.Generator
) -> Candidates:
    """Anywhere on the floor, at least `gap[0]` from walls."""
    x0, y0 = room.tiles.min(0) - 0.325
    x1, y1 = room.tiles.max(0) + 0.325
    wanted = float(rng.uniform(*item.gap))
    places, scores = [np.zeros((0, 3))], [np.zeros(0)]
    for quarter in (0, 1):
        w, d = (size[0], size[1]) if quarter == 0 else (size[1], size[0])
        xs = np.arange(x0 + w / 2 + rng.uniform(0, 0.1), x1 - w / 2, 0.15)
        ys = np.arange(y0 + d / 2 + rng.uniform(0, 0.1), y1 - d / 2, 0.15)
        xs = np.append(xs, [x0 + w / 2 + FLUSH, x1 - w / 2 - FLUSH])
        ys = np.append(ys, [y0 + d / 2 + FLUSH, y1 - d / 2 - FLUSH])
        x, y = (grid.ravel() for grid in np.meshgrid(xs, ys, indexing="ij"))
        spots = np.stack([x - w / 2, y - d / 2, x + w / 2, y + d / 2], axis=1)
        walls = distances(spots, room.strips).min(1)
        usable = (walls >= item.gap[0]) & ~((walls > 0.06) & (walls < 0.25))
        usable &= ~any_of(overlaps(spots, as_rects(_seating(room)), 0.3))
        rows = np.stack([x, y, np.full_like(x, quarter)], axis=1)
        places.append(rows[usable])
        scores.append(-2.0 * np.abs(walls - wanted)[usable])
    return Candidates(np.concatenate(places), np.concatenate(scores))


def _seating(room: RoomFloor) -> list[Rect]:
    """The floor in front of each sofa, and all the way to the television it faces."""
    sofas = [piece for piece in room.pieces if piece.label == "sofa"]
    return [bounds(sofa.size, (*sofa.center, sofa.quarter), 0.0, LOUNGE)[1] for sofa in sofas] + [
        (
            min(sofa.rect[0], other.rect[0]),
            min(sofa.rect[1], other.rect[1]),
            max(sofa.rect[2], other.rect[2]),
            max(sofa.rect[3], other.rect[3]),
        )
        for sofa in sofas
        for other in room.pieces
        if other.label in ("sofa", "coffee_table")
        or (other.label == "tv_stand" and other.quarter == (sofa.quarter + 2) % 4)
    ]


def _with_parent(
    item: Furniture, size: Size, parent: Piece, rng: np.random.Generator
) -> Candidates:
    places: list[Place] = []
    width, depth = parent.size[0], parent.size[1]
    for _ in range(4):
        gap = float(rng.uniform(*item.gap))
        shift = float(rng.uniform(-item.along, item.along))
        for x, y, turn in _LOCAL[item.place](width, depth, size, gap, shift):
            px, py = local_point(parent.center, parent.quarter, x, y)
            places.append((px, py, (parent.quarter + turn) % 4))
    return _listed(places, [0.0] * len(places))


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
    """At either end of the coffee table, facing it."""
    x, y = width / 2 + gap * 0.5 + size[1] / 2, depth / 2 + 0.35 + size[0] / 2 + shift
    return [(-x, y, 3), (x, y, 1), (-x + 0.3, y + 0.2, 3), (x - 0.3, y + 0.2, 1)]


def _around(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    """Places for chairs along the four sides of a table, facing it."""
    gap = max(gap, -UNDER * size[1])
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
    gap = max(gap, -UNDER * size[1])
    return [(shift, depth / 2 + gap + size[1] / 2, 2)]


def _under(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    """Extending `gap` beyond the front of its parent; fully under it if `gap` is 0."""
    return [(shift, (depth - size[1]) / 2 + gap if gap else 0.0, 0)]


def _opposite(
    width: float, depth: float, size: Size, gap: float, shift: float
) -> list[tuple[float, float, int]]:
    """In front of its parent and facing it: a sofa in the middle of a room."""
    return [(shift, depth / 2 + gap + size[1] / 2, 2)]


_LOCAL: Final = {
    "beside": _beside,
    "before": _before,
    "flank": _flank,
    "around": _around,
    "seat": _seat,
    "opposite": _opposite,
    "under": _under,
}
