"""Sets objects on furniture down on the furniture's own faces.

Files store poses from before physics settled, up to 6 cm above the table, and our furniture has
mattresses, seats and shelves at its own heights (`assets/receptacles.toml`).
"""

from __future__ import annotations

import math
from dataclasses import replace

from lcrl_bench.houses.house import PlacedObject, Point
from lcrl_bench.houses.receptacles import Face, faces

_DROP = 0.5
"""Largest drop onto a face, in metres: mattress heights differ that much."""

_RAISE = 0.05
_SIDEWAYS = 0.15
_DROP_ONTO_BOX = 0.07


def rest(thing: PlacedObject, under: PlacedObject) -> PlacedObject:
    """`thing`, set down on the nearest face of `under` that it can be meant to stand on.

    Things elsewhere, such as in a drawer, in a refrigerator or beside a bed, stay where they are.
    """
    options = faces(under)
    if not options:
        return _rest_on_box(thing, under)
    face = min(options, key=lambda face: abs(thing.base - face.height))
    gap = thing.base - face.height
    # A thing whose centre is above a face stands on it, not under it.
    if not -max(_RAISE, thing.size[2] / 2) <= gap <= _DROP:
        return thing
    across, along = _local(thing.position[:2], face.center, face.yaw)
    x, y = _over_face(face, across, along)
    z = face.height + thing.size[2] / 2
    if math.dist((x, y), thing.position[:2]) <= _SIDEWAYS:
        return replace(thing, position=(x, y, z))
    # Farther from the face, it keeps its place if that is over the furniture at all: a pillow at
    # # the head of a bed.
    return replace(thing, position=(*thing.position[:2], z)) if over(thing, under) else thing


def over(thing: PlacedObject, under: PlacedObject) -> bool:
    """Whether a thing's centre lies in the box of `under` in plan."""
    across, along = _local(thing.position[:2], under.position[:2], under.yaw)
    return abs(across) <= under.size[0] / 2 and abs(along) <= under.size[1] / 2


def _over_face(face: Face, across: float, along: float) -> Point:
    """The point of a face nearest to a point given in the face's axes."""
    (half_across, half_along), (x, y) = face.half, face.center
    across = min(max(across, -half_across), half_across)
    along = min(max(along, -half_along), half_along)
    cos, sin = math.cos(face.yaw), math.sin(face.yaw)
    return x + across * cos - along * sin, y + across * sin + along * cos


def _rest_on_box(thing: PlacedObject, under: PlacedObject) -> PlacedObject:
    """Rest on the top of furniture without faces (a toilet, a basin), if that is near."""
    if not 0 < thing.base - under.top <= _DROP_ONTO_BOX:
        return thing
    x, y, _ = thing.position
    return replace(thing, position=(x, y, under.top + thing.size[2] / 2))


def _local(point: Point, center: Point, yaw: float) -> Point:
    """A point in the frame of an object at `center`, turned by `yaw`."""
    dx, dy = point[0] - center[0], point[1] - center[1]
    cos, sin = math.cos(yaw), math.sin(yaw)
    return dx * cos + dy * sin, dy * cos - dx * sin
