"""Validation of houses from any source.

A valid house has finite numbers, simple rooms, openings inside their walls, known labels, unique
ids, and every object inside its room; everything downstream relies on this.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from shapely.geometry import Point as ShapelyPoint
from shapely.geometry import Polygon

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.classes import class_names
from lcrl_bench.houses.house import House, Opening, PlacedObject, Room, Wall
from lcrl_bench.names import NAME, RULE

SLACK = 0.02
"""Tolerance in metres for boxes and holes: source files round, and walls have thickness."""

FARTHEST = 10_000.0
"""Largest absolute coordinate in metres."""


def validate_house(house: House) -> None:
    """Validate a house.

    Raises:
        InvalidHouseError: At the first violation; names the part and the fix.
    """
    _check_names(house)
    _check_finite(house.id, "height", (house.height,))
    if house.height <= 0:
        raise InvalidHouseError(house.id, f"its height {house.height:g} is not positive")
    if not house.rooms:
        raise InvalidHouseError(house.id, "it has no rooms", fix="A house needs at least one.")
    _check_unique(house.id, "room", [room.id for room in house.rooms])
    _check_unique(house.id, "wall", [wall.id for wall in house.walls])
    _check_unique(house.id, "object", [thing.id for thing in house.objects])
    floors = {room.id: _check_room(house.id, room) for room in house.rooms}
    for wall in house.walls:
        _check_wall(house, wall, floors)
    for thing in house.objects:
        _check_object(house, thing, floors)
    _check_supports(house)


def _check_names(house: House) -> None:
    parts = (*house.rooms, *house.walls, *house.objects)
    for name in (house.id, house.source, *(part.id for part in parts)):
        if NAME.fullmatch(name) is None or ".." in name:
            raise InvalidHouseError(house.id, f"the name {name!r} is not valid", fix=f"{RULE}.")


def _check_unique(house: str, kind: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise InvalidHouseError(house, f"two {kind}s are called '{name}'", fix="Rename one.")
        seen.add(name)


def _check_finite(house: str, where: str, numbers: Iterable[float]) -> None:
    for number in numbers:
        if not math.isfinite(number) or abs(number) > FARTHEST:
            reason = f"the number {number} is not finite or beyond {FARTHEST:g}"
            raise InvalidHouseError(house, reason, where=where, fix="Give metres and radians.")


def _check_room(house: str, room: Room) -> Polygon:
    where = f"room '{room.id}'"
    _check_finite(house, where, (c for point in room.polygon for c in point))
    if len(set(room.polygon)) < 3:
        reason = f"a floor polygon of {len(set(room.polygon))} points has no area"
        raise InvalidHouseError(house, reason, where=where, fix="A room needs three corners.")
    polygon = Polygon(room.polygon)
    if not polygon.is_valid or polygon.area < 0.01:
        reason = "its floor polygon crosses itself or has no area"
        raise InvalidHouseError(house, reason, where=where, fix="List the corners in order.")
    if not polygon.exterior.is_ccw:
        reason = "its floor polygon runs clockwise"
        raise InvalidHouseError(house, reason, where=where, fix="List the corners the other way.")
    return polygon


def _check_wall(house: House, wall: Wall, floors: dict[str, Polygon]) -> None:
    where = f"wall '{wall.id}'"
    _check_finite(house.id, where, (*wall.start, *wall.end, wall.height, wall.thickness))
    if wall.length < 1e-6 or wall.height <= 0 or wall.thickness <= 0:
        raise InvalidHouseError(house.id, "a wall without extent", where=where, fix="Remove it.")
    unknown = set(wall.rooms) - set(floors)
    if unknown:
        reason = f"it bounds the unknown rooms {sorted(unknown)}"
        raise InvalidHouseError(house.id, reason, where=where, fix=f"Rooms: {sorted(floors)}.")
    edge = 0.0
    for opening in wall.openings:
        _check_opening(house.id, wall, opening, where)
        if opening.start < edge - SLACK:
            fix = "List a wall's openings in order along it, none inside another."
            raise InvalidHouseError(house.id, "two openings overlap", where=where, fix=fix)
        edge = opening.end


def _check_opening(house: str, wall: Wall, opening: Opening, where: str) -> None:
    _check_finite(house, where, (opening.start, opening.end, opening.bottom, opening.top))
    inside = -SLACK <= opening.start < opening.end <= wall.length + SLACK
    upright = -SLACK <= opening.bottom < opening.top <= wall.height + SLACK
    if not (inside and upright):
        hole = f"[{opening.start:g}, {opening.end:g}] x [{opening.bottom:g}, {opening.top:g}]"
        reason = f"the {opening.kind} {hole} leaves its wall of {wall.length:g} x {wall.height:g} m"
        raise InvalidHouseError(house, reason, where=where, fix="Move it inside the wall.")


def _check_object(house: House, thing: PlacedObject, floors: dict[str, Polygon]) -> None:
    where = f"object '{thing.id}'"
    _check_finite(house.id, where, (*thing.position, *thing.size, thing.yaw))
    if min(thing.size) <= 0:
        raise InvalidHouseError(house.id, f"the size {thing.size} is not positive", where=where)
    if thing.shape < 0:
        raise InvalidHouseError(house.id, f"the shape {thing.shape} is negative", where=where)
    if thing.label not in class_names():
        reason = f"'{thing.label}' is not one of the 61 classes"
        raise InvalidHouseError(house.id, reason, where=where, fix="See assets/classes.toml.")
    if thing.room not in floors:
        reason = f"it names the unknown room '{thing.room}'"
        raise InvalidHouseError(house.id, reason, where=where, fix=f"Rooms: {sorted(floors)}.")
    x, y, z = thing.position
    if floors[thing.room].distance(ShapelyPoint(x, y)) > SLACK:
        reason = f"its centre ({x:g}, {y:g}) lies outside its room '{thing.room}'"
        raise InvalidHouseError(house.id, reason, where=where, fix="Move it or rename the room.")
    if thing.base < -SLACK or z > house.height:
        reason = f"its height range [{thing.base:g}, {thing.top:g}] leaves the house"
        raise InvalidHouseError(house.id, reason, where=where, fix="Floors are at z = 0.")


def _check_supports(house: House) -> None:
    """Check that every chain of supports ends at the floor or a wall."""
    supports = {thing.id: thing.support for thing in house.objects}
    grounded: set[str] = set()
    for name in supports:
        chain: dict[str, None] = {}
        current: str | None = name
        while current is not None and current not in grounded:
            where = f"object '{name}'"
            if current not in supports:
                reason = f"it stands on the unknown object '{current}'"
                raise InvalidHouseError(house.id, reason, where=where, fix="Name another.")
            if current in chain:
                reason = f"it stands on itself through {list(chain)[:5]}"
                raise InvalidHouseError(house.id, reason, where=where, fix="Remove a support.")
            chain[current] = None
            current = supports[current]
        grounded.update(chain)
