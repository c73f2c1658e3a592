"""A house prepared for the checks: rooms with their floors and contents, and the doors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.house import (
    PASSABLE,
    House,
    Opening,
    OpeningKind,
    PlacedObject,
    Point,
    Room,
    RoomType,
    Wall,
)
from lcrl_bench.houses.procedural.walkability import Walk, walk

ON_FLOOR: Final = 0.15
"""Objects with their underside below this stand on the floor, in metres."""
FLAT: Final = frozenset({"rug"})
"""Classes one walks over; no check counts them as furniture."""
MAIN: Final = (RoomType.KITCHEN, RoomType.LIVING_ROOM, RoomType.BEDROOM, RoomType.BATHROOM)
"""The room types of the reference data."""


@dataclass(frozen=True)
class Figure:
    """One measured number; None if there is nothing to measure."""

    value: float | None
    note: str = ""
    """The items out of tolerance, if the number is a share of several."""


Figures = dict[str, Figure]


@dataclass(frozen=True, eq=False)
class Thing:
    """An object with its footprint."""

    placed: PlacedObject
    floor: Polygon

    @property
    def label(self) -> str:
        """Its class."""
        return self.placed.label

    def ahead(self, depth: float, share: float = 0.9) -> Polygon:
        """The rectangle in front of it, `depth` metres deep, over `share` of its width."""
        (x, y, _), (width, own, _), yaw = self.placed.position, self.placed.size, self.placed.yaw
        return _turned((x, y), yaw, share * width / 2, (own / 2, own / 2 + depth))

    def behind(self, depth: float) -> LineString:
        """The line from the middle of its back, `depth` metres long."""
        (x, y, _), own, yaw = self.placed.position, self.placed.size[1], self.placed.yaw
        sin, cos = math.sin(yaw), math.cos(yaw)
        ends = (-own / 2, -own / 2 - depth)
        return LineString([(x - end * sin, y + end * cos) for end in ends])

    def faces(self, other: Thing) -> float:
        """Cosine of the angle between its heading and the direction to another."""
        (x, y, _), (u, v, _) = self.placed.position, other.placed.position
        away = math.hypot(u - x, v - y)
        yaw = self.placed.yaw
        return 1.0 if away == 0 else (-(u - x) * math.sin(yaw) + (v - y) * math.cos(yaw)) / away


@dataclass(frozen=True, eq=False)
class RoomView:
    """A room and its contents."""

    room: Room
    floor: Polygon
    inner: BaseGeometry
    """The floor minus the surrounding walls."""
    standing: tuple[Thing, ...]
    """Objects on the floor, without rugs."""
    hung: tuple[Thing, ...]
    on_surfaces: tuple[Thing, ...]

    @property
    def type(self) -> RoomType:
        """The room's type."""
        return self.room.type

    @cached_property
    def rim(self) -> BaseGeometry:
        """The outline of `inner`: the faces of its walls."""
        return self.inner.boundary

    def of(self, *labels: str) -> list[Thing]:
        """Objects of the given classes on its floor."""
        return [thing for thing in self.standing if thing.label in labels]

    def has(self, *labels: str) -> bool:
        """Whether it holds an object of any of the given classes."""
        every = (*self.standing, *self.hung, *self.on_surfaces)
        return any(thing.label in labels for thing in every)


@dataclass(frozen=True, eq=False)
class DoorSide:
    """A door seen from one of its rooms."""

    room: RoomView
    opening: Opening
    line: LineString
    inward: Point
    """Unit vector from the wall into the room."""

    def zone(self, depth: float) -> Polygon:
        """The floor in front of it, `depth` metres deep over its whole width."""
        (x0, y0), (x1, y1) = self.line.coords
        dx, dy = self.inward[0] * depth, self.inward[1] * depth
        return Polygon([(x0, y0), (x1, y1), (x1 + dx, y1 + dy), (x0 + dx, y0 + dy)])


