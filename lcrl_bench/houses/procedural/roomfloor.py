"""`RoomFloor`: a room being furnished, and the constraints on its furniture.

Furniture stays off walls, doors and other furniture, keeps the required space in front of it clear,
and leaves the agent a connected set of tiles from which each piece can be reached.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import OpeningKind, RoomType
from lcrl_bench.houses.procedural.lattice import (
    CELL,
    FRONTS,
    WALL,
    Rect,
    Rects,
    any_of,
    as_rects,
    distances,
    overlaps,
)
from lcrl_bench.houses.procedural.openings import Gap, Shell
from lcrl_bench.houses.procedural.recipes import Kind, room_recipes

RADIUS: Final = 0.2
"""Radius of the agent in metres."""
CLEARANCE: Final = 0.21
"""Metres between the agent's centre and anything solid: its radius and a little more."""
APPROACH: Final = 0.8
"""Each piece of furniture needs a free tile within this many metres."""
WIDE_DOOR_DEPTH: Final = 1.0
"""Metres kept clear on each side of a door in large rooms."""
DOOR_DEPTH: Final = 0.85
"""The same in rooms of ordinary size."""
SMALL_DOOR_DEPTH: Final = 0.7
"""The same in rooms too small for more."""
PANE_DEPTH: Final = 0.32
"""Metres in front of a window kept clear of tall furniture."""
SPACING: Final = 0.008
"""Minimum gap between two pieces of furniture, in metres."""


@dataclass(frozen=True)
class Piece:
    """A placed piece of furniture."""

    kind: str
    label: str
    size: tuple[float, float, float]
    center: tuple[float, float]
    quarter: int
    turn: float
    """Deviation from the quarter turn, in radians."""
    rect: Rect
    """The axis-aligned bounding rectangle of its footprint."""
    core: Rect
    """An axis-aligned rectangle inside its footprint."""
    zone: Rect
    """The area kept clear in front of it; empty if none is needed."""
    flat: bool
    shape: int


@dataclass(frozen=True)
class Side:
    """A straight stretch of a room's outline, as seen from inside."""

    quarter: int
    """Direction that something with its back to it faces."""
    upright: bool
    line: float
    """The lattice line, in metres."""
    start: float
    end: float
    gaps: tuple[Gap, ...]
    """Doors and windows in it."""
    exterior: bool
    """Whether any of it is an outside wall."""


@dataclass(eq=False)
class RoomFloor:
    """One room: its walls, doors and tiles, and the pieces placed so far."""

    index: int
    name: str
    type: RoomType
    area: float
    """Square metres."""
    height: float
    sides: tuple[Side, ...]
    strips: Rects
    """[wall, 4]: the walls around it, half a wall's thickness on either side of their line."""
    doors: Rects
    """[door, 4]: the area kept clear at each door."""
    thresholds: Rects
    """[door, 4]: the doors themselves."""
    windows: Rects
    """[window, 4]: the area just in front of each."""
    sills: NDArray[np.float64]
    """[window]: sill heights."""
    cells: frozenset[tuple[int, int]]
    """(column, row) of its tiles."""
    tiles: NDArray[np.float64]
    """[tile, 2]: tile centres in metres."""
    steps: NDArray[np.int64]
    """[step, 2]: pairs of adjacent tiles."""
    kept: NDArray[np.int64]
    """Tiles at doors, which always stay free."""
    fewest: int
    """Minimum number of free tiles."""
    pieces: list[Piece] = field(default_factory=list)

    def holds(self, rects: Rects) -> NDArray[np.bool_]:
        """[rect]: whether each rectangle lies inside the room, off its walls."""
        column = np.floor((rects[:, 0] + rects[:, 2]) / 2 / CELL).astype(int)
        row = np.floor((rects[:, 1] + rects[:, 3]) / 2 / CELL).astype(int)
        inside = [cell in self.cells for cell in zip(column.tolist(), row.tolist(), strict=True)]
        return np.array(inside, dtype=bool) & ~any_of(overlaps(rects, self.strips))

    def fits(
        self, rects: Rects, zones: Rects, ignored: tuple[Piece, ...] = ()
    ) -> NDArray[np.bool_]:
        """[rect]: whether something could stand there with its zone in front of it.

        Args:
            rects: [candidate, 4] footprints.
            zones: [candidate, 4] area to keep clear in front of each; empty where none is needed.
            ignored: Pieces it may overlap, such as the table a chair is pushed under.
        """
        others = [p for p in self.pieces if not p.flat and all(p is not q for q in ignored)]
        solid = as_rects([p.rect for p in others])
        clear = as_rects([p.zone for p in others if _has_area(p.zone)])
        fit = self.holds(rects) & ~any_of(overlaps(rects, solid, SPACING))
        fit &= ~any_of(overlaps(rects, clear)) & ~any_of(overlaps(rects, self.doors))
        if rects.size and _has_area(tuple(zones[0])):
            fit &= self.holds(zones) & ~any_of(overlaps(zones, solid))
        return fit

    def free(self) -> NDArray[np.bool_]:
        """[tile]: whether an agent can stand there."""
        solid = as_rects([piece.rect for piece in self.pieces if not piece.flat])
        return ~any_of(distances(_points(self.tiles), solid) < CLEARANCE)

    def walkable(self, rect: Rects, core: Rects) -> bool:
        """Whether its tiles stay connected, its doors free and its furniture reachable.

        Args:
            rect: [1, 4] around the footprint of one more piece.
            core: [1, 4] within that footprint.
        """
        pieces = [piece for piece in self.pieces if not piece.flat]
        solid = np.concatenate([as_rects([piece.rect for piece in pieces]), rect])
        cores = np.concatenate([as_rects([piece.core for piece in pieces]), core])
        away = distances(_points(self.tiles), solid)
        free = ~any_of(away < CLEARANCE)
        if free.sum() < self.fewest or not free[self.kept].all():
            return False
        # No borderline tiles: one that is neither clearly free nor blocked might be cut off.
        if (~free & ~any_of(distances(_points(self.tiles), cores) < RADIUS)).any():
            return False
        if (away[free].min(0) > APPROACH).any():
            return False
        ends = self.tiles[self.steps]
        ways = np.concatenate([ends.min(1), ends.max(1)], axis=1)
        passable = free[self.steps].all(1) & ~any_of(distances(ways, solid) < CLEARANCE)
        return _connected(free, self.steps[passable])


