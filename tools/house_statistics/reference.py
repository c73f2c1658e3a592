"""Statistics of published houses, and the range each figure of a set of houses should lie in.

Source: `reference.toml`, aggregates of 472 ProcTHOR houses with cross-checks.
"""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Final

from pydantic import Field, ValidationError

from lcrl_bench.documents import Document
from lcrl_bench.errors import InvalidFileError

FILE: Final = Path(__file__).with_name("reference.toml")

Check = Annotated[int, Field(ge=1, le=25)]
Range = tuple[float, float, float]
"""p10, p50 and p90."""
ByRoom = tuple[float, float, float, float]
"""Values for kitchens, living rooms, bedrooms and bathrooms."""


class Band(Document):
    """The accepted range of one figure; open where a bound is None."""

    check: Check
    name: str
    low: float | None = None
    high: float | None = None
    reason: str = ""
    """Why the generator may differ; empty if it may not."""


class Unmeasured(Document):
    """A figure that can't be measured on houses, and why."""

    check: Check
    name: str
    reason: str


class Sizes(Document):
    """Sizes of the objects of a class, in metres."""

    width: Range
    depth: Range
    height: Range

    @property
    def axes(self) -> tuple[Range, Range, Range]:
        """Width, depth and height."""
        return self.width, self.depth, self.height


class Task(Document):
    """How often, and where, objects of a class that tasks move are found."""

    any: float
    """Share of houses with at least one."""
    one: float
    """Share of houses with exactly one."""
    base: float
    """Median height of the underside, in metres."""
    on: dict[str, float]
    """Share on each class of furniture; rare classes are not listed."""
    rooms: ByRoom
    """Share of rooms with at least one."""
    named: float | None = None
    """Share of objects that are the only one of their class in a house's rooms of that type."""


class InRooms(Document):
    """How many objects of a class a room has."""

    none: ByRoom
    """Share of rooms with none."""
    one: ByRoom
    """Share of rooms with none or one."""


class Reference(Document):
    """The whole reference file."""

    source: str
    furniture: tuple[str, ...]
    """Classes judged as furniture, by sizes and sets."""
    bands: tuple[Band, ...]
    unmeasured: tuple[Unmeasured, ...]
    sizes: dict[str, Sizes]
    tasks: dict[str, Task]
    in_rooms: dict[str, InRooms]


@lru_cache(maxsize=1)
def reference() -> Reference:
    """The reference data.

    Raises:
        InvalidFileError: If the file does not hold it.
    """
    try:
        return Reference.model_validate(tomllib.loads(FILE.read_text("utf-8")))
    except (tomllib.TOMLDecodeError, ValidationError) as error:
        raise InvalidFileError(FILE, f"not house statistics: {error}") from error
