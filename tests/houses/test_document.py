"""House JSON: lossless, the same bytes for the same house, and strict about everything else."""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from house_samples import DOOR, HEIGHT, make_wall, rectangle, two_rooms
from hypothesis import given, settings
from hypothesis import strategies as st

from lcrl_bench.errors import InvalidFileError, InvalidHouseError, LcrlError
from lcrl_bench.houses.classes import class_names
from lcrl_bench.houses.document import (
    house_digest,
    house_to_json,
    import_lcrl,
    parse_house,
    read_house,
    write_house,
)
from lcrl_bench.houses.house import House, PlacedObject, Room, RoomType
from lcrl_bench.houses.validation import validate_house

LINES = st.text(st.characters(exclude_categories=["Cc", "Cs"]), max_size=40)
NUMBERS = st.floats(-10_000, 10_000)


@st.composite
def placed_objects(draw: st.DrawFn, rooms: tuple[Room, ...], count: int) -> tuple:
    things: list[PlacedObject] = []
    for number in range(count):
        room = draw(st.sampled_from(rooms))
        (west, south), (east, north) = room.polygon[0], room.polygon[2]
        share = st.floats(0, 1)
        size = draw(st.tuples(*[st.floats(1e-9, 2)] * 3))
        x = min(west + draw(share) * (east - west), east)
        y = min(south + draw(share) * (north - south), north)
        z = draw(st.floats(size[2] / 2, HEIGHT))
        thing = PlacedObject(
            id=f"thing-{number}",
            label=draw(st.sampled_from(sorted(class_names()))),
            room=room.id,
            position=(x, y, z),
            size=size,
            yaw=draw(st.one_of(NUMBERS, st.just(-0.0))),
            support=draw(st.sampled_from([None, *(other.id for other in things)])),
            shape=draw(st.integers(0, 2**31 - 1)),
            source_label=draw(LINES),
        )
        things.append(thing)
    return tuple(things)


@st.composite
def houses(draw: st.DrawFn) -> House:
    """Rooms in a row, each with a wall and a door south of it, and objects anywhere in them."""
    rooms, walls, west = [], [], draw(st.floats(-100, 100))
    for number in range(draw(st.integers(1, 4))):
        east, north = west + draw(st.floats(2.5, 9)), draw(st.floats(1, 9))
        kind = draw(st.sampled_from(RoomType))
        rooms.append(Room(f"room-{number}", kind, rectangle(west, 0.0, east, north)))
        name = f"wall-{number}"
        walls.append(make_wall(name, (west, 0.0), (east, 0.0), DOOR, rooms=(f"room-{number}",)))
        west = east
    return House(
        id=draw(st.from_regex(r"[a-z0-9][a-z0-9_-]{0,79}", fullmatch=True)),
        source="sample",
        rooms=tuple(rooms),
        walls=tuple(walls),
        objects=draw(placed_objects(tuple(rooms), draw(st.integers(0, 5)))),
        height=HEIGHT,
        provenance=draw(st.dictionaries(LINES, LINES, max_size=3)),
    )


@given(houses())
def test_a_house_comes_back_from_its_file_bit_for_bit(house: House):
    with tempfile.TemporaryDirectory() as folder:
        path, again = Path(folder) / "house.json", Path(folder) / "again.json"
        write_house(path, house)
        copy = read_house(path)
        write_house(again, copy)
        assert path.read_bytes() == again.read_bytes()
    assert copy == house
    assert repr(copy) == repr(house)  # tells -0.0 from 0.0
    assert house_digest(copy) == house_digest(house)


def test_importing_house_json_loses_nothing_and_reports_nothing(tmp_path: Path):
    write_house(tmp_path / "house.json", two_rooms())
    imported = import_lcrl(tmp_path / "house.json")
    assert imported.house == two_rooms()
    assert (imported.unmapped, imported.label_coverage, imported.notes) == ((), 1.0, ())


def test_equal_houses_have_one_digest_and_others_another():
    house = two_rooms()
    bed = house.object("bed")
    zero = replace(house, objects=(replace(bed, yaw=-0.0), *house.objects[1:]))
    turned = replace(house, objects=(replace(bed, yaw=1e-300), *house.objects[1:]))
    assert zero == house
    assert house_digest(zero) == house_digest(house)
    assert house_digest(turned) != house_digest(house)


def test_a_house_that_breaks_a_law_is_not_written(tmp_path: Path):
    house = two_rooms()
    broken = [
        replace(house, height=math.nan),
        replace(house, id="Two Rooms"),
        replace(house, rooms=()),
        replace(house, objects=(replace(house.objects[0], label="throne"),)),
        replace(house, objects=(replace(house.objects[0], source_label="\x1b[2J"),)),
    ]
    for case in broken:
        with pytest.raises(InvalidHouseError):
            write_house(tmp_path / "house.json", case)
    assert list(tmp_path.iterdir()) == []


def test_what_can_not_be_written_is_named():
    house = two_rooms()
    broken = replace(house, objects=(*house.objects, replace(house.objects[0], yaw=math.inf)))
    with pytest.raises(InvalidHouseError, match=r"finite number \(objects\[5\]\.yaw\)"):
        house_to_json(broken)


def change(*path: str | int, to: object) -> Callable[[dict], None]:
    def apply(value: Any) -> None:
        for key in path[:-1]:
            value = value[key]
        value[path[-1]] = to

    return apply


def duplicate_object(value: dict) -> None:
    value["objects"].append(dict(value["objects"][0]))


