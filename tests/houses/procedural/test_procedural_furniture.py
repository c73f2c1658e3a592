"""Laws of what stands on the floor and hangs on the walls."""

from __future__ import annotations

import itertools
import math

from shapely.geometry import LineString, Polygon

from lcrl_bench.houses.house import House, OpeningKind, PlacedObject, RoomType, Wall

DIVIDERS = {"tv_stand", "shelf"}
"""What may stand in the middle of a large room and part it."""
BACKS_TO_A_WALL = {
    "bed",
    "wardrobe",
    "dresser",
    "desk",
    "tv_stand",
    "refrigerator",
    "countertop",
    "base_cabinet",
    "stove",
    "sink",
    "toilet",
    "bathtub",
    "shower",
    "washing_machine",
    "dishwasher",
    "shelf",
}
NEEDED = {
    RoomType.BEDROOM: ({"bed"}, {"wardrobe", "dresser"}),
    RoomType.BATHROOM: ({"toilet"}, {"sink"}),
    RoomType.KITCHEN: ({"refrigerator"}, {"countertop"}, {"stove"}, {"sink"}),
    RoomType.LIVING_ROOM: ({"sofa"},),
    RoomType.DINING_ROOM: ({"dining_table"},),
    RoomType.OFFICE: ({"desk"},),
}


def on_the_floor(house: House) -> list[PlacedObject]:
    """What stands on the floor and takes room there: no rugs, nothing on walls."""
    return [
        thing
        for thing in house.objects
        if thing.support is None and thing.label != "rug" and thing.base < 0.02
    ]


def hanging(house: House) -> list[PlacedObject]:
    return [t for t in house.objects if t.support is None and t.base >= 0.02]


def footprint(thing: PlacedObject) -> Polygon:
    return Polygon(thing.footprint())


def front(thing: PlacedObject) -> tuple[float, float]:
    return -math.sin(thing.yaw), math.cos(thing.yaw)


def back_line(thing: PlacedObject, behind: float) -> LineString:
    """From the middle of a thing to `behind` metres behind its back."""
    (fx, fy), (x, y, _) = front(thing), thing.position
    far = thing.size[1] / 2 + behind
    return LineString([(x, y), (x - far * fx, y - far * fy)])


def wall_line(wall: Wall) -> LineString:
    return LineString([wall.start, wall.end])


def test_furniture_stands_on_the_floor(houses):
    for house in houses:
        for thing in on_the_floor(house):
            assert abs(thing.base) < 1e-9


def test_nothing_leaves_its_room_or_enters_a_wall(houses):
    for house in houses:
        floors = {r.id: Polygon(r.polygon).buffer(-0.0499, join_style="mitre") for r in house.rooms}
        for thing in house.objects:
            assert floors[thing.room].contains(footprint(thing)), (house.id, thing.id)


def test_only_seats_reach_under_tables_and_no_other_footprints_overlap(houses):
    for house in houses:
        for a, b in itertools.combinations(on_the_floor(house), 2):
            shared = footprint(a).intersection(footprint(b)).area
            seat = next((thing for thing in (a, b) if thing.label == "chair"), None)
            if seat is not None and {a.label, b.label} & {"dining_table", "desk"}:
                assert shared <= 0.35 * footprint(seat).area, (house.id, a.id, b.id)
            else:
                assert shared < 1e-6, (house.id, a.id, b.id)


def test_hanging_things_meet_neither_furniture_nor_each_other(houses):
    for house in houses:
        for thing in hanging(house):
            for other in house.objects:
                apart = other.base >= thing.top - 1e-9 or other.top <= thing.base + 1e-9
                if other is not thing and not apart:
                    shared = footprint(thing).intersection(footprint(other)).area
                    assert shared < 1e-6, (house.id, thing.id, other.id)


def test_rooms_hold_what_makes_them_such_rooms(houses):
    for house in houses:
        for room in house.rooms:
            labels = {thing.label for thing in house.objects if thing.room == room.id}
            for choice in NEEDED.get(room.type, ()):
                assert labels & choice, (house.id, room.id, choice)
            assert sum(thing.room == room.id for thing in on_the_floor(house)) >= 2


def test_backs_are_turned_to_walls(houses):
    for house in houses:
        walls = [wall_line(wall).buffer(0.05) for wall in house.walls]
        for thing in [*on_the_floor(house), *hanging(house)]:
            if thing.label in BACKS_TO_A_WALL or thing.base >= 0.02:
                line = back_line(thing, 0.06)
                at_wall = any(line.intersects(wall) for wall in walls)
                assert at_wall or thing.label in DIVIDERS, (house.id, thing.id)


