"""House JSON: the canonical file format of a `House`, versioned and lossless.

The pydantic models below are the schema; `read_house` refuses, with the place and the reason,
anything that is not one, and `write_house` writes atomically. Numbers keep every bit: JSON writes
the shortest decimal that reads back as the same float64.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

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
from lcrl_bench.houses.validation import validate_house
from lcrl_bench.names import NAME
from lcrl_bench.storage import canonical_json, read_json, sha256_of, write_bytes

VERSION = 1
"""Version of the House JSON this package writes, and the only one it reads."""

Coordinate = Annotated[float, Field(ge=-10_000, le=10_000, allow_inf_nan=False)]
Length = Annotated[float, Field(gt=0, le=1_000, allow_inf_nan=False)]
Name = Annotated[str, Field(pattern=f"^(?:{NAME.pattern})$")]
XY = tuple[Coordinate, Coordinate]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=False, frozen=True)


class RoomDocument(_Model):
    """A room as House JSON."""

    id: Name
    type: RoomType
    polygon: Annotated[list[XY], Field(min_length=3, max_length=500)]


class OpeningDocument(_Model):
    """A hole in a wall as House JSON."""

    kind: OpeningKind
    start: Coordinate
    end: Coordinate
    bottom: Coordinate
    top: Coordinate


class WallDocument(_Model):
    """A wall as House JSON."""

    id: Name
    start: XY
    end: XY
    height: Length
    thickness: Length
    openings: Annotated[list[OpeningDocument], Field(max_length=100)] = []
    rooms: Annotated[list[Name], Field(max_length=2)] = []


class ObjectDocument(_Model):
    """A placed object as House JSON."""

    id: Name
    label: str
    room: Name
    position: tuple[Coordinate, Coordinate, Coordinate]
    size: tuple[Length, Length, Length]
    yaw: Coordinate
    support: Name | None = None
    shape: Annotated[int, Field(ge=0, lt=2**31)] = 0
    source_label: Annotated[str, Field(max_length=200)] = ""


class HouseDocument(_Model):
    """A house as House JSON."""

    format: Literal["lcrl-house"] = "lcrl-house"
    version: Literal[1] = VERSION
    id: Name
    source: Name
    height: Length
    rooms: Annotated[list[RoomDocument], Field(max_length=1_000)]
    walls: Annotated[list[WallDocument], Field(max_length=10_000)]
    objects: Annotated[list[ObjectDocument], Field(max_length=20_000)]
    provenance: dict[str, Annotated[str, Field(max_length=2_000)]] = {}

    @classmethod
    def from_house(cls, house: House) -> HouseDocument:
        """The document of a house."""
        return cls(
            id=house.id,
            source=house.source,
            height=house.height,
            rooms=[RoomDocument(id=r.id, type=r.type, polygon=list(r.polygon)) for r in house.rooms],
            walls=[_wall_document(wall) for wall in house.walls],
            objects=[ObjectDocument(**vars(thing)) for thing in house.objects],
            provenance=dict(house.provenance),
        )

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


def _wall_document(wall: Wall) -> WallDocument:
    openings = [OpeningDocument(**vars(opening)) for opening in wall.openings]
    return WallDocument(**{**vars(wall), "openings": openings, "rooms": list(wall.rooms)})


def _wall(wall: WallDocument) -> Wall:
    openings = tuple(Opening(**dict(opening)) for opening in wall.openings)
    return Wall(**{**dict(wall), "openings": openings, "rooms": tuple(wall.rooms)})


def house_to_json(house: House) -> dict[str, Any]:
    """The House JSON of a house, as plain Python values."""
    return HouseDocument.from_house(house).model_dump(mode="json")


def house_digest(house: House) -> str:
    """SHA-256 of a house: equal for equal houses, whatever file they came from."""
    return sha256_of(canonical_json(house_to_json(house)))


def parse_house(value: object, *, path: Path | str) -> House:
    """Build and validate a house from parsed House JSON.

    Args:
        value: The parsed JSON.
        path: Where it came from, for messages.

    Raises:
        InvalidFileError: If `value` is not House JSON of a known version, or breaks a house law.
    """
    try:
        house = HouseDocument.model_validate(value).to_house()
        validate_house(house)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the top level"
        more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
        raise InvalidFileError(
            path,
            f"not a House JSON: {first['msg']}, found {_short(first['input'])}{more}",
            where=where,
            fix="See docs/importing-a-house.md for the format.",
        ) from error
    except InvalidHouseError as error:
        raise InvalidFileError(path, error.reason, where=error.where, fix=error.fix) from error
    return house


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def read_house(path: Path) -> House:
    """Read and validate a House JSON file.

    Raises:
        InvalidFileError: If the file is not a valid house; names the place and the reason.
    """
    return parse_house(read_json(path), path=path)


def write_house(path: Path, house: House) -> None:
    """Write a house as House JSON, atomically, the same bytes for the same house."""
    document = HouseDocument.from_house(house)
    write_bytes(path, document.model_dump_json(indent=1).encode() + b"\n")
