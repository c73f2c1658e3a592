"""Import of a ProcTHOR house file as a `House`."""

from __future__ import annotations

from pathlib import Path

from lcrl_bench.errors import InvalidFileError, InvalidHouseError
from lcrl_bench.houses.house import House
from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.houses.procthor.models import SOURCE
from lcrl_bench.houses.procthor.objects import place_objects
from lcrl_bench.houses.procthor.rooms import build_rooms
from lcrl_bench.houses.procthor.schema import SCHEMA, parse_record, stated_schema
from lcrl_bench.houses.procthor.walls import build_walls
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.names import slug
from lcrl_bench.storage import MAX_HOUSE_BYTES, canonical_json, read_json, sha256_of


def import_procthor(path: Path) -> ImportedHouse:
    """Read a ProcTHOR house file.

    The house keeps the file's coordinates (x stays x, Unity's z becomes y, its y becomes z) and is
    named after the file.

    Args:
        path: A JSON file of schema 1.0.0.

    Raises:
        InvalidFileError: If the file can't be read as such a house, or the house is invalid.
    """
    path = Path(path)
    value = read_json(path, max_bytes=MAX_HOUSE_BYTES)
    record = parse_record(value, path=path)
    rooms = build_rooms(record, path=path)
    walls = build_walls(record, {key: room.id for key, room in rooms.items()}, path=path)
    objects = place_objects(record, rooms, walls.walls, walls.height)
    house = House(
        id=slug(path.stem),
        source=SOURCE,
        rooms=tuple(rooms.values()),
        walls=walls.walls,
        objects=tuple(objects.placed),
        height=walls.height,
        provenance={
            "format": f"ProcTHOR house JSON, schema {SCHEMA}",
            "content_sha256": sha256_of(canonical_json(value)),
        },
    )
    try:
        validate_house(house)
    except InvalidHouseError as error:
        raise InvalidFileError(path, error.reason, where=error.where, fix=error.fix) from error
    unstated = () if stated_schema(value) else (f"The file states no schema: read as {SCHEMA}.",)
    return ImportedHouse(
        house=house,
        unmapped=tuple(sorted(objects.unmapped)),
        label_coverage=objects.label_coverage,
        notes=(*unstated, *walls.notes, *objects.notes()),
    )