REFUSED = {
    "another format": (change("format", to="house"), "'lcrl-house', found 'house' at format"),
    "another version": (change("version", to=2), "Input should be 1, found 2 at version"),
    "an unknown key": (change("owner", to="me"), "Extra inputs .* at owner"),
    "an id with ..": (change("rooms", 0, "id", to="a..b"), r"without '\.\.', found 'a\.\.b' at "),
    "an id as a path": (change("objects", 0, "id", to="../x"), r"found '\.\./x' at objects\[0\]"),
    "a line break in an id": (change("id", to="house\n"), r"found 'house\\n' at id"),
    "text for a number": (change("height", to="2.6"), "valid number, found '2.6' at height"),
    "true for a number": (change("height", to=True), "valid number, found True at height"),
    "a fraction of a shape": (change("objects", 0, "shape", to=1.5), r"1\.5 at objects\[0\]\.sh"),
    "true for a shape": (change("objects", 0, "shape", to=True), r"True at objects\[0\]\.shape"),
    "two coordinates": (change("objects", 0, "position", to=[1, 2]), r"at objects\[0\]\.position"),
    "a far coordinate": (change("rooms", 0, "polygon", 1, 0, to=2e4), "less than or equal to 100"),
    "no size": (change("objects", 0, "size", 1, to=0), r"greater than 0.*objects\[0\]\.size\[1\]"),
    "two corners": (change("rooms", 0, "polygon", to=[[0, 0], [1, 0]]), "at least 3 items"),
    "a room type": (change("rooms", 0, "type", to="throne room"), "'bedroom', 'bathroom'"),
    "an opening": (change("walls", 1, "openings", 0, "kind", to="gate"), "'door', 'doorway'"),
    "three rooms": (change("walls", 0, "rooms", to=["bedroom"] * 3), "at most 2 items"),
    "control characters": (change("objects", 0, "source_label", to="\x07"), "match pattern"),
    "a long note": (change("provenance", to={"a": "b" * 2001}), "at most 2000 characters"),
    "an unknown class": (change("objects", 0, "label", to="throne"), "not one of the 61 classes"),
    "outside its room": (change("objects", 0, "position", 0, to=999), r"lies outside its room 'be"),
    "two objects": (duplicate_object, "two objects are called 'bed'"),
    "too many objects": (change("objects", to=[0] * 20_001), "at most 20000 items"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_house_json_is_refused_with_its_place(name: str):
    apply, message = REFUSED[name]
    value = house_to_json(two_rooms())
    apply(value)
    with pytest.raises(InvalidFileError, match=message) as caught:
        parse_house(value, path="some.json")
    assert str(caught.value).startswith("some.json: ")
    assert caught.value.fix


def test_several_faults_are_counted():
    value = house_to_json(two_rooms()) | {"id": "", "height": -1}
    with pytest.raises(InvalidFileError, match=r"\(and 1 more\)"):
        parse_house(value, path="some.json")


@pytest.mark.parametrize("value", [None, [], 3, "house", {}, [[[]]]])
def test_any_other_json_is_refused(value: object):
    with pytest.raises(InvalidFileError, match="not a House JSON"):
        parse_house(value, path="some.json")


def test_notes_may_have_line_breaks():
    house = replace(two_rooms(), provenance={"notes": "one\n\ttwo"})
    assert parse_house(house_to_json(house), path="some.json") == house


SAMPLE = json.dumps(house_to_json(two_rooms()))
JUNK = st.sampled_from(
    [
        None, True, -1, 0, 2**63, 1e308, 1e-320, "", "..", "\x00", "bed", "\ud800", "a" * 3000,
        [], {}, [0, 0], [[0, 0]] * 4, [[[[[]]]]], [None], {"a": 1}, [0] * 3000,
    ]
)  # fmt: skip


def places_in(value: Any, here: tuple = ()) -> list[tuple]:
    if not isinstance(value, dict | list):
        return [here]
    items = value.items() if isinstance(value, dict) else enumerate(value)
    return ([here] if here else []) + [
        place for key, child in items for place in places_in(child, (*here, key))
    ]


PLACES = places_in(json.loads(SAMPLE))


@settings(max_examples=400)
@given(st.lists(st.tuples(st.sampled_from(PLACES), JUNK | NUMBERS | st.just("delete"))))
def test_a_damaged_house_json_is_a_valid_house_or_a_clear_error(changes: list):
    value = json.loads(SAMPLE)
    for place, junk in changes:
        damage(value, place, junk)
    outcome = house_or_error(value)
    if isinstance(outcome, LcrlError):
        assert str(outcome).startswith("some.json: ")
    else:
        validate_house(outcome)
        assert parse_house(house_to_json(outcome), path="some.json") == outcome


def house_or_error(value: object) -> House | LcrlError:
    try:
        return parse_house(value, path="some.json")
    except LcrlError as error:
        return error


def damage(value: Any, place: tuple, junk: object) -> None:
    try:
        for key in place[:-1]:
            value = value[key]
        if junk == "delete":
            del value[place[-1]]
        else:
            value[place[-1]] = junk
    except (KeyError, IndexError, TypeError):
        return


def test_the_example_in_the_documentation_is_a_valid_house(repository: Path):
    text = (repository / "docs" / "importing-a-house.md").read_text("utf-8")
    example = text.split("```json\n")[1].split("```")[0]
    house = parse_house(json.loads(example), path="the example")
    assert [room.id for room in house.rooms] == ["bedroom", "kitchen"]
    assert house.object("cup").base == pytest.approx(house.object("table").top)
