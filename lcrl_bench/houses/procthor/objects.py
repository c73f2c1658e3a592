"""Objects of a ProcTHOR file: boxes with a class, each inside its room and clear of walls.

Unity's axes are left-handed with y up, so swapping y and z gives ours: a positive rotation about
Unity's y is a negative one about our z. `position` is the centre of the object's box in world
coordinates, for objects on furniture too. Euler angles are applied in the order z, x, y.

Source: `molmo_spaces/housegen` of github.com/allenai/molmospaces, which converts to MuJoCo.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace

import numpy as np

from lcrl_bench.houses.house import PlacedObject, Point, Room, Vector, Wall
from lcrl_bench.houses.procthor.clearance import WallFaces
from lcrl_bench.houses.procthor.models import identify
from lcrl_bench.houses.procthor.resting import over, rest
from lcrl_bench.houses.procthor.rooms import RoomFinder
from lcrl_bench.houses.procthor.schema import FurnitureRecord, HouseRecord, ObjectRecord
from lcrl_bench.houses.taxonomy import DROPPED
from lcrl_bench.names import Identifiers

_DROP_TO_FLOOR = 0.15
_INSIDE = 0.01
_CLOSE = 1e-9


@dataclass
class Placement:
    """The placed objects of a house, and a tally of the changes made to them."""

    finder: RoomFinder
    walls: WallFaces
    height: float
    room_ids: dict[str, str]
    """The file's room id → the house's."""
    names: Identifiers = field(default_factory=Identifiers)
    placed: list[PlacedObject] = field(default_factory=list)
    seen: int = 0
    mapped: int = 0
    unmapped: set[str] = field(default_factory=set)
    tally: Counter[str] = field(default_factory=Counter)
    farthest: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    """Largest displacement in metres for each reason in `tally`."""
    dropped: list[str] = field(default_factory=list)

    def count(self, reason: str, metres: float = 0.0) -> None:
        """Count one more object changed for `reason`."""
        self.tally[reason] += 1
        self.farthest[reason] = max(self.farthest[reason], metres)

    def notes(self) -> tuple[str, ...]:
        """One sentence per kind of change, and one for the objects left out."""
        lines = [self._line(reason, count) for reason, count in self.tally.items()]
        if self.dropped:
            shown = ", ".join(self.dropped[:10]) + (", ..." if len(self.dropped) > 10 else "")
            lines.append(f"{_objects(len(self.dropped))} left out: {shown}.")
        return tuple(lines)

    def _line(self, reason: str, count: int) -> str:
        most = self.farthest[reason]
        distance = f" (by up to {most * 100:.1f} cm)" if most else ""
        return f"{_objects(count)} {reason}{distance}."

    @property
    def label_coverage(self) -> float:
        """Share of the file's objects whose label the taxonomy knows."""
        return self.mapped / self.seen if self.seen else 1.0


def _objects(count: int) -> str:
    return "1 object" if count == 1 else f"{count} objects"


def place_objects(
    record: HouseRecord, rooms: dict[str, Room], walls: tuple[Wall, ...], height: float
) -> Placement:
    """Place every object of a house file that lies in a room.

    Args:
        record: The house file.
        rooms: The house's rooms, by the file's own id.
        walls: The house's walls.
        height: Height of the ceiling.
    """
    finder = RoomFinder.of(tuple(rooms.values()))
    room_ids = {key: room.id for key, room in rooms.items()}
    placement = Placement(finder, WallFaces.of(walls), height, room_ids)
    for thing in record.objects or ():
        _place_with_children(placement, thing)
    return placement


def _place_with_children(placement: Placement, record: FurnitureRecord) -> None:
    thing = _place(placement, record, shift=(0.0, 0.0))
    if thing is not None:
        thing = _clear_of_walls(placement, _onto_floor(placement, thing))
        placement.placed.append(thing)
    for child in record.children or ():
        x, y = (0.0, 0.0) if thing is None else thing.position[:2]
        shift = (0.0, 0.0) if thing is None else (x - record.position.x, y - record.position.z)
        placed = _place(placement, child, shift=shift)
        if placed is not None and thing is not None:
            placement.placed.append(_rested(placement, replace(placed, support=thing.id), thing))
        elif placed is not None:
            placement.dropped.append(f"'{child.id}' (what it stands on is left out)")


