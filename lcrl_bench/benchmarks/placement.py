"""Finding a free place for an object on furniture, within reach: place B of a PICK task."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from shapely.geometry import Polygon

from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.receptacles import Face, faces
from lcrl_bench.scenes.scene import Scene

CLEARANCE = 0.02
"""Metres left free around a placed object."""
LIFT = 0.001
"""Metres it floats above the face, so that no two faces of different classes coincide."""
STEPS = np.linspace(-1, 1, 9)
PLACES_TRIED = 12
"""Free places looked at on one piece of furniture before the next piece is tried."""


def supports_of(house: House, instances: Iterable[str], *, rooms: bool) -> list[PlacedObject]:
    """What of some objects, or of what stands in some rooms, one can put something on.

    Args:
        house: The house.
        instances: Ids of objects, or of rooms.
        rooms: Whether they are those of rooms.
    """
    chosen = set(instances)
    return [
        thing
        for thing in house.objects
        if (thing.room if rooms else thing.id) in chosen and faces(thing)
    ]


def places_apart(
    scene: Scene, thing: PlacedObject, supports: Iterable[PlacedObject]
) -> Iterator[PlacedObject]:
    """Free places on some supports that are within reach, but never together with the object's own.

    Yields nothing for an object that is within reach from nowhere.
    """
    reach_a = scene.reach(thing)
    if not reach_a.any():
        return
    for support in supports:
        places = free_placements(scene.house, thing, support)
        for placed in itertools.islice(places, PLACES_TRIED):
            reach_b = scene.reach(placed)
            if reach_b.any() and not (reach_a & reach_b).any():
                yield placed


def free_placements(
    house: House, thing: PlacedObject, support: PlacedObject
) -> Iterator[PlacedObject]:
    """Yield `thing` at free places on `support`: middle first, then outwards.

    A place is free where the object's footprint stays on the face and touches nothing else that
    reaches into the space above it.
    """
    obstacles = _obstacles(house, thing, support)
    for face in reversed(faces(support)):
        if _headroom(face, support) < thing.size[2] + CLEARANCE:
            continue
        for across, along in _lattice(face, thing):
            x, y = face.point(across, along)
            placed = replace(
                thing,
                position=(x, y, face.height + LIFT + thing.size[2] / 2),
                yaw=support.yaw,
                room=support.room,
                support=support.id,
            )
            footprint = Polygon(placed.footprint()).buffer(CLEARANCE)
            overlapping = (
                shape.intersects(footprint)
                for shape, base, top in obstacles
                if base < placed.top and top > placed.base + LIFT
            )
            if not any(overlapping):
                yield placed


def _lattice(face: Face, thing: PlacedObject) -> Iterator[tuple[float, float]]:
    """Shares of the face's half extents at which the object still lies wholly on it."""
    room = [1 - size / 2 / half for size, half in zip(thing.size[:2], face.half, strict=True)]
    if min(room) < 0:
        return
    points = [(a * room[0], b * room[1]) for a in STEPS for b in STEPS]
    # Near the front edge first among equals: that is where the agent stands.
    yield from sorted(set(points), key=lambda point: (abs(point[0]) + abs(point[1]), -point[1]))


def _headroom(face: Face, support: PlacedObject) -> float:
    """Free height above a face: up to the next face of a shelf, else unbounded."""
    above = [other.height for other in faces(support) if other.height > face.height + 1e-6]
    return min(above) - face.height - 0.04 if above else np.inf


def _obstacles(
    house: House, thing: PlacedObject, support: PlacedObject
) -> list[tuple[Polygon, float, float]]:
    """Footprint, base and top of everything in the room but the object and its support."""
    others = (
        other
        for other in house.objects
        if other.id not in {thing.id, support.id} and other.room == support.room
    )
    return [(Polygon(other.footprint()), other.base, other.top) for other in others]
