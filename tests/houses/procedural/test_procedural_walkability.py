"""Laws of walking: checked on the finished house, and shown to fail where a house is spoilt."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lcrl_bench.houses.house import PASSABLE, PlacedObject, RoomType
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.houses.procedural.walkability import TILE, faults, walk


@pytest.fixture(scope="module")
def house():
    return generate_house(3)


def test_every_house_can_be_walked(houses):
    for house in houses:
        assert faults(house) == []


def test_every_room_has_free_tiles_and_is_reached(houses):
    for house in houses:
        found = walk(house)
        assert (found.groups == 0).all()
        for room in house.rooms:
            fewest = 2 if room.type is RoomType.BATHROOM else 4
            assert found.rooms.count(room.id) >= fewest


def test_both_sides_of_every_door_are_free(houses):
    for house in houses:
        steps = walk(house)
        crossed = {frozenset((steps.rooms[a], steps.rooms[b])) for a, b in steps.steps.tolist()}
        for wall in house.walls:
            if any(opening.kind in PASSABLE for opening in wall.openings):
                assert frozenset(wall.rooms) in crossed, (house.id, wall.id)


def test_about_half_of_the_floor_stays_free(houses):
    shares = sorted(len(w.points) / sum(w.tiles.values()) for w in map(walk, houses))
    assert 0.48 <= shares[len(shares) // 2] <= 0.72


def test_rooms_are_left_only_through_openings(house):
    walls = tuple(replace(wall, openings=()) for wall in house.walls)
    found = walk(replace(house, walls=walls))
    assert all(found.rooms[a] == found.rooms[b] for a, b in found.steps.tolist())


def test_a_walled_up_door_is_a_fault(house):
    doors = [w for w in house.walls if any(o.kind in PASSABLE for o in w.openings)]
    for door in doors:
        walls = tuple(replace(w, openings=()) if w is door else w for w in house.walls)
        assert any("can't be reached" in fault for fault in faults(replace(house, walls=walls)))


def test_a_wardrobe_in_a_door_is_a_fault(house):
    door = next(w for w in house.walls if any(o.kind in PASSABLE for o in w.openings))
    opening = next(o for o in door.openings if o.kind in PASSABLE)
    x, y = door.point((opening.start + opening.end) / 2)
    width = opening.end - opening.start
    plug = PlacedObject("plug", "wardrobe", door.rooms[0], (x, y, 1.0), (width, width, 2.0), 0.0)
    assert faults(replace(house, objects=(*house.objects, plug)))


def test_things_high_on_the_wall_and_rugs_are_no_obstacle(house):
    room = house.rooms[0]
    x, y = walk(house).points[walk(house).rooms.index(room.id)]
    before = len(walk(house).points)
    for base, height in ((1.5, 0.5), (0.0, 0.02)):
        size = (TILE, TILE, height)
        thing = PlacedObject("it", "rug", room.id, (x, y, base + height / 2), size, 0.0)
        assert len(walk(replace(house, objects=(*house.objects, thing))).points) == before


def test_furniture_out_of_reach_is_a_fault(house):
    # A box over every tile of a room but those at its far end hides what stands behind it.
    points = walk(house)
    room = max(house.rooms, key=lambda r: points.rooms.count(r.id))
    blocks = [
        PlacedObject(f"box-{n}", "dresser", room.id, (x, y, 0.5), (0.6, 0.6, 1.0), 0.0)
        for n, (x, y) in enumerate(points.points.tolist())
        if points.rooms[n] == room.id
    ]
    said = faults(replace(house, objects=(*house.objects, *blocks)))
    assert any("free tiles, fewer than" in fault for fault in said)
    assert any("can't be reached" in fault for fault in said)
