"""The fields of a ProcTHOR / AI2-THOR house file (schema 1.0.0) used for a `House`.

Files contain much more (materials, lights, agent poses); other fields are ignored.

Source: `procthor/utils/types.py` of github.com/allenai/procthor, and `ProceduralTools.cs` of
github.com/allenai/ai2thor, which loads such files in Unity.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from pydantic import ConfigDict, Field

from lcrl_bench.documents import Document, Text, parse_document
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.document import Coordinate

SCHEMA = "1.0.0"
"""The schema this package reads."""

_FIX = "See docs/importing-a-house.md for the format."
_UPGRADE = (
    "Upgrade it with `procthor/utils/upgrade_house_version.py` of github.com/allenai/procthor."
)


class _Record(Document):
    # ProcTHOR houses carry much that a `House` has no place for.
    model_config = ConfigDict(extra="ignore")


class Vector3(_Record):
    """A point, or Euler angles in degrees; Unity's axes: y is up."""

    x: Coordinate
    y: Coordinate
    z: Coordinate


class RoomRecord(_Record):
    """A room."""

    id: Text
    roomType: Text = ""  # noqa: N815 - the file's own name
    floorPolygon: Annotated[list[Vector3], Field(min_length=3, max_length=500)]  # noqa: N815


class WallRecord(_Record):
    """One side of a wall: a rectangle without thickness."""

    id: Text
    roomId: Text = "exterior"  # noqa: N815
    polygon: Annotated[list[Vector3], Field(min_length=4, max_length=4)]
    empty: bool = False


class OpeningRecord(_Record):
    """A door or a window: a hole in wall0 and in wall1, its twin."""

    id: Text
    assetId: Text = ""  # noqa: N815
    room0: Text
    room1: Text
    wall0: Text
    wall1: Text
    holePolygon: Annotated[list[Vector3], Field(min_length=2, max_length=2)]  # noqa: N815
    openable: bool | None = None


class ObjectRecord(_Record):
    """An object: its model, and the centre of its box."""

    id: Text
    assetId: Text  # noqa: N815
    objectType: Text | None = None  # noqa: N815
    roomId: Text | None = None  # noqa: N815
    position: Vector3
    rotation: Vector3 = Vector3(x=0, y=0, z=0)


class FurnitureRecord(ObjectRecord):
    """An object with those on or in it; deeper nesting doesn't occur."""

    children: Annotated[list[ObjectRecord], Field(max_length=1_000)] | None = None


class HouseRecord(_Record):
    """A house file."""

    rooms: Annotated[list[RoomRecord], Field(max_length=200)]
    walls: Annotated[list[WallRecord], Field(max_length=4_000)]
    doors: Annotated[list[OpeningRecord], Field(max_length=1_000)] | None = None
    windows: Annotated[list[OpeningRecord], Field(max_length=1_000)] | None = None
    objects: Annotated[list[FurnitureRecord], Field(max_length=5_000)] | None = None


def parse_record(value: object, *, path: Path) -> HouseRecord:
    """Validate a parsed house file.

    Raises:
        InvalidFileError: If it has another schema or no rooms, or a field is missing, of the
            wrong type or out of bounds.
    """
    _check_schema(value, path)
    record = parse_document(
        HouseRecord, value, path=path, kind=f"a ProcTHOR house of schema {SCHEMA}", fix=_FIX
    )
    if not record.rooms:
        fix = "It is a template; choose a generated house."
        raise InvalidFileError(path, "the house has no rooms", where="rooms", fix=fix)
    count = sum(1 + len(thing.children or ()) for thing in record.objects or ())
    if count > 20_000:
        reason = f"{count} objects are over the limit of 20000"
        raise InvalidFileError(path, reason, where="objects", fix="Leave some out.")
    return record


def stated_schema(value: object) -> str | None:
    """The schema that a parsed house file states, or None."""
    metadata = value.get("metadata") if isinstance(value, dict) else None
    schema = metadata.get("schema") if isinstance(metadata, dict) else None
    return schema if isinstance(schema, str) else None


def _check_schema(value: object, path: Path) -> None:
    schema = stated_schema(value)
    if schema is not None and schema != SCHEMA:
        reason = f"schema {schema[:20]!r} is not {SCHEMA}"
        raise InvalidFileError(path, reason, where="metadata.schema", fix=_UPGRADE)
    # A file that states no schema is read as 1.0.0 unless it has fields of an older one.
    if isinstance(value, dict) and schema is None:
        for key, mark in (("doors", "assetOffset"), ("windows", "assetOffset"), ("walls", "p0")):
            if any(mark in row for row in _dicts(value.get(key))):
                reason = f"it states no schema and its {key} have '{mark}': older than {SCHEMA}"
                raise InvalidFileError(path, reason, where=key, fix=_UPGRADE)


def _dicts(rows: object) -> list[dict[str, Any]]:
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []
