"""`House`: the description of a home that everything downstream is built from.

Frame: x east, y north, z up, metres, radians; the floor is z = 0. An object's own frame has its
width along x, its depth along y and its height along z, and it faces +y; `yaw` turns it
counter-clockwise about z, so an object at yaw 0 faces north.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

from lcrl_bench.drawn import Drawn
from lcrl_bench.errors import UnknownNameError

Point = tuple[float, float]
"""(x, y) in metres."""
Vector = tuple[float, float, float]
"""(x, y, z) or (width, depth, height) in metres."""


class RoomType(StrEnum):
    """What a room is used for; the value is its name in a command."""

    BEDROOM = "bedroom"
    BATHROOM = "bathroom"
    KITCHEN = "kitchen"
    LIVING_ROOM = "living room"
    DINING_ROOM = "dining room"
    OFFICE = "office"
    HALLWAY = "hallway"
    OTHER = "room"


class OpeningKind(StrEnum):
    """What fills a hole in a wall."""

    DOOR = "door"
    """An inner doorway whose leaf stands open: a framed hole one can walk through."""
    DOORWAY = "doorway"
    """A bare or framed hole without a leaf, which one can walk through."""
    CLOSED_DOOR = "closed_door"
    """A door with its leaf shut: nothing passes."""
    WINDOW = "window"
    """A pane: nothing passes."""


PASSABLE = frozenset({OpeningKind.DOOR, OpeningKind.DOORWAY})
"""The kinds of opening an agent can walk through."""


@dataclass(frozen=True)
class Room:
    """A room: its use and its floor."""

    id: str
    type: RoomType
    polygon: tuple[Point, ...]
    """Corners of a simple polygon, counter-clockwise, at least three."""


@dataclass(frozen=True)
class Opening:
    """A rectangular hole in a wall."""

    kind: OpeningKind
    start: float
    """Distance along the wall from `Wall.start` to the hole's near edge."""
    end: float
    """Distance along the wall from `Wall.start` to the hole's far edge; above `start`."""
    bottom: float
    """Height of the sill above the floor; 0 for doors."""
    top: float
    """Height of the lintel above the floor; above `bottom`, at most the wall's height."""


@dataclass(frozen=True)
class Wall:
    """A straight upright wall, centred on the segment from `start` to `end`."""

    id: str
    start: Point
    end: Point
    height: float
    thickness: float
    openings: tuple[Opening, ...] = ()
    """In order along the wall, disjoint."""
    rooms: tuple[str, ...] = ()
    """Ids of the one or two rooms the wall bounds."""

    @property
    def length(self) -> float:
        """Length of the centre line in metres."""
        return math.dist(self.start, self.end)

    def point(self, distance: float) -> Point:
        """The point of the centre line at `distance` from `start`."""
        share = distance / self.length
        (x0, y0), (x1, y1) = self.start, self.end
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0)


@dataclass(frozen=True)
class PlacedObject:
    """A piece of furniture or an object: a label and an oriented box."""

    id: str
    label: str
    """A class name of `assets/classes.toml`."""
    room: str
    """Id of the room it stands in."""
    position: Vector
    """Centre of its box."""
    size: Vector
    """(width, depth, height) of its box in its own frame, all positive."""
    yaw: float
    """Counter-clockwise turn about z; 0 faces north (+y)."""
    support: str | None = None
    """Id of the object it stands on; None if it stands on the floor or hangs on a wall."""
    shape: int = 0
    """Selects one of its class's shapes: any non-negative integer."""
    source_label: str = ""
    """The source's name for it; empty if that is the label itself."""

    @property
    def base(self) -> float:
        """Height of its underside above the floor."""
        return self.position[2] - self.size[2] / 2

    @property
    def top(self) -> float:
        """Height of its top above the floor."""
        return self.position[2] + self.size[2] / 2

    def footprint(self) -> tuple[Point, Point, Point, Point]:
        """The four corners of its box in plan, counter-clockwise."""
        (x, y, _), (width, depth, _) = self.position, self.size
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)

        def corner(right: float, front: float) -> Point:
            return x + right * cos - front * sin, y + right * sin + front * cos

        w, d = width / 2, depth / 2
        return corner(-w, -d), corner(w, -d), corner(w, d), corner(-w, d)


@dataclass(frozen=True, repr=False)
class House(Drawn):
    """A home: rooms, the walls between them, and the objects in it.

    Example:
        >>> house = lcrl_bench.generate_house(0)
        >>> len(house.rooms), house.room("bedroom").type.value
        (6, 'bedroom')
        >>> figure = house.plot()
    """

    drawing = "lcrl_bench.recording.drawings:draw_house"

    id: str
    source: str
    """Name of the house source it came from (`"procedural"`, `"procthor"`)."""
    rooms: tuple[Room, ...]
    walls: tuple[Wall, ...]
    objects: tuple[PlacedObject, ...]
    height: float
    """Height of the ceiling above the floor."""
    provenance: dict[str, str] = field(default_factory=dict)
    """Where it came from, as free text: seed or file, licence, notes."""

    def __repr__(self) -> str:
        """Id and size."""
        return f"House({self.id}: {len(self.rooms)} rooms, {len(self.objects)} objects)"

    def room(self, room_id: str) -> Room:
        """The room with this id.

        Raises:
            UnknownNameError: If there is none.
        """
        for room in self.rooms:
            if room.id == room_id:
                return room
        raise UnknownNameError("room", room_id, (room.id for room in self.rooms))

    def object(self, object_id: str) -> PlacedObject:
        """The object with this id.

        Raises:
            UnknownNameError: If there is none.
        """
        for thing in self.objects:
            if thing.id == object_id:
                return thing
        raise UnknownNameError("object", object_id, (thing.id for thing in self.objects))