@dataclass(frozen=True, eq=False)
class HouseView:
    """A house, prepared once for every check."""

    house: House
    rooms: tuple[RoomView, ...]

    @cached_property
    def walk(self) -> Walk:
        """Where an agent can stand and step."""
        return walk(self.house)

    @cached_property
    def links(self) -> tuple[tuple[int, int], ...]:
        """Pairs of room indices, one per passable opening between two rooms."""
        number = {view.room.id: index for index, view in enumerate(self.rooms)}
        return tuple(
            (number[wall.rooms[0]], number[wall.rooms[1]])
            for wall, opening in self.openings(*PASSABLE)
            if len(wall.rooms) == 2
        )

    def openings(self, *kinds: OpeningKind) -> list[tuple[Wall, Opening]]:
        """All openings of the given kinds, with their walls."""
        return [(w, o) for w in self.house.walls for o in w.openings if o.kind in kinds]

    @cached_property
    def door_sides(self) -> tuple[DoorSide, ...]:
        """Every door and doorway, once per room it belongs to."""
        views = {view.room.id: view for view in self.rooms}
        found = []
        for wall, opening in self.openings(*PASSABLE, OpeningKind.CLOSED_DOOR):
            line = LineString([wall.point(opening.start), wall.point(opening.end)])
            found += [_door_side(views[name], wall, opening, line) for name in wall.rooms]
        return tuple(found)

    @property
    def things(self) -> list[Thing]:
        """Everything in the house except rugs."""
        return [t for room in self.rooms for t in (*room.standing, *room.hung, *room.on_surfaces)]


def _door_side(view: RoomView, wall: Wall, opening: Opening, line: LineString) -> DoorSide:
    (x0, y0), (x1, y1) = wall.start, wall.end
    normal = -(y1 - y0) / wall.length, (x1 - x0) / wall.length
    middle = line.interpolate(0.5, normalized=True)
    # A point just beyond the wall: inward is the side on which it lies in the room.
    ahead = shapely.Point(middle.x + 0.2 * normal[0], middle.y + 0.2 * normal[1])
    inward = normal if view.floor.contains(ahead) else (-normal[0], -normal[1])
    return DoorSide(view, opening, line, inward)


def _turned(middle: Point, yaw: float, half: float, along: tuple[float, float]) -> Polygon:
    sin, cos = math.sin(yaw), math.cos(yaw)
    corners = [(-half, along[0]), (half, along[0]), (half, along[1]), (-half, along[1])]
    return Polygon(
        [(middle[0] + u * cos - v * sin, middle[1] + u * sin + v * cos) for u, v in corners]
    )


def view_house(house: House) -> HouseView:
    """Prepare a house for the checks."""
    return HouseView(house, tuple(_view_room(house, room) for room in house.rooms))


def _view_room(house: House, room: Room) -> RoomView:
    floor = Polygon(room.polygon)
    walls = [
        LineString([wall.start, wall.end]).buffer(wall.thickness / 2, cap_style="square")
        for wall in house.walls
        if room.id in wall.rooms
    ]
    ours = [thing for thing in house.objects if thing.room == room.id and thing.label not in FLAT]
    things = [Thing(thing, Polygon(thing.footprint())) for thing in ours]
    loose = [thing for thing in things if thing.placed.support is None]
    return RoomView(
        room,
        floor,
        floor.difference(shapely.union_all(walls)),
        tuple(thing for thing in loose if thing.placed.base < ON_FLOOR and not _hangs(thing)),
        tuple(thing for thing in loose if thing.placed.base >= ON_FLOOR or _hangs(thing)),
        tuple(thing for thing in things if thing.placed.support is not None),
    )


def _hangs(thing: Thing) -> bool:
    """Whether it is hung, even if it reaches down to the floor."""
    return thing.label in ("curtain", "heater_ac", "mirror", "picture")


def share(truths: Iterable[bool]) -> Figure:
    """The share of cases that hold."""
    cases = list(truths)
    return Figure(sum(cases) / len(cases) if cases else None)


def number(values: Iterable[bool]) -> Figure:
    """The number of cases that hold."""
    return Figure(float(sum(values)))


def quantile(values: Iterable[float], at: float) -> Figure:
    """A quantile of the values."""
    known = list(values)
    return Figure(float(np.quantile(known, at)) if known else None)


def within(offenders: Sequence[str], cases: int) -> Figure:
    """The share of `cases` items within tolerance; the note names the others."""
    return Figure(1 - len(offenders) / cases if cases else None, ", ".join(offenders))
