"""Small houses written by hand, for tests anywhere in the suite."""

from __future__ import annotations

from dataclasses import replace

from lcrl_bench.houses.house import (
    House,
    Opening,
    OpeningKind,
    PlacedObject,
    Point,
    Room,
    RoomType,
    Wall,
)

HEIGHT = 2.6
THICKNESS = 0.1
DOOR = Opening(OpeningKind.DOOR, 1.0, 2.0, 0.0, 2.05)
WINDOW = Opening(OpeningKind.WINDOW, 1.0, 2.2, 0.9, 2.0)


def make_wall(
    name: str, start: Point, end: Point, *openings: Opening, rooms: tuple[str, ...] = ()
) -> Wall:
    """A wall of the usual height and thickness."""
    return Wall(name, start, end, HEIGHT, THICKNESS, openings, rooms)


def rectangle(west: float, south: float, east: float, north: float) -> tuple[Point, ...]:
    """The corners of a rectangle, counter-clockwise."""
    return (west, south), (east, south), (east, north), (west, north)


def two_rooms(*between: Opening, furnished: bool = True) -> House:
    """A bedroom (west) and a kitchen (east), 3 m square each, and a wall with openings between.

    Args:
        between: Openings of the wall between the rooms; a door if none is given.
        furnished: Whether a bed, a table with a cup, a chair and a rug stand in it.
    """
    bedroom = Room("bedroom", RoomType.BEDROOM, rectangle(0, 0, 3, 3))
    kitchen = Room("kitchen", RoomType.KITCHEN, rectangle(3, 0, 6, 3))
    walls = (
        make_wall("south-west", (0, 0), (3, 0), rooms=("bedroom",)),
        make_wall("south-east", (3, 0), (6, 0), WINDOW, rooms=("kitchen",)),
        make_wall("east", (6, 0), (6, 3), rooms=("kitchen",)),
        make_wall("north-east", (6, 3), (3, 3), rooms=("kitchen",)),
        make_wall("north-west", (3, 3), (0, 3), WINDOW, rooms=("bedroom",)),
        make_wall("west", (0, 3), (0, 0), rooms=("bedroom",)),
        make_wall("middle", (3, 0), (3, 3), *(between or (DOOR,)), rooms=("bedroom", "kitchen")),
    )
    objects = (
        PlacedObject("bed", "bed", "bedroom", (0.8, 2.2, 0.3), (1.4, 1.4, 0.6), 0.0),
        PlacedObject("table", "dining_table", "kitchen", (5.2, 2.3, 0.375), (1.2, 0.8, 0.75), 0.0),
        PlacedObject("cup", "cup", "kitchen", (5.3, 2.2, 0.8), (0.08, 0.08, 0.1), 0.4, "table"),
        PlacedObject("chair", "chair", "kitchen", (5.2, 1.5, 0.45), (0.45, 0.45, 0.9), 0.0),
        PlacedObject("rug", "rug", "bedroom", (1.6, 0.8, 0.01), (1.6, 1.0, 0.02), 0.0),
    )
    return House(
        "two-rooms", "sample", (bedroom, kitchen), walls, objects if furnished else (), HEIGHT
    )


def without_wall(house: House, name: str) -> House:
    """The house with one wall taken away."""
    return replace(house, walls=tuple(wall for wall in house.walls if wall.id != name))


def with_objects(house: House, *things: PlacedObject) -> House:
    """The house with these objects instead of its own."""
    return replace(house, objects=things)
