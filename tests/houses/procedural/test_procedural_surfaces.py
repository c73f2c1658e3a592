"""Laws of what stands on furniture, the 14 objects of tasks above all."""

from __future__ import annotations

import itertools
import math
from collections import Counter

from shapely.geometry import Polygon

from lcrl_bench.houses.classes import class_names, task_objects
from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.houses.procedural.walkability import walk
from lcrl_bench.houses.receptacles import Face, faces

NOT_BUILT = {"void", "wall", "floor", "ceiling", "door", "door_frame", "window"}


def standing(house: House) -> list[PlacedObject]:
    return [thing for thing in house.objects if thing.support is not None]


def face_below(house: House, thing: PlacedObject) -> Face:
    assert thing.support is not None
    levels = faces(house.object(thing.support))
    return min(levels, key=lambda face: abs(face.height - thing.base))


def test_things_touch_the_face_they_stand_on(houses):
    for house in houses:
        for thing in standing(house):
            assert abs(face_below(house, thing).height - thing.base) < 1e-6, (house.id, thing.id)


def test_things_stand_wholly_inside_their_face(houses):
    for house in houses:
        for thing in standing(house):
            face = face_below(house, thing)
            corners = [face.point(a, b) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            assert Polygon(corners).buffer(1e-6).contains(Polygon(thing.footprint()))


def test_things_stand_in_the_room_of_their_support(houses):
    for house in houses:
        for thing in standing(house):
            assert house.object(thing.support or "").room == thing.room


def test_things_on_one_piece_of_furniture_do_not_overlap(houses):
    for house in houses:
        for a, b in itertools.combinations(standing(house), 2):
            level = a.base < b.top - 1e-9 and b.base < a.top - 1e-9
            if a.support == b.support and level:
                shared = Polygon(a.footprint()).intersection(Polygon(b.footprint())).area
                assert shared < 1e-9, (house.id, a.id, b.id)


def test_what_stands_in_a_shelf_fits_below_the_board_above(houses):
    for house in houses:
        for thing in standing(house):
            levels = [face.height for face in faces(house.object(thing.support or ""))]
            above = [height for height in levels if height > thing.base + 1e-6]
            assert not above or thing.top < min(above)


def test_task_objects_are_many_and_mostly_single_or_in_pairs(houses):
    counts: Counter[int] = Counter()
    for house in houses:
        found = Counter(t.label for t in house.objects if t.label in task_objects())
        assert 8 <= len(found) <= 12
        assert max(found.values()) <= 3
        counts.update(found.values())
    assert counts[1] + counts[2] >= 0.85 * counts.total()


def test_task_objects_stand_on_furniture_within_reach(houses):
    for house in houses:
        points = walk(house).points
        for thing in house.objects:
            if thing.label in task_objects():
                assert thing.support is not None
                x, y = thing.position[:2]
                assert min(math.dist((x, y), p) for p in points.tolist()) <= 0.9


def test_kitchen_things_stand_in_kitchens(houses):
    for house in houses:
        for thing in house.objects:
            if thing.label in ("kettle", "toaster", "pan", "microwave", "coffee_machine"):
                assert thing.room == "kitchen"


def test_pillows_lie_on_beds_and_seats(houses):
    for house in houses:
        for thing in house.objects:
            if thing.label == "pillow":
                owner = house.object(thing.support or "")
                assert owner.label in ("bed", "sofa", "armchair")


def test_houses_hold_as_many_things_as_homes(houses):
    counts = [len(house.objects) for house in houses]
    assert min(counts) >= 40
    assert max(counts) <= 140
    assert 60 <= sorted(counts)[len(counts) // 2] <= 105


def test_all_classes_that_can_be_placed_occur(houses):
    seen = {thing.label for house in houses for thing in house.objects}
    assert set(class_names()) - NOT_BUILT - seen <= {"column"}
