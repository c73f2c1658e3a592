"""The laws of a house: each one is checked, and names the part that breaks it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from house_samples import DOOR, WINDOW, make_wall, rectangle, two_rooms, with_objects

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.house import House, Opening, OpeningKind, PlacedObject, Room, RoomType
from lcrl_bench.houses.validation import validate_house

BED = two_rooms().object("bed")


def bed(**changes: object) -> House:
    return with_objects(two_rooms(), replace(BED, **changes))


def floor(*polygon: tuple[float, float]) -> House:
    house = two_rooms(furnished=False)
    return replace(house, rooms=(Room("bedroom", RoomType.BEDROOM, polygon), house.rooms[1]))


def wall(*openings: Opening, **changes: object) -> House:
    made = make_wall("only", (0, 0), (3, 0), *openings)
    return replace(two_rooms(), walls=(replace(made, **changes),))


def stack(*supports: str | None) -> House:
    things = [replace(BED, id=f"b{i}", support=support) for i, support in enumerate(supports)]
    return with_objects(two_rooms(), *things)


BROKEN: dict[str, tuple[Callable[[], House], str]] = {
    "no rooms": (lambda: replace(two_rooms(), rooms=()), "no rooms"),
    "no height": (lambda: replace(two_rooms(), height=0.0), "height 0 is not positive"),
    "NaN height": (lambda: replace(two_rooms(), height=math.nan), "nan is not finite"),
    "a bad id": (lambda: replace(two_rooms(), id="Two Rooms"), "name 'Two Rooms' is not valid"),
    "a bad source": (lambda: replace(two_rooms(), source=".."), r"name '\.\.' is not valid"),
    "a bad object id": (lambda: bed(id="a/../b"), r"name 'a/\.\./b' is not valid"),
    "twin objects": (lambda: with_objects(two_rooms(), BED, BED), "two objects are called 'bed'"),
    "a flat floor": (lambda: floor((0, 0), (1, 0), (2, 0)), "no area .*room 'bedroom'"),
    "a point floor": (lambda: floor((0, 0), (0, 0), (1, 0)), "2 points has no area"),
    "a bow tie": (lambda: floor((0, 0), (1, 1), (1, 0), (0, 1)), "crosses itself"),
    "a clockwise floor": (lambda: floor(*rectangle(0, 0, 3, 3)[::-1]), "runs clockwise"),
    "a far floor": (lambda: floor((0, 0), (1e9, 0), (0, 1)), "beyond 10000"),
    "a wall without length": (lambda: wall(end=(0, 0)), "without extent .*wall 'only'"),
    "a wall without thickness": (lambda: wall(thickness=0.0), "without extent"),
    "a wall of no room": (lambda: wall(rooms=("attic",)), r"unknown rooms \['attic'\]"),
    "a hole past its wall": (lambda: wall(replace(DOOR, end=3.1)), "leaves its wall"),
    "a hole above its wall": (lambda: wall(replace(WINDOW, top=2.7)), "leaves its wall"),
    "a hole inside out": (lambda: wall(replace(DOOR, start=2.5)), "leaves its wall"),
    "a NaN hole": (lambda: wall(replace(DOOR, top=math.nan)), "nan is not finite"),
    "overlapping holes": (lambda: wall(DOOR, replace(WINDOW, start=1.5)), "two openings overlap"),
    "holes out of order": (
        lambda: wall(
            Opening(OpeningKind.DOOR, 2, 2.9, 0, 2), Opening(OpeningKind.DOOR, 0, 1, 0, 2)
        ),
        "two openings overlap",
    ),
    "a NaN object": (lambda: bed(yaw=math.nan), "nan is not finite .*object 'bed'"),
    "a flat object": (lambda: bed(size=(1.0, 0.0, 1.0)), "is not positive"),
    "a negative shape": (lambda: bed(shape=-1), "shape -1 is negative"),
    "an unknown class": (lambda: bed(label="throne"), "'throne' is not one of the 61"),
    "an unknown room": (lambda: bed(room="attic"), "unknown room 'attic'"),
    "an object outside": (lambda: bed(position=(3.5, 1.0, 0.3)), "outside its room 'bedroom'"),
    "an object below": (lambda: bed(position=(1.0, 1.0, 0.2)), "leaves the house"),
    "an object above": (lambda: bed(position=(1.0, 1.0, 2.7)), "leaves the house"),
    "an unknown support": (lambda: stack(None, "b9"), "unknown object 'b9' .*object 'b1'"),
    "its own support": (lambda: stack("b0"), "stands on itself"),
    "a circle of supports": (lambda: stack("b1", "b2", "b0"), r"\['b0', 'b1', 'b2'\]"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_law_is_named(name: str):
    make, message = BROKEN[name]
    with pytest.raises(InvalidHouseError, match=message):
        validate_house(make())


@pytest.mark.parametrize(
    "house",
    [
        two_rooms(),
        two_rooms(furnished=False),
        bed(position=(3.01, 1.0, 0.3)),  # a centimetre of rounding
        bed(position=(1.0, 1.0, 0.29)),
        wall(replace(DOOR, end=3.0)),
        wall(replace(DOOR, end=1.5), Opening(OpeningKind.WINDOW, 1.5, 2.5, 1.0, 2.0)),
        stack(None, "b0", "b1", "b0"),
    ],
)
def test_a_house_that_keeps_every_law_passes(house: House):
    validate_house(house)


def test_a_tall_stack_is_checked_without_recursion():
    things = [
        PlacedObject(f"b{i}", "book", "bedroom", (1, 1, 0.1), (0.1, 0.1, 0.1), 0, f"b{i + 1}")
        for i in range(5000)
    ]
    last = replace(things[0], id="b5000", support=None)
    validate_house(with_objects(two_rooms(), *things, last))
