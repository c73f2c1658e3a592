"""Walls with their doors, open passages and windows, from a floor plan.

Every door is centred on a lattice edge, with wall on either side, so the straight step between the
two cells it joins leads through it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from lcrl_bench.houses.house import Opening, OpeningKind, Room, RoomType, Wall
from lcrl_bench.houses.procedural.floorplan import FloorPlan
from lcrl_bench.houses.procedural.lattice import CELL, WALL, Rect
from lcrl_bench.houses.procedural.links import ENTRANCES, SHORTEST, Border, Link, borders
from lcrl_bench.houses.procedural.recipes import draw, room_recipes

OPEN_PLAN: Final = {
    frozenset({RoomType.KITCHEN, RoomType.LIVING_ROOM}): 0.48,
    frozenset({RoomType.KITCHEN, RoomType.DINING_ROOM}): 0.4,
    frozenset({RoomType.DINING_ROOM, RoomType.LIVING_ROOM}): 0.5,
    frozenset({RoomType.HALLWAY, RoomType.LIVING_ROOM}): 0.25,
}
"""Probability that two linked rooms are joined by a wide opening rather than a door."""
BARE: Final = 0.1
"""Share of single doorways without a leaf."""
DOOR_WIDTHS: Final = (0.92, 0.96, 1.0, 1.02, 1.04, 1.05)
DOOR_HEIGHTS: Final = (2.03, 2.07, 2.1)
JAMB: Final = 0.16
"""Metres of wall left at either end of a wide opening; a disc of 0.2 m radius clears it."""
WINDOW_MARGIN: Final = 0.3
"""Metres of wall left beside a window."""
HEIGHT: Final = (2.5, 2.7, 3.0)


@dataclass(frozen=True)
class Gap:
    """A door, doorway or window as furnishing sees it."""

    kind: OpeningKind
    rooms: tuple[int, ...]
    """Indices of the rooms it belongs to, one or two."""
    upright: bool
    """Whether its wall runs north-south."""
    line: float
    """Position of its wall: x if upright, else y."""
    start: float
    end: float
    """Its span along the wall, in the house's frame."""
    bottom: float
    top: float

    def zone(self, depth: float, margin: float = 0.0) -> Rect:
        """The rectangle reaching `depth` to both sides of the wall and `margin` beyond the ends."""
        low, high = self.start - margin, self.end + margin
        if self.upright:
            return self.line - depth, low, self.line + depth, high
        return low, self.line - depth, high, self.line + depth


@dataclass(frozen=True, eq=False)
class Shell:
    """The building without furniture."""

    plan: FloorPlan
    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    gaps: tuple[Gap, ...]
    height: float


def build_shell(plan: FloorPlan, rng: np.random.Generator) -> Shell:
    """Build the walls of a plan and cut its doors and windows."""
    height = round(draw(HEIGHT, rng), 2)
    door = float(rng.choice(DOOR_WIDTHS)), float(rng.choice(DOOR_HEIGHTS))
    stretches = borders(plan.cells)
    holes: dict[Border, list[Opening]] = {border: [] for border in stretches}
    for link in plan.links:
        holes[link.border].append(_passage(link, plan, door, height, rng))
    entrance = _entrance(stretches, plan, rng)
    holes[entrance[0]].append(_hole(OpeningKind.CLOSED_DOOR, entrance[1], *door))
    for room in range(len(plan.types)):
        _cut_windows(room, plan, holes, height, rng)
    walls, gaps = [], []
    names = room_names(plan.types)
    for number, border in enumerate(stretches, start=1):
        openings = tuple(sorted(holes[border], key=lambda opening: opening.start))
        sides = tuple(side for side in (border.low, border.high) if side >= 0)
        start, end = _point(border, border.start), _point(border, border.end)
        rooms = tuple(names[side] for side in sides)
        walls.append(Wall(f"wall-{number}", start, end, height, WALL, openings, rooms))
        gaps += [_gap(border, opening, sides) for opening in openings]
    floors = tuple(
        Room(names[room], room_type, outline(plan, room))
        for room, room_type in enumerate(plan.types)
    )
    return Shell(plan, floors, tuple(walls), tuple(gaps), height)


def room_names(types: tuple[RoomType, ...]) -> tuple[str, ...]:
    """An id for each room: its type, numbered if there are several."""
    names = []
    for index, room_type in enumerate(types):
        name = room_type.value.replace(" ", "-")
        nth = types[: index + 1].count(room_type)
        names.append(f"{name}-{nth}" if types.count(room_type) > 1 else name)
    return tuple(names)


