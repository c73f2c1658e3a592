"""ProcTHOR files as files: schemas, rooms, and hostile content."""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path
from typing import Any

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from procthor_samples import read, room, two_rooms, write, xyz

from lcrl_bench.errors import InvalidFileError, LcrlError
from lcrl_bench.houses.house import House, RoomType
from lcrl_bench.houses.procthor import import_procthor
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.storage import MAX_HOUSE_BYTES


def test_a_clean_house_imports_with_nothing_to_report_but_the_walls_thickness(tmp_path: Path):
    imported = read(two_rooms(), tmp_path)
    house = imported.house
    assert (house.id, house.source) == ("house", "procthor")
    assert [room.type for room in house.rooms] == [RoomType.KITCHEN, RoomType.BEDROOM]
    assert (imported.unmapped, imported.label_coverage) == ((), 1.0)
    assert imported.notes == ("1 object moved out of the walls' thickness (by up to 4.8 cm).",)


def test_a_clockwise_floor_becomes_counter_clockwise(tmp_path: Path):
    house = read(two_rooms(), tmp_path).house
    assert all(shapely.Polygon(room.polygon).exterior.is_ccw for room in house.rooms)
    assert set(house.rooms[0].polygon) == {(0, 0), (4, 0), (4, 4), (0, 4)}


def test_repeated_corners_of_a_floor_are_dropped(tmp_path: Path):
    value = two_rooms()
    value["rooms"][0]["floorPolygon"].append(value["rooms"][0]["floorPolygon"][0])
    value["rooms"][0]["floorPolygon"].insert(2, value["rooms"][0]["floorPolygon"][1])
    assert sorted(read(value, tmp_path).house.rooms[0].polygon) == [(0, 0), (0, 4), (4, 0), (4, 4)]


def test_a_file_is_read_the_same_each_time(tmp_path: Path):
    assert read(two_rooms(), tmp_path) == read(two_rooms(), tmp_path)


@pytest.mark.parametrize("metadata", ["missing", None, {}, {"schema": None}])
def test_a_file_that_states_no_schema_is_read_as_the_current_one_with_a_note(
    tmp_path: Path, metadata: Any
):
    value = two_rooms()
    value["metadata"] = metadata
    if metadata == "missing":
        del value["metadata"]
    imported = read(value, tmp_path)
    assert imported.house == replace_provenance(imported, two_rooms(), tmp_path)
    assert imported.notes[0] == "The file states no schema: read as 1.0.0."


def replace_provenance(imported: Any, value: dict, folder: Path) -> Any:
    house = read(value, folder).house
    house.provenance.update(imported.house.provenance)
    return house


@pytest.mark.parametrize("schema", ["0.0.1", "2.0.0", ""])
def test_another_schema_is_refused_with_the_way_to_upgrade(tmp_path: Path, schema: str):
    value = two_rooms()
    value["metadata"]["schema"] = schema
    with pytest.raises(InvalidFileError, match=r"is not 1\.0\.0 at metadata\.schema.*upgrade_hou"):
        read(value, tmp_path)


@pytest.mark.parametrize(
    ("key", "mark"), [("doors", "assetOffset"), ("windows", "assetOffset"), ("walls", "p0")]
)
def test_an_older_file_that_states_no_schema_is_recognised(tmp_path: Path, key: str, mark: str):
    value = two_rooms()
    del value["metadata"]
    value[key][0][mark] = xyz(0, 0, 0)
    with pytest.raises(InvalidFileError, match=f"have '{mark}': older than 1.0.0 at {key}"):
        read(value, tmp_path)


def test_an_empty_template_house_is_refused(tmp_path: Path):
    value = two_rooms() | {"rooms": [], "walls": [], "doors": [], "windows": [], "objects": []}
    with pytest.raises(InvalidFileError, match=r"has no rooms at rooms\. It is a template"):
        read(value, tmp_path)


def test_a_house_without_walls_is_refused(tmp_path: Path):
    value = two_rooms() | {"walls": [], "doors": [], "windows": []}
    with pytest.raises(InvalidFileError, match="no wall has a height at walls"):
        read(value, tmp_path)


