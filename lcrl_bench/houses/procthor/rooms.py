"""Rooms of a ProcTHOR file: their type, their floor, and which one contains a point."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.house import Point, Room
from lcrl_bench.houses.procthor.models import SOURCE
from lcrl_bench.houses.procthor.schema import HouseRecord, RoomRecord
from lcrl_bench.houses.taxonomy import load_taxonomy
from lcrl_bench.names import Identifiers

NUDGE = 0.1
"""Largest distance in metres from which an object outside all rooms is moved into the nearest."""

_INSIDE = 0.001


def build_rooms(record: HouseRecord, *, path: Path) -> dict[str, Room]:
    """The rooms of a house, by the file's own id.

    Raises:
        InvalidFileError: If two rooms share an id, or a floor is not a simple polygon.
    """
    names, rooms = Identifiers(), {}
    for index, room in enumerate(record.rooms):
        where = f"rooms[{index}]"
        if room.id in rooms:
            reason = f"two rooms are called {room.id!r}"
            raise InvalidFileError(path, reason, where=where, fix="Rename one and its walls.")
        kind = load_taxonomy(SOURCE).room_type(room.roomType)
        rooms[room.id] = Room(names.unique(room.id), kind, _floor(room, where, path))
    return rooms


def _floor(room: RoomRecord, where: str, path: Path) -> tuple[Point, ...]:
    """The floor's corners, counter-clockwise from above (files list them clockwise)."""
    points = [(point.x, point.z) for point in room.floorPolygon]
    corners = [point for index, point in enumerate(points) if point != points[index - 1]]
    polygon = shapely.Polygon(corners) if len(corners) >= 3 else shapely.Polygon()
    if not polygon.is_valid or polygon.area < 0.01:
        reason = f"the floor of {room.id!r} crosses itself or has no area"
        fix = "List three or more corners in order."
        raise InvalidFileError(path, reason, where=f"{where}.floorPolygon", fix=fix)
    return tuple(corners if polygon.exterior.is_ccw else reversed(corners))


@dataclass(frozen=True)
class RoomFinder:
    """Finds the room that contains a point."""

    rooms: tuple[Room, ...]
    floors: np.ndarray
    """One shapely polygon per room."""

    @classmethod
    def of(cls, rooms: tuple[Room, ...]) -> RoomFinder:
        """The finder of these rooms."""
        return cls(rooms, np.array([shapely.Polygon(room.polygon) for room in rooms]))

    def find(self, point: Point, *, named: str | None = None) -> tuple[str, Point] | None:
        """The room of a point, and the point moved inside it.

        Args:
            point: (x, y) in metres.
            named: Id of the room to prefer if several contain the point.

        Returns:
            The room's id and the point, moved inside if it was up to `NUDGE` outside every room;
            None if it is farther out.
        """
        distances = shapely.distance(self.floors, shapely.Point(point))
        inside = np.flatnonzero(distances == 0)
        if len(inside):
            names = [self.rooms[index].id for index in inside]
            return (named if named is not None and named in names else names[0]), point
        index = int(np.argmin(distances))
        if distances[index] > NUDGE:
            return None
        inner = self.floors[index].buffer(-_INSIDE)
        nearest = shapely.shortest_line(inner, shapely.Point(point))
        x, y = nearest.coords[0]
        return self.rooms[index].id, (float(x), float(y))
