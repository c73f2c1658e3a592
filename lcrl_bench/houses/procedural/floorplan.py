"""Floor plans: which lattice cell belongs to which room, and which rooms are linked.

A rectangle is sliced recursively until each piece is a room; then corners of rooms are given to
their neighbours or left out of the house, which makes some rooms, and some houses, L-shaped. Of
several feasible layouts, the one whose rooms are connected most like those of real homes is taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from lcrl_bench.errors import LcrlError
from lcrl_bench.houses.house import RoomType
from lcrl_bench.houses.procedural.lattice import CELL
from lcrl_bench.houses.procedural.links import ENTRANCES, SHORTEST, Link, borders, choose_links
from lcrl_bench.houses.procedural.program import draw_areas, draw_program
from lcrl_bench.houses.procedural.recipes import room_recipes

ATTEMPTS: Final = 1_500
"""Maximum number of layouts tried per house."""
CUTS: Final = 3
"""Cuts tried before part of a layout is given up."""
CARVINGS: Final = 40
"""Corners tried for each further L-shaped room."""
GOOD: Final = 5
"""Number of feasible layouts of which the best is taken."""
OUTSIDE: Final = -1

Box = tuple[int, int, int, int]
"""x0, y0, x1, y1 in cells."""
Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """Rooms on the lattice and the links between them."""

    cells: Cells
    """[row (north), column (east)]: index of the room, -1 outside."""
    types: tuple[RoomType, ...]
    links: tuple[Link, ...]


def draw_floorplan(rooms: int, rng: np.random.Generator) -> FloorPlan:
    """A layout of `rooms` rooms.

    Raises:
        LcrlError: If none of `ATTEMPTS` layouts is feasible (not seen in practice).
    """
    best: FloorPlan | None = None
    best_score, good = -math.inf, 0
    for _ in range(ATTEMPTS):
        types = draw_program(rooms, rng)
        cells = _slice_house(types, rng)
        if cells is None:
            continue
        cells = _cropped(_carve(cells, types, rng))
        found = choose_links(cells, types, rng) if _has_entrance(cells, types) else None
        if found is None:
            continue
        links, score = found
        good += 1
        if score > best_score:
            best, best_score = FloorPlan(cells, types, links), score
        if good >= GOOD:
            break
    if best is None:
        raise LcrlError(f"No layout of {rooms} rooms was found; take another seed.")
    return best


def _has_entrance(cells: Cells, types: tuple[RoomType, ...]) -> bool:
    """Whether a room that can have the front door has an outside wall long enough for it."""
    return any(
        border.end - border.start >= SHORTEST
        and min(border.low, border.high) == OUTSIDE
        and types[max(border.low, border.high)] in ENTRANCES
        for border in borders(cells)
    )


def _slice_house(types: tuple[RoomType, ...], rng: np.random.Generator) -> Cells | None:
    areas = draw_areas(types, rng)
    total, aspect = sum(areas), rng.uniform(1.0, 1.55)
    width = round(math.sqrt(total * aspect))
    height = round(total / width)
    if rng.random() < 0.5:
        width, height = height, width
    boxes = _slice((0, 0, width, height), tuple(range(len(types))), types, areas, rng)
    if boxes is None:
        return None
    cells = np.full((height, width), OUTSIDE, dtype=np.int64)
    for room, (x0, y0, x1, y1) in boxes.items():
        cells[y0:y1, x0:x1] = room
    return cells


def _slice(
    box: Box,
    rooms: tuple[int, ...],
    types: tuple[RoomType, ...],
    areas: tuple[float, ...],
    rng: np.random.Generator,
) -> dict[int, Box] | None:
    """Give each of `rooms` its part of `box`; None if no cut tried is feasible."""
    x0, y0, x1, y1 = box
    if len(rooms) == 1:
        return {rooms[0]: box} if _fits(types[rooms[0]], x1 - x0, y1 - y0) else None
    if min(x1 - x0, y1 - y0) < 2:
        return None
    for _ in range(CUTS):
        order = [rooms[i] for i in rng.permutation(len(rooms))]
        parts = int(rng.integers(1, len(order)))
        first, second = tuple(order[:parts]), tuple(order[parts:])
        share = sum(areas[r] for r in first) / sum(areas[r] for r in order)
        if (x1 - x0) * rng.uniform(0.7, 1.4) > (y1 - y0):
            cut = x0 + round((x1 - x0) * share)
            halves: tuple[Box, Box] = (x0, y0, cut, y1), (cut, y0, x1, y1)
        else:
            cut = y0 + round((y1 - y0) * share)
            halves = (x0, y0, x1, cut), (x0, cut, x1, y1)
        # The smaller group first: it fails sooner.
        (few, small), (many, large) = sorted(
            ((first, halves[0]), (second, halves[1])), key=lambda part: len(part[0])
        )
        found = _slice(small, few, types, areas, rng)
        others = None if found is None else _slice(large, many, types, areas, rng)
        if found is not None and others is not None:
            return found | others
    return None


def _fits(room_type: RoomType, width: int, height: int) -> bool:
    recipe = room_recipes()[room_type]
    low, high = recipe.area
    short, long = min(width, height), max(width, height)
    area = width * height * CELL**2
    return (
        short >= recipe.side and long <= recipe.aspect * short and low - 0.3 <= area <= high + 0.3
    )


def _carve(cells: Cells, types: tuple[RoomType, ...], rng: np.random.Generator) -> Cells:
    """Give corners of rooms to neighbours, or leave them outside, where that is feasible."""
    for _ in range(int(rng.integers(0, 3))):
        for _ in range(CARVINGS // 4):
            carved = _step_back(cells, types, rng)
            if carved is not None:
                cells = carved
                break
    for chance, outer in ((0.5, True), (0.9, False), (0.6, False)):
        if rng.random() < chance:
            for _ in range(CARVINGS):
                carved = _carve_once(cells, types, outer, rng)
                if carved is not None:
                    cells = carved
                    break
    return cells


def _step_back(cells: Cells, types: tuple[RoomType, ...], rng: np.random.Generator) -> Cells | None:
    """Move one outside wall of a room in by a cell or two, so that the house isn't a rectangle."""
    room = int(rng.integers(len(types)))
    # Rotating the lattice makes any side the lower one.
    turns, depth = int(rng.integers(4)), int(rng.integers(1, 3))
    turned = np.rot90(cells, turns).copy()
    rows, columns = np.nonzero(turned == room)
    first, left, right = int(rows.min()), int(columns.min()), int(columns.max()) + 1
    strip = turned[first : first + depth, left:right]
    outside = first == 0 or bool(np.all(turned[first - 1, left:right] == OUTSIDE))
    if not outside or not np.all(strip == room):
        return None
    strip[:] = OUTSIDE
    carved = np.rot90(turned, -turns).copy()
    return carved if _is_roomy(carved, room, types[room]) else None