def _points(tiles: NDArray[np.float64]) -> Rects:
    return np.concatenate([tiles, tiles], axis=1)


def _has_area(rect: tuple[float, ...]) -> bool:
    return rect[2] - rect[0] > 1e-9 and rect[3] - rect[1] > 1e-9


def _connected(free: NDArray[np.bool_], steps: NDArray[np.int64]) -> bool:
    neighbours: dict[int, list[int]] = {}
    for a, b in steps.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    start = int(np.argmax(free))
    seen, stack = {start}, [start]
    while stack:
        for other in neighbours.get(stack.pop(), ()):
            if other not in seen:
                seen.add(other)
                stack.append(other)
    return len(seen) == int(free.sum())


def make_piece(
    name: str,
    kind: Kind,
    size: tuple[float, float, float],
    place: tuple[float, float, int],
    turn: float,
    shape: int,
) -> Piece:
    """A piece of furniture at `place` (x, y, quarter turns)."""
    x, y, quarter = round(place[0], 4), round(place[1], 4), place[2]
    rect, zone = bounds(size, (x, y, quarter), turn, kind.front)
    core, _ = bounds(core_size(size, turn), (x, y, quarter), 0.0, 0.0)
    return Piece(name, kind.label, size, (x, y), quarter, turn, rect, core, zone, kind.flat, shape)


def core_size(size: tuple[float, float, float], turn: float) -> tuple[float, float, float]:
    """The largest axis-aligned box inside a box turned by `turn`, which is under 45 degrees."""
    cos, sin = math.cos(turn), abs(math.sin(turn))
    width = max(0.0, (size[0] * cos - size[1] * sin) / (cos * cos - sin * sin))
    depth = max(0.0, (size[1] * cos - size[0] * sin) / (cos * cos - sin * sin))
    return width, depth, size[2]


def bounds(
    size: tuple[float, float, float],
    place: tuple[float, float, int],
    turn: float,
    front: float,
) -> tuple[Rect, Rect]:
    """The rectangle around a footprint, and the zone of depth `front` in front of it."""
    rects, zones = many_bounds(size, np.array([place], dtype=np.float64), turn, front)
    (x0, y0, x1, y1), (u0, v0, u1, v1) = rects[0].tolist(), zones[0].tolist()
    return (x0, y0, x1, y1), (u0, v0, u1, v1)


def many_bounds(
    size: tuple[float, float, float],
    places: NDArray[np.float64],
    turn: float,
    front: float,
) -> tuple[Rects, Rects]:
    """`bounds` of many places [place, 3] at once."""
    cos, sin = math.cos(turn), abs(math.sin(turn))
    width, depth = size[0] * cos + size[1] * sin, size[1] * cos + size[0] * sin
    x, y, quarter = places[:, 0], places[:, 1], places[:, 2].astype(np.int64)
    odd = quarter % 2 == 1
    half_x = np.where(odd, depth, width) / 2
    half_y = np.where(odd, width, depth) / 2
    rects = np.stack([x - half_x, y - half_y, x + half_x, y + half_y], axis=1)
    facing = np.array(FRONTS)[quarter % 4]
    ahead = facing * (depth / 2 + front / 2)
    reach_x, reach_y = np.where(odd, front / 2, half_x), np.where(odd, half_y, front / 2)
    x, y = x + ahead[:, 0], y + ahead[:, 1]
    return rects, np.stack([x - reach_x, y - reach_y, x + reach_x, y + reach_y], axis=1)


