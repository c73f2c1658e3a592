"""Free places for an object on furniture, within reach: place B of a PICK task."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from shapely.geometry import Polygon

from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.receptacles import Face, faces
from lcrl_bench.scenes.scene import Scene

CLEARANCE = 0.02
"""Metres left free around a placed object."""
LIFT = 0.001
"""Metres between the object and the face, so that faces of different classes don't coincide."""
STEPS = np.linspace(-1, 1, 9)
PLACES_TRIED = 12
"""Maximum number of free places tried per piece of furniture."""


def supports_of(house: House, instances: Iterable[str], *, rooms: bool) -> list[PlacedObject]:
    """The receptacles among some objects, or among the objects in some rooms.

    Args:
        house: The house.
        instances: Ids of objects, or of rooms.
        rooms: Whether the ids are those of rooms.
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
    """Free places on some supports, within reach, but never from a tile that reaches the object.

    Yields nothing if the object itself is not reachable.
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
    """Yield `thing` at free places on `support`, from the middle outwards.

    A place is free if the object's footprint stays on the face and touches nothing else in the
    space above it.
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
            level = [
                shape
                for shape, base, top in obstacles
                if base < placed.top and top > placed.base + LIFT
            ]
            if not level or _is_clear(placed, level):
                yield placed


def _is_clear(placed: PlacedObject, others: Sequence[Polygon]) -> bool:
    """Whether an object keeps its distance, in plan, from all others."""
    footprint = Polygon(placed.footprint()).buffer(CLEARANCE)
    return not any(other.intersects(footprint) for other in others)


def _lattice(face: Face, thing: PlacedObject) -> Iterator[tuple[float, float]]:
    """Positions as shares of the face's half extents, with the object entirely on the face."""
    room = [1 - size / 2 / half for size, half in zip(thing.size[:2], face.half, strict=True)]
    if min(room) < 0:
        return
    points = [(a * room[0], b * room[1]) for a in STEPS for b in STEPS]
    # Ties: nearest to the front edge first, as that is where the agent stands.
    yield from sorted(set(points), key=lambda point: (abs(point[0]) + abs(point[1]), -point[1]))


def _headroom(face: Face, support: PlacedObject) -> float:
    """Free height above a face: up to the next shelf, else unbounded."""
    above = [other.height for other in faces(support) if other.height > face.height + 1e-6]
    return min(above) - face.height - 0.04 if above else np.inf


def _obstacles(
    house: House, thing: PlacedObject, support: PlacedObject
) -> list[tuple[Polygon, float, float]]:
    """Footprint, base and top of everything in the room except the object and its support."""
    others = (
        other
        for other in house.objects
        if other.id not in {thing.id, support.id} and other.room == support.room
    )
    return [(Polygon(other.footprint()), other.base, other.top) for other in others]