def _carve_once(
    cells: Cells, types: tuple[RoomType, ...], outer: bool, rng: np.random.Generator
) -> Cells | None:
    room = int(rng.integers(len(types)))
    rows, columns = np.nonzero(cells == room)
    x0, x1 = int(columns.min()), int(columns.max()) + 1
    y0, y1 = int(rows.min()), int(rows.max()) + 1
    wide, high = int(rng.integers(2, 5)), int(rng.integers(2, 5))
    if wide > x1 - x0 - 2 or high > y1 - y0 - 2:
        return None
    left, low = rng.random() < 0.5, rng.random() < 0.5
    bx = x0 if left else x1 - wide
    by = y0 if low else y1 - high
    block = cells[by : by + high, bx : bx + wide]
    if not np.all(block == room):
        return None
    sideways = (bx - 1 if left else bx + wide, slice(by, by + high))
    upright = (slice(bx, bx + wide), by - 1 if low else by + high)
    beside = _strip(cells, sideways[0], sideways[1], column=True)
    beyond = _strip(cells, upright[1], upright[0], column=False)
    if outer:
        ok = bool(np.all(beside == OUTSIDE) and np.all(beyond == OUTSIDE))
        receiver = OUTSIDE
    else:
        strip = beside if rng.random() < 0.5 else beyond
        receiver = int(strip[0])
        ok = receiver not in (OUTSIDE, room) and bool(np.all(strip == receiver))
    if not ok:
        return None
    carved = cells.copy()
    carved[by : by + high, bx : bx + wide] = receiver
    changed = (room,) if outer else (room, receiver)
    return carved if all(_is_roomy(carved, r, types[r]) for r in changed) else None


def _cropped(cells: Cells) -> Cells:
    """The cells without rows and columns that are entirely outside."""
    rows, columns = np.nonzero(cells != OUTSIDE)
    return cells[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1]


def _strip(cells: Cells, line: int, span: slice, *, column: bool) -> NDArray[np.int64]:
    """The cells of one column (or row) along `span`; all outside beyond the lattice."""
    inside = 0 <= line < cells.shape[1 if column else 0]
    if not inside:
        return np.full(span.stop - span.start, OUTSIDE, dtype=np.int64)
    return cells[span, line] if column else cells[line, span]


def _is_roomy(cells: Cells, room: int, room_type: RoomType) -> bool:
    """Whether a room is large enough, one simple piece, and nowhere narrower than two cells."""
    recipe = room_recipes()[room_type]
    mask = np.pad(cells == room, 1)
    area = mask.sum() * CELL**2
    if not recipe.area[0] - 0.3 <= area <= recipe.area[1] + 0.3:
        return False
    quads = mask[:-1, :-1] & mask[:-1, 1:] & mask[1:, :-1] & mask[1:, 1:]
    covered = np.zeros_like(mask)
    for dy in (0, 1):
        for dx in (0, 1):
            covered[dy : covered.shape[0] - 1 + dy, dx : covered.shape[1] - 1 + dx] |= quads
    if not np.array_equal(covered, mask) or not _is_simple(mask):
        return False
    return _has_square(mask, recipe.side) and len(_corner_turns(mask)) <= 8


def _is_simple(mask: NDArray[np.bool_]) -> bool:
    """Whether a padded room is one piece without holes that never touches itself at a corner."""
    a, b, c, d = mask[:-1, :-1], mask[:-1, 1:], mask[1:, :-1], mask[1:, 1:]
    pinched = ((a == d) & (b == c) & (a != b)).any()
    return not pinched and _pieces(mask) == 1 and _pieces(~mask) == 1


def _pieces(mask: NDArray[np.bool_]) -> int:
    numbered = np.zeros(mask.shape, dtype=np.int32)
    label(mask, output=numbered)
    return int(numbered.max())


def _has_square(mask: NDArray[np.bool_], side: int) -> bool:
    sums = np.pad(mask, ((1, 0), (1, 0))).astype(np.int64).cumsum(0).cumsum(1)
    inner = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return bool((inner == side * side).any())


def _corner_turns(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Lattice points where the outline of a room turns."""
    count = mask[:-1, :-1].astype(int) + mask[:-1, 1:] + mask[1:, :-1] + mask[1:, 1:]
    ys, xs = np.nonzero((count == 1) | (count == 3))
    return list(zip(xs.tolist(), ys.tolist(), strict=True))