def outline(plan: FloorPlan, room: int) -> tuple[tuple[float, float], ...]:
    """The corners of a room's floor, counter-clockwise."""
    # Directed edges with the room on their left; each corner of a simple outline starts one.
    onward: dict[tuple[int, int], tuple[int, int]] = {}
    for border in borders(np.where(plan.cells == room, 0, -1)):
        ours_above = border.high == 0
        if border.upright:
            ends = (border.line, border.end), (border.line, border.start)
        else:
            ends = (border.start, border.line), (border.end, border.line)
        first, last = ends if ours_above else ends[::-1]
        onward[first] = last
    start = min(onward)
    corners, here = [start], onward[start]
    while here != start:
        corners.append(here)
        here = onward[here]
    return tuple((x * CELL, y * CELL) for x, y in corners)


def _point(border: Border, along: int) -> tuple[float, float]:
    if border.upright:
        return border.line * CELL, along * CELL
    return along * CELL, border.line * CELL


def _gap(border: Border, opening: Opening, sides: tuple[int, ...]) -> Gap:
    base = border.start * CELL
    span = base + opening.start, base + opening.end
    line = border.line * CELL
    return Gap(opening.kind, sides, border.upright, line, *span, opening.bottom, opening.top)


def _hole(kind: OpeningKind, center: float, width: float, top: float) -> Opening:
    start, end = round(center - width / 2, 4), round(center + width / 2, 4)
    return Opening(kind, start, end, 0.0, top)


def _passage(
    link: Link,
    plan: FloorPlan,
    door: tuple[float, float],
    height: float,
    rng: np.random.Generator,
) -> Opening:
    cells = link.border.end - link.border.start
    kinds = frozenset(plan.types[room] for room in link.rooms)
    if rng.random() < OPEN_PLAN.get(kinds, 0.0):
        top = round(min(height - 0.2, float(rng.uniform(2.15, 2.45))), 2)
        # Two or three cells wide if that leaves wall on both sides, else the whole wall is dropped.
        whole = cells <= 4 or rng.random() < 0.35
        if whole:
            return Opening(OpeningKind.DOORWAY, JAMB, cells * CELL - JAMB, 0.0, top)
        wide = int(rng.integers(2, min(3, cells - 2) + 1))
        first = int(rng.integers(1, cells - wide))
        width = wide * CELL + float(rng.uniform(0.4, 0.44))
        return _hole(OpeningKind.DOORWAY, (first + wide / 2) * CELL, width, top)
    kind = OpeningKind.DOORWAY if rng.random() < BARE else OpeningKind.DOOR
    return _hole(kind, (_door_cell(cells, rng) + 0.5) * CELL, *door)


def _door_cell(cells: int, rng: np.random.Generator) -> int:
    """The cell of a wall for its door: mostly near a corner, never at the very end."""
    if rng.random() < 0.7:
        return 1 if rng.random() < 0.5 else cells - 2
    return int(rng.integers(1, cells - 1))


def _entrance(
    stretches: tuple[Border, ...], plan: FloorPlan, rng: np.random.Generator
) -> tuple[Border, float]:
    """The outside wall with the front door, and the door's middle along it."""
    usable, weights = [], []
    for border in stretches:
        inner = min(border.low, border.high) >= 0 or border.end - border.start < SHORTEST
        weight = ENTRANCES.get(plan.types[max(border.low, border.high)])
        if not inner and weight is not None:
            usable.append(border)
            weights.append(weight)
    share = np.array(weights) / sum(weights)
    border = usable[int(rng.choice(len(usable), p=share))]
    return border, (_door_cell(border.end - border.start, rng) + 0.5) * CELL


def _cut_windows(
    room: int,
    plan: FloorPlan,
    holes: dict[Border, list[Opening]],
    height: float,
    rng: np.random.Generator,
) -> None:
    recipe = room_recipes()[plan.types[room]]
    count = int(rng.choice(len(recipe.windows), p=np.array(recipe.windows)))
    outer = [
        border
        for border in holes
        if room in (border.low, border.high) and min(border.low, border.high) < 0
    ]
    sill = round(draw(recipe.sill, rng), 2)
    top = round(min(sill + draw(recipe.window_height, rng), height - 0.15), 2)
    for _ in range(count * 6):
        if count == 0 or not outer:
            break
        lengths = np.array([border.end - border.start for border in outer], dtype=float)
        border = outer[int(rng.choice(len(outer), p=lengths / lengths.sum()))]
        width = draw(recipe.window_width, rng)
        length = (border.end - border.start) * CELL
        center = length * float(rng.choice((0.5, 0.5, 0.3, 0.7))) + rng.uniform(-0.1, 0.1)
        start, end = round(center - width / 2, 3), round(center + width / 2, 3)
        clear = all(
            end + WINDOW_MARGIN < other.start or start - WINDOW_MARGIN > other.end
            for other in holes[border]
        )
        if clear and start >= WINDOW_MARGIN and end <= length - WINDOW_MARGIN:
            holes[border].append(Opening(OpeningKind.WINDOW, start, end, sill, top))
            count -= 1