def point_of(value: dict) -> dict:
    return value["objects"][0]["position"]


def break_number(number: float) -> Any:
    def change(value: dict) -> None:
        point_of(value)["x"] = number

    return change


def two_point_floor(value: dict) -> None:
    del value["rooms"][0]["floorPolygon"][2:]


def line_floor(value: dict) -> None:
    value["rooms"][0]["floorPolygon"] = [xyz(0, 0, 0), xyz(1, 0, 0), xyz(2, 0, 0)]


def bow_tie(value: dict) -> None:
    points = value["rooms"][0]["floorPolygon"]
    points[1], points[2] = points[2], points[1]


def missing_field(value: dict) -> None:
    del value["objects"][1]["position"]["z"]


def text_for_a_number(value: dict) -> None:
    point_of(value)["x"] = "2.0"


def list_for_an_object(value: dict) -> None:
    value["objects"][1] = [1, 2, 3]


def control_characters(value: dict) -> None:
    value["objects"][1]["assetId"] = "Chair\x1b[2J"


def lone_surrogate(value: dict) -> None:
    value["objects"][1]["id"] = "\ud800"


def too_many_rooms(value: dict) -> None:
    value["rooms"] = [room(f"room|{n}", "Kitchen", 0, 0, 4, 4) for n in range(201)]


def too_many_corners(value: dict) -> None:
    value["rooms"][0]["floorPolygon"] = [xyz(i, 0, i * i % 7) for i in range(501)]


def too_many_children(value: dict) -> None:
    # 21,021 objects, though no list of them is over its own limit.
    parent = {**value["objects"][0], "children": [value["objects"][1]] * 1000}
    value["objects"] = [parent] * 21


def long_string(value: dict) -> None:
    value["objects"][1]["id"] = "a" * 201


def duplicate_room(value: dict) -> None:
    value["rooms"][1]["id"] = value["rooms"][0]["id"]