def room_floors(shell: Shell) -> tuple[RoomFloor, ...]:
    """Every room of a building, unfurnished."""
    return tuple(_room_floor(shell, room) for room in range(len(shell.rooms)))


def _room_floor(shell: Shell, room: int) -> RoomFloor:
    mask = shell.plan.cells == room
    room_type = shell.plan.types[room]
    recipe = room_recipes()[room_type]
    rows, columns = np.nonzero(mask)
    tiles = (np.stack([columns, rows], axis=1).astype(np.float64) + 0.5) * CELL
    gaps = [gap for gap in shell.gaps if room in gap.rooms]
    doors = [gap for gap in gaps if gap.kind is not OpeningKind.WINDOW]
    panes = [gap for gap in gaps if gap.kind is OpeningKind.WINDOW]
    depth = _door_depth(len(tiles))
    sides = tuple(_sides(mask, gaps, shell.plan.cells))
    thresholds = as_rects([gap.zone(WALL / 2) for gap in doors])
    near = distances(_points(tiles), thresholds) < CELL * 0.45
    return RoomFloor(
        index=room,
        name=shell.rooms[room].id,
        type=room_type,
        area=len(tiles) * CELL**2,
        height=shell.height,
        sides=sides,
        strips=as_rects([_strip(side) for side in sides]),
        doors=as_rects([gap.zone(depth, 0.03) for gap in doors]),
        thresholds=thresholds,
        windows=as_rects([gap.zone(PANE_DEPTH) for gap in panes]),
        sills=np.array([gap.bottom for gap in panes], dtype=np.float64),
        cells=frozenset(zip(columns.tolist(), rows.tolist(), strict=True)),
        tiles=tiles,
        steps=_steps(tiles),
        kept=np.nonzero(any_of(near))[0],
        fewest=max(recipe.free, math.ceil(recipe.free_share * len(tiles))),
    )


def _door_depth(tiles: int) -> float:
    if tiles > 22:
        return WIDE_DOOR_DEPTH
    return DOOR_DEPTH if tiles > 14 else SMALL_DOOR_DEPTH


def _steps(tiles: NDArray[np.float64]) -> NDArray[np.int64]:
    apart = np.abs(tiles[:, None, :] - tiles[None, :, :]).sum(2)
    pairs = np.argwhere(np.triu(apart < CELL * 1.01, 1))
    return pairs.astype(np.int64)


def _strip(side: Side) -> Rect:
    half = WALL / 2
    if side.upright:
        return side.line - half, side.start - half, side.line + half, side.end + half
    return side.start - half, side.line - half, side.end + half, side.line + half


def _sides(mask: NDArray[np.bool_], gaps: list[Gap], cells: NDArray[np.int64]) -> list[Side]:
    found = []
    for upright in (False, True):
        inside = np.pad(mask.T if upright else mask, 1)
        everyone = np.pad(cells.T if upright else cells, 1, constant_values=-1)
        for line in range(inside.shape[0] - 1):
            for above in (True, False):
                ours, theirs = (line + 1, line) if above else (line, line + 1)
                edge = inside[ours, 1:-1] & ~inside[theirs, 1:-1]
                for start, end in _runs(edge):
                    # With its back to the south, something faces north; to the west, east.
                    quarter = {
                        (False, True): 0,
                        (False, False): 2,
                        (True, True): 3,
                        (True, False): 1,
                    }
                    low, high = start * CELL, end * CELL
                    ours_gaps = tuple(
                        gap
                        for gap in gaps
                        if gap.upright == upright
                        and abs(gap.line - line * CELL) < 1e-6
                        and low < (gap.start + gap.end) / 2 < high
                    )
                    outer = bool((everyone[theirs, 1:-1][start:end] < 0).any())
                    side = Side(
                        quarter[upright, above], upright, line * CELL, low, high, ours_gaps, outer
                    )
                    found.append(side)
    return found


def _runs(edge: NDArray[np.bool_]) -> list[tuple[int, int]]:
    marks = np.diff(np.concatenate([[0], edge.astype(int), [0]]))
    starts, ends = np.nonzero(marks == 1)[0], np.nonzero(marks == -1)[0]
    return list(zip(starts.tolist(), ends.tolist(), strict=True))
