"""Walls of a ProcTHOR file: two thin sides each, merged into one wall with its openings.

Source: `ProceduralTools.cs` of AI2-THOR. A side runs from p0 to p1, the two points of lowest y
after a *stable* sort by y: files list low or high points first. A hole is [min, max] in the plane
of wall0, x from its p0 towards its p1; on wall1, which runs the other way, the same hole is at
x' = length - max.x. Cutting the hole in plan coordinates into both walls is equivalent.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from pathlib import Path

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.house import Opening, OpeningKind, Point, Wall
from lcrl_bench.houses.procthor.models import models
from lcrl_bench.houses.procthor.schema import HouseRecord, OpeningRecord, Vector3, WallRecord
from lcrl_bench.names import Identifiers

THICKNESS = 0.1
"""Wall thickness in metres: the sides have none of their own."""

_SHORTEST = 0.01
_NARROWEST = 0.05


@dataclass(frozen=True)
class Side:
    """One side of a wall in plan."""

    start: Point
    end: Point
    height: float
    record: WallRecord

    @property
    def length(self) -> float:
        """Metres from `start` to `end`."""
        return math.dist(self.start, self.end)


@dataclass(frozen=True)
class Walls:
    """The walls of a house, and notes on what was left out."""

    walls: tuple[Wall, ...]
    height: float
    """Height of the highest wall, which is the house's."""
    notes: tuple[str, ...]


@dataclass
class _Plan:
    """Walls under construction."""

    path: Path
    walls: list[Wall] = field(default_factory=list)
    of_side: dict[str, int | None] = field(default_factory=dict)
    """Side id → index of its wall, or None."""
    notes: list[str] = field(default_factory=list)


def read_side(record: WallRecord) -> Side:
    """The side of a wall record: its two ends and its height."""
    points = sorted(record.polygon, key=lambda point: point.y)
    height = points[-1].y - points[0].y
    return Side(_plan(points[0]), _plan(points[1]), height, record)


def hole_in(side: Side, record: OpeningRecord) -> tuple[Point, Point]:
    """The two ends in plan of a hole given in the plane of `side`."""
    low, high = sorted(corner.x for corner in record.holePolygon)
    return _along(side, low), _along(side, high)


def build_walls(record: HouseRecord, room_ids: dict[str, str], *, path: Path) -> Walls:
    """Merge the sides of a house into walls and cut its doors and windows.

    Args:
        record: The house file.
        room_ids: The file's room id → the house's.
        path: Where it was read from, for messages.

    Raises:
        InvalidFileError: If two sides share an id, a side has no height, or a door or window
            names an unknown wall or lies outside its wall.
    """
    sides = _sides(record, path)
    plan = _Plan(path)
    _merge(plan, sides, room_ids)
    for key, openings in (("doors", record.doors), ("windows", record.windows)):
        for index, opening in enumerate(openings or ()):
            _cut(plan, sides, opening, f"{key}[{index}]")
    walls = tuple(
        replace(wall, openings=tuple(sorted(wall.openings, key=lambda hole: hole.start)))
        for wall in plan.walls
    )
    height = max((side.height for side in sides.values()), default=0.0)
    if height <= 0:
        raise InvalidFileError(path, "no wall has a height", where="walls", fix="Add its walls.")
    return Walls(walls, height, tuple(plan.notes))


def _sides(record: HouseRecord, path: Path) -> dict[str, Side]:
    sides: dict[str, Side] = {}
    for index, wall in enumerate(record.walls):
        side, where = read_side(wall), f"walls[{index}]"
        if wall.id in sides:
            reason = f"two walls are called {wall.id!r}"
            raise InvalidFileError(path, reason, where=where, fix="Rename one and its doors.")
        if not 0.5 <= side.height <= 50:
            reason = f"a wall {side.height:g} m high"
            fix = "Its polygon needs two low and two high points, 0.5 to 50 m apart."
            raise InvalidFileError(path, reason, where=where, fix=fix)
        sides[wall.id] = side
    return sides