HOSTILE = {
    "NaN": (break_number(math.nan), r"nan, which is not a finite number at objects\[0\]\.posit"),
    "infinity": (break_number(math.inf), r"inf, which is not a finite number at objects\[0\]\.po"),
    "huge": (break_number(1e300), r"less than or equal to 10000.* at objects\[0\]\.position\.x"),
    "huge integer": (break_number(10**400), r"beyond 64 bits at objects\[0\]\.position\.x"),
    "two corners": (two_point_floor, r"at least 3 items.* at rooms\[0\]\.floorPolygon"),
    "a line": (line_floor, r"has no area at rooms\[0\]\.floorPolygon"),
    "a bow tie": (bow_tie, r"crosses itself or has no area at rooms\[0\]\.floorPolygon"),
    "a missing field": (missing_field, r"Field required at objects\[1\]\.position\.z"),
    "text for a number": (text_for_a_number, r"found '2\.0' at objects\[0\]\.position\.x"),
    "a list for an object": (list_for_an_object, r"found \[1, 2, 3\] at objects\[1\]"),
    "control characters": (control_characters, r"match pattern.* at objects\[1\]\.assetId"),
    "a lone surrogate": (lone_surrogate, r"unicode.* at objects\[1\]\.id"),
    "too many rooms": (too_many_rooms, r"at most 200 items.* at rooms"),
    "too many corners": (too_many_corners, r"at most 500 items.* at rooms\[0\]\.floorPolygon"),
    "too many objects": (too_many_children, r"21021 objects are over the limit.* at objects"),
    "a long string": (long_string, r"at most 200 characters.* at objects\[1\]\.id"),
    "two rooms of one name": (duplicate_room, r"two rooms are called 'room\|1' at rooms\[1\]"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_with_its_place_and_a_way_out(tmp_path: Path, name: str):
    change, message = HOSTILE[name]
    value = two_rooms()
    change(value)
    with pytest.raises(InvalidFileError, match=message) as caught:
        read(value, tmp_path)
    assert str(caught.value).startswith(str(tmp_path / "house.json"))
    assert caught.value.where
    assert caught.value.fix
    assert "\x1b" not in str(caught.value)
    str(caught.value).encode()


def test_a_number_too_large_for_a_float_is_refused(tmp_path: Path):
    path = write(two_rooms(), tmp_path)
    path.write_text(path.read_text().replace('"x": 2.1', '"x": 1e999'))
    with pytest.raises(InvalidFileError, match=r"inf.* at objects\[0\]\.children\[0\]\.position"):
        import_procthor(path)


def test_a_deeply_nested_file_is_refused(tmp_path: Path):
    path = tmp_path / "deep.json"
    for text in ("[" * 100_000, '{"rooms":' * 500 + "1" + "}" * 500, "[" * 50 + "]" * 50):
        path.write_text(text)
        with pytest.raises(InvalidFileError, match="nested more than 32 deep"):
            import_procthor(path)


def test_a_huge_file_is_refused_unread(tmp_path: Path):
    path = tmp_path / "huge.json"
    with path.open("wb") as file:
        file.truncate(200 * 2**20)
    with pytest.raises(InvalidFileError, match=r"200\.0 MB is over the limit of 32\.0 MB"):
        import_procthor(path)
    assert MAX_HOUSE_BYTES == 32 * 2**20


def test_a_path_out_of_the_folder_in_an_asset_id_reaches_no_file(tmp_path: Path):
    value = two_rooms()
    value["objects"][1]["assetId"] = "../../../../etc/passwd"
    imported = read(value, tmp_path)
    assert imported.unmapped == ("../../../../etc/passwd",)
    assert imported.house.object("chair-1-1").label == "small_object"


TEXT = json.dumps(two_rooms())


@settings(max_examples=60)
@given(st.integers(0, len(TEXT) - 1))
def test_a_truncated_file_is_refused(length: int):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "house.json"
        path.write_text(TEXT[:length])
        with pytest.raises(InvalidFileError, match="not valid JSON"):
            import_procthor(path)


JUNK = st.sampled_from(
    [
        None, True, False, 0, -1, 1e-320, 1e308, -1e308, 2**70, math.nan, math.inf, "", "..",
        "\x00", "room|1", "exterior", "\ud800", "a" * 5000, [], {}, [[]], [None] * 3, {"x": 1},
        [[[[[[]]]]]], {"x": 0, "y": 0, "z": 0}, {"x": 1e9, "y": -1, "z": 3},
        [{"x": 0, "y": 0, "z": 0}] * 4, [0] * 3000,
    ]
)  # fmt: skip


def paths_in(value: Any, here: tuple = ()) -> list[tuple]:
    items = value.items() if isinstance(value, dict) else enumerate(value)
    below = [
        path
        for key, child in items
        if isinstance(child, dict | list)
        for path in paths_in(child, (*here, key))
    ]
    keys = value if isinstance(value, dict) else range(len(value))
    return [(*here, key) for key in keys] + below


PATHS = paths_in(two_rooms())
CHANGES = st.lists(
    st.tuples(st.sampled_from(PATHS), st.one_of(st.just("delete"), JUNK, st.floats())),
    min_size=1,
    max_size=3,
)


@settings(max_examples=400)
@given(CHANGES)
def test_a_damaged_file_is_a_valid_house_or_a_clear_error(changes: list[tuple[tuple, Any]]):
    value = two_rooms()
    for path, junk in changes:
        apply_change(value, path, junk)
    with tempfile.TemporaryDirectory() as folder:
        outcome = house_or_error(value, Path(folder))
        if isinstance(outcome, LcrlError):
            assert str(outcome).startswith(folder)
            assert str(outcome).encode()
        else:
            validate_house(outcome)


def house_or_error(value: Any, folder: Path) -> House | LcrlError:
    try:
        return read(value, folder).house
    except LcrlError as error:
        return error


def apply_change(value: Any, path: tuple, junk: Any) -> None:
    """Delete or replace what is at `path`, if an earlier change left it there."""
    try:
        for key in path[:-1]:
            value = value[key]
        if junk == "delete":
            del value[path[-1]]
        else:
            value[path[-1]] = junk
    except (KeyError, IndexError, TypeError):
        return
