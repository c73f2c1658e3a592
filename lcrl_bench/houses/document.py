"""House JSON: the canonical file format of a `House`, versioned and lossless.

The pydantic models below are the schema; `read_house` rejects anything else, naming the place and
the reason, and `write_house` writes atomically. Numbers keep every bit: JSON writes the shortest
decimal that reads back as the same float64.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationError

from lcrl_bench.documents import Document, Text, parse_document
from lcrl_bench.errors import InvalidFileError, InvalidHouseError
from lcrl_bench.houses.house import (
    House,
    Opening,
    OpeningKind,
    PlacedObject,
    Room,
    RoomType,
    Wall,
)
from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.names import NAME, RULE
from lcrl_bench.storage import (
    MAX_HOUSE_BYTES,
    canonical_json,
    json_place,
    read_json,
    sha256_of,
    write_bytes,
)

VERSION = 1
"""Version of the House JSON this package writes, and the only one it reads."""

_NEGATIVE_ZERO = re.compile(rb"-0\.0[],}]")
_FIX = "See docs/importing-a-house.md for the format."


def _name(text: str) -> str:
    if NAME.fullmatch(text) is None or ".." in text:
        raise ValueError(RULE)
    return text


Name = Annotated[str, Field(strict=True, max_length=80), AfterValidator(_name)]
Coordinate = Annotated[float, Field(strict=True, ge=-10_000, le=10_000, allow_inf_nan=False)]
"""A finite number of metres (or radians, or degrees) within 10 km of the origin."""
Length = Annotated[float, Field(strict=True, gt=0, le=1_000, allow_inf_nan=False)]
"""A positive number of metres."""
XY = tuple[Coordinate, Coordinate]
Note = Annotated[
    str,
    Field(strict=True, max_length=2_000, pattern=r"^[^\x00-\x08\x0b-\x1f\x7f-\x9f]*$"),
]
"""Free text: like `Text`, but up to 2,000 characters, and with line breaks and tabs."""


class RoomDocument(Document):
    """A room as House JSON."""

    id: Name
    type: RoomType
    polygon: Annotated[list[XY], Field(min_length=3, max_length=500)]


class OpeningDocument(Document):
    """A hole in a wall as House JSON."""

    kind: OpeningKind
    start: Coordinate
    end: Coordinate
    bottom: Coordinate
    top: Coordinate


class WallDocument(Document):
    """A wall as House JSON."""

    id: Name
    start: XY
    end: XY
    height: Length
    thickness: Length
    openings: list[OpeningDocument] = Field(default=[], max_length=100)
    rooms: list[Name] = Field(default=[], max_length=2)


class ObjectDocument(Document):
    """A placed object as House JSON."""

    id: Name
    label: Text
    room: Name
    position: tuple[Coordinate, Coordinate, Coordinate]
    size: tuple[Length, Length, Length]
    yaw: Coordinate
    support: Name | None = None
    shape: Annotated[int, Field(strict=True, ge=0, lt=2**31)] = 0
    source_label: Text = ""


class HouseDocument(Document):
    """A house as House JSON."""

    format: Literal["lcrl-house"] = "lcrl-house"
    version: Literal[1] = VERSION
    id: Name
    source: Name
    height: Length
    rooms: Annotated[list[RoomDocument], Field(max_length=1_000)]
    walls: Annotated[list[WallDocument], Field(max_length=10_000)]
    objects: Annotated[list[ObjectDocument], Field(max_length=20_000)]
    provenance: dict[Text, Note] = Field(default={}, max_length=100)

    @classmethod
    def from_house(cls, house: House) -> HouseDocument:
        """The document of a house.

        Raises:
            InvalidHouseError: If part of the house does not fit the format.
        """
        try:
            return cls.model_validate(house, from_attributes=True)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            reason = f"it can't be written as House JSON: {first['msg']}"
            where = json_place(first["loc"])
            raise InvalidHouseError(house.id, reason, where=where, fix=_FIX) from error

    def to_house(self) -> House:
        """The house of this document, not yet validated."""
        return House(
            id=self.id,
            source=self.source,
            height=self.height,
            rooms=tuple(Room(r.id, r.type, tuple(r.polygon)) for r in self.rooms),
            walls=tuple(_wall(wall) for wall in self.walls),
            objects=tuple(PlacedObject(**dict(thing)) for thing in self.objects),
            provenance=dict(self.provenance),
        )


def _wall(wall: WallDocument) -> Wall:
    openings = tuple(Opening(**dict(opening)) for opening in wall.openings)
    return Wall(**{**dict(wall), "openings": openings, "rooms": tuple(wall.rooms)})


def house_to_json(house: House) -> dict[str, Any]:
    """The House JSON of a house, as plain Python values."""
    return HouseDocument.from_house(house).model_dump(mode="json")


def house_digest(house: House) -> str:
    """SHA-256 of a house: equal for equal houses, whichever file they came from."""
    return json_digest(house_to_json(house))


def json_digest(value: dict[str, Any]) -> str:
    """`house_digest` of a house, given its House JSON with every field."""
    text = canonical_json(value)
    # Searching the text is faster than visiting every number.
    return sha256_of(canonical_json(_one_zero(value)) if _NEGATIVE_ZERO.search(text) else text)


def _one_zero(value: Any) -> Any:  # noqa: ANN401 - any JSON value
    """The value with every -0.0 replaced by 0.0, so that equal houses have equal digests."""
    if isinstance(value, dict):
        return {key: _one_zero(child) for key, child in value.items()}
    if isinstance(value, list):
        return [_one_zero(child) for child in value]
    return value + 0.0 if isinstance(value, float) else value


def parse_house(value: object, *, path: Path | str) -> House:
    """Build and validate a house from parsed House JSON.

    Args:
        value: The parsed JSON.
        path: Where it came from, for messages.

    Raises:
        InvalidFileError: If `value` is not House JSON of a known version, or not a valid house.
    """
    document = parse_document(HouseDocument, value, path=path, kind="a House JSON", fix=_FIX)
    house = document.to_house()
    try:
        validate_house(house)
    except InvalidHouseError as error:
        raise InvalidFileError(path, error.reason, where=error.where, fix=error.fix) from error
    return house


def read_house(path: Path) -> House:
    """Read and validate a House JSON file.

    Raises:
        InvalidFileError: If the file is not a valid house; names the place and the reason.
    """
    return parse_house(read_json(path, max_bytes=MAX_HOUSE_BYTES), path=path)


def import_lcrl(path: Path) -> ImportedHouse:
    """Importer of House JSON files: lossless, so there is nothing to report.

    Raises:
        InvalidFileError: If the file is not a valid house.
    """
    return ImportedHouse(read_house(Path(path)), unmapped=(), label_coverage=1.0, notes=())


def write_house(path: Path, house: House) -> None:
    """Write a house as House JSON, atomically and deterministically.

    Raises:
        InvalidHouseError: If the house is invalid, so that it could not be read back.
        EnvironmentMissingError: If the file can't be written.
    """
    document = HouseDocument.from_house(house)
    validate_house(house)
    write_bytes(path, document.model_dump_json(indent=1).encode() + b"\n")