def _merge(plan: _Plan, sides: dict[str, Side], room_ids: dict[str, str]) -> None:
    """One wall per pair of sides on a segment; none if neither is solid (open plan)."""
    names, segments = Identifiers(), {}
    for side in sides.values():
        segments.setdefault(_segment(side), []).append(side)
    short = 0
    for twins in segments.values():
        solid = [side for side in twins if not side.record.empty]
        short += bool(solid) and twins[0].length < _SHORTEST
        keep = solid and twins[0].length >= _SHORTEST
        for side in twins:
            plan.of_side[side.record.id] = len(plan.walls) if keep else None
        if keep:
            first = solid[0]
            known = (room_ids.get(side.record.roomId) for side in twins)
            rooms = tuple(dict.fromkeys(room for room in known if room))[:2]
            name, height = names.unique(first.record.id), max(side.height for side in solid)
            wall = Wall(name, first.start, first.end, height, THICKNESS, (), rooms)
            plan.walls.append(wall)
    if short:
        plan.notes.append(f"{short} walls shorter than {_SHORTEST * 100:g} cm left out.")


def _cut(plan: _Plan, sides: dict[str, Side], record: OpeningRecord, where: str) -> None:
    for name in (record.wall0, record.wall1):
        if name not in sides:
            reason = f"'{record.id}' is in the unknown wall '{name}'"
            fix = "Name a wall of this file."
            raise InvalidFileError(plan.path, reason, where=where, fix=fix)
    ends = hole_in(sides[record.wall0], record)
    targets = {plan.of_side[record.wall0], plan.of_side[record.wall1]} - {None}
    if not targets:
        plan.notes.append(f"'{record.id}' left out: there is no wall around it.")
    for index in sorted(target for target in targets if target is not None):
        wall = plan.walls[index]
        hole = _opening(plan, wall, record, ends, where)
        # Some generators list a door twice, once per room.
        if hole not in wall.openings:
            plan.walls[index] = replace(wall, openings=(*wall.openings, hole))


def _opening(
    plan: _Plan, wall: Wall, record: OpeningRecord, ends: tuple[Point, Point], where: str
) -> Opening:
    start, end = sorted(_distance(wall, point) for point in ends)
    bottom, top = sorted(corner.y for corner in record.holePolygon)
    kind = OpeningKind.WINDOW if where.startswith("windows") else _door_kind(record)
    hole = (max(start, 0.0), min(end, wall.length), max(bottom, 0.0), min(top, wall.height))
    if hole[1] - hole[0] < _NARROWEST or hole[3] - hole[2] < _NARROWEST:
        reason = f"the hole of '{record.id}' lies outside its wall of {wall.length:.3g} m"
        fix = "Give holePolygon as [min, max] in the plane of wall0."
        raise InvalidFileError(plan.path, reason, where=where, fix=fix)
    cropped = max(hole[0] - start, end - hole[1], hole[2] - bottom, top - hole[3])
    if cropped > 0.01:
        plan.notes.append(f"'{record.id}' cropped by {cropped * 100:.0f} cm to fit its wall.")
    return Opening(kind, *hole)


def _door_kind(record: OpeningRecord) -> OpeningKind:
    """Inner doors stand open; doors to the outside are shut, since nothing is there."""
    if record.room0 == record.room1 or "exterior" in (record.room0, record.room1):
        return OpeningKind.CLOSED_DOOR
    model = models().get(record.assetId)
    leaf = model.type == "Doorway" if model is not None else record.openable is not None
    return OpeningKind.DOOR if leaf else OpeningKind.DOORWAY


def _plan(point: Vector3) -> Point:
    return point.x, point.z


def _segment(side: Side) -> tuple[tuple[int, int], ...]:
    """A key shared by both sides of a wall, which run opposite ways along one line."""
    return tuple(sorted((round(x * 1e3), round(y * 1e3)) for x, y in (side.start, side.end)))


def _along(side: Side, distance: float) -> Point:
    share = distance / side.length if side.length else 0.0
    (x0, y0), (x1, y1) = side.start, side.end
    return x0 + share * (x1 - x0), y0 + share * (y1 - y0)


def _distance(wall: Wall, point: Point) -> float:
    """How far along the wall's line a point lies."""
    (x0, y0), (x1, y1) = wall.start, wall.end
    dot = (point[0] - x0) * (x1 - x0) + (point[1] - y0) * (y1 - y0)
    return dot / wall.length