def test_few_stands_and_shelves_part_a_room(houses):
    parts = [
        not any(
            back_line(thing, 0.06).intersects(wall_line(wall).buffer(0.05)) for wall in house.walls
        )
        for house in houses
        for thing in on_the_floor(house)
        if thing.label in DIVIDERS
    ]
    assert 0 < sum(parts) < 0.2 * len(parts)


def test_stairs_rise_to_a_wall_up_to_the_ceiling(houses):
    flights = [
        (house, thing)
        for house in houses
        for thing in on_the_floor(house)
        if thing.label == "stairs"
    ]
    assert 0.05 * len(houses) < len(flights) < 0.4 * len(houses)
    for house, flight in flights:
        walls = [wall_line(wall).buffer(0.08) for wall in house.walls]
        assert house.height - flight.top < 0.06
        assert any(wall.intersects(back_line(flight, 0.06)) for wall in walls), house.id


def test_large_furniture_stands_square_to_the_walls(houses):
    for house in houses:
        for thing in on_the_floor(house):
            if thing.label != "chair":
                turns = thing.yaw / (math.pi / 2)
                assert abs(turns - round(turns)) < 1e-9


def test_chairs_face_the_table_they_stand_at(houses):
    for house in houses:
        tables = [t for t in house.objects if t.label in ("dining_table", "desk")]
        for chair in on_the_floor(house):
            if chair.label != "chair":
                continue
            table = min(tables, key=lambda t: footprint(t).distance(footprint(chair)))
            assert footprint(table).distance(footprint(chair)) <= 0.35
            # Looking ahead from the seat one looks over the table.
            (x, y, _), (fx, fy) = chair.position, front(chair)
            assert LineString([(x, y), (x + 0.7 * fx, y + 0.7 * fy)]).intersects(footprint(table))


def test_chairs_of_a_house_that_stand_at_tables_are_alike(houses):
    for house in houses:
        sets = {t.size for t in house.objects if t.label == "chair" and t.source_label == ""}
        assert len(sets) <= 1


def test_most_beds_have_a_side_table_beside_the_head(houses):
    beds = near = 0
    for house in houses:
        for bed in (thing for thing in house.objects if thing.label == "bed"):
            (fx, fy), (x, y, _) = front(bed), bed.position
            for table in house.objects:
                if table.label == "side_table":
                    ahead = (table.position[0] - x) * fx + (table.position[1] - y) * fy
                    if footprint(table).distance(footprint(bed)) < 0.5 and ahead < 0:
                        near += 1
                        break
            beds += 1
    assert near >= 0.6 * beds


def test_most_sofas_face_a_television_or_its_stand(houses):
    sofas = facing = 0
    for house in houses:
        for sofa in (thing for thing in house.objects if thing.label == "sofa"):
            (fx, fy), (x, y, _) = front(sofa), sofa.position
            for other in house.objects:
                if other.room == sofa.room and other.label in ("television", "tv_stand"):
                    east, north = other.position[0] - x, other.position[1] - y
                    if east * fx + north * fy > 0.7 * math.hypot(east, north):
                        facing += 1
                        break
            sofas += 1
    assert facing >= 0.55 * sofas


def test_half_a_metre_before_each_door_is_clear_over_its_width(houses):
    for house in houses:
        for wall in house.walls:
            for opening in wall.openings:
                if opening.kind is OpeningKind.WINDOW:
                    continue
                hole = LineString([wall.point(opening.start), wall.point(opening.end)])
                clear = hole.buffer(0.55, cap_style="flat")
                for thing in on_the_floor(house):
                    assert not footprint(thing).intersects(clear), (house.id, thing.id)


def test_nothing_hangs_over_doors_or_before_windows(houses):
    for house in houses:
        for wall in house.walls:
            for opening in wall.openings:
                hole = LineString([wall.point(opening.start), wall.point(opening.end)])
                before = hole.buffer(0.2, cap_style="flat")
                for thing in hanging(house):
                    level = thing.base < opening.top and thing.top > opening.bottom
                    if level and thing.label != "curtain":
                        assert not footprint(thing).intersects(before), (house.id, thing.id)


def test_tall_furniture_leaves_windows_free(houses):
    for house in houses:
        for wall in house.walls:
            for opening in wall.openings:
                if opening.kind is not OpeningKind.WINDOW:
                    continue
                hole = LineString([wall.point(opening.start), wall.point(opening.end)])
                before = hole.buffer(0.3, cap_style="flat")
                for thing in on_the_floor(house):
                    if thing.label in ("wardrobe", "refrigerator") or thing.size[2] > 1.7:
                        assert not footprint(thing).intersects(before), (house.id, thing.id)