def _place(placement: Placement, record: ObjectRecord, *, shift: Point) -> PlacedObject | None:
    """An object in its room, between floor and ceiling; None if it lies outside the house."""
    identity = identify(record.assetId, record.objectType)
    placement.seen += 1
    placement.mapped += identity.mapped
    if not identity.mapped:
        placement.unmapped.add(identity.source_label)
    if identity.label == DROPPED:
        placement.dropped.append(f"'{record.id}' (no class)")
        return None
    if not identity.measured:
        placement.count("of an unknown model given a size typical of the class")
    point = (record.position.x + shift[0], record.position.z + shift[1])
    named = placement.room_ids.get(record.roomId or "")
    found = placement.finder.find(point, named=named)
    if found is None:
        placement.dropped.append(f"'{record.id}' (outside every room)")
        return None
    room, inside = found
    if inside != point:
        placement.count("moved into the nearest room", math.dist(point, inside))
    size = tilted_size(identity.size, record.rotation.x, record.rotation.z)
    z = _between_floor_and_ceiling(placement, record, size[2])
    if z is None:
        return None
    return PlacedObject(
        id=placement.names.unique(record.id),
        label=identity.label,
        room=room,
        position=(*inside, z),
        size=size,
        yaw=yaw_of(record.rotation.y),
        shape=identity.shape,
        source_label=identity.source_label,
    )


def yaw_of(degrees: float) -> float:
    """Our yaw, in (-pi, pi], for a rotation about Unity's y."""
    turn = -math.radians(degrees % 360)
    return turn + 2 * math.pi if turn <= -math.pi else turn + 0.0


def tilted_size(size: Vector, pitch: float, roll: float) -> Vector:
    """The upright bounding box of a box rotated by `roll` about Unity's z and `pitch` about x.

    Args:
        size: (width, depth, height) of the box as modelled.
        pitch: Degrees about x, its width.
        roll: Degrees about z, its depth.
    """
    width, depth, height = size
    c, s = abs(math.cos(math.radians(pitch))), abs(math.sin(math.radians(pitch)))
    cr, sr = abs(math.cos(math.radians(roll))), abs(math.sin(math.radians(roll)))
    # Rows of |Rx Rz| in Unity's axes; each entry is one product, so signs don't matter.
    across, up = cr * width + sr * height, sr * width + cr * height
    return across, s * up + c * depth, c * up + s * depth


def _between_floor_and_ceiling(
    placement: Placement, record: ObjectRecord, height: float
) -> float | None:
    """Height of a box's centre, moved so that the box lies between floor and ceiling."""
    z, room = record.position.y, placement.height
    if z - height / 2 > room or z + height / 2 < -0.5:
        placement.dropped.append(f"'{record.id}' (above the ceiling or below the floor)")
        return None
    lowered = min(z, room - height / 2)
    kept = max(lowered, height / 2)
    if abs(kept - z) > 0.005:
        placement.count("moved up or down between floor and ceiling", abs(kept - z))
    return kept


def _onto_floor(placement: Placement, thing: PlacedObject) -> PlacedObject:
    """Lower things that float less than 15 cm above the floor: nothing hangs that low."""
    if not 0 < thing.base <= _DROP_TO_FLOOR:
        return thing
    if thing.base > 0.005:
        placement.count("lowered onto the floor", thing.base)
    x, y, z = thing.position
    return replace(thing, position=(x, y, z - thing.base))


def _rested(placement: Placement, thing: PlacedObject, under: PlacedObject) -> PlacedObject:
    """Set a thing down on its furniture, unless that would move it out of its room."""
    rested = rest(thing, under)
    found = placement.finder.find(rested.position[:2], named=thing.room)
    if found != (thing.room, rested.position[:2]) or rested.top > placement.height:
        return thing
    if rested == thing and thing.base < under.top - _INSIDE and over(thing, under):
        placement.count("kept inside furniture, perhaps out of sight")
    metres = math.dist(rested.position, thing.position)
    if metres > 0.01:
        placement.count("set down on the furniture below", metres)
    return rested


def _clear_of_walls(placement: Placement, thing: PlacedObject) -> PlacedObject:
    """Move a box out of the walls, which have thickness here but not in the file."""
    shift = placement.walls.shift(np.array(thing.footprint()), np.array(thing.position[:2]))
    metres = float(np.hypot(*shift))
    if metres < _CLOSE:
        return thing
    x, y = float(thing.position[0] + shift[0]), float(thing.position[1] + shift[1])
    found = placement.finder.find((x, y), named=thing.room)
    if found is None or found != (thing.room, (x, y)):
        return thing
    placement.count("moved out of the walls' thickness", metres)
    return replace(thing, position=(x, y, thing.position[2]))
