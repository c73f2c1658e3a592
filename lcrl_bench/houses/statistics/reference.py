"""What published houses are like, and the bands a set of houses is held to.

Source: `assets/house_statistics.toml`, aggregates of 472 ProcTHOR houses with cross-checks.
"""

from __future__ import annotations

import tomllib
from functools import lru_cache
from importlib import resources
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from lcrl_bench.errors import InvalidFileError

Check = Annotated[int, Field(ge=1, le=25)]
Range = tuple[float, float, float]
"""p10, p50 and p90."""
ByRoom = tuple[float, float, float, float]
"""Of kitchens, living rooms, bedrooms and bathrooms."""


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Band(_Model):
    """What one figure is to be."""

    check: Check
    name: str
    low: float | None = None
    high: float | None = None
    reason: str = ""
    """Why the generator may differ; empty where it may not."""


class Unmeasured(_Model):
    """What no house can be held to, and why."""

    check: Check
    name: str
    reason: str


class Sizes(_Model):
    """How large things of a class are, in metres."""

    width: Range
    depth: Range
    height: Range

    @property
    def axes(self) -> tuple[Range, Range, Range]:
        """Width, depth and height."""
        return self.width, self.depth, self.height


class Task(_Model):
    """How often and where one of the classes that tasks move is found."""

    any: float
    """Share of houses that have one."""
    one: float
    """Share of houses that have exactly one."""
    base: float
    """Median height of its underside."""
    on: dict[str, float]
    """Share of each class of furniture it stands on; the rest is not listed."""
    rooms: ByRoom
    """Share of rooms that have one."""
    named: float | None = None
    """Share of those that are the only one in rooms of their type."""


class InRooms(_Model):
    """How many of a class rooms have."""

    none: ByRoom
    """Share of rooms with none."""
    one: ByRoom
    """Share of rooms with none or one."""


class Reference(_Model):
    """The whole file."""

    source: str
    furniture: tuple[str, ...]
    """Classes whose sizes and sets are judged as furniture."""
    bands: tuple[Band, ...]
    unmeasured: tuple[Unmeasured, ...]
    sizes: dict[str, Sizes]
    tasks: dict[str, Task]
    in_rooms: dict[str, InRooms]


@lru_cache(maxsize=1)
def reference() -> Reference:
    """The statistics and bands.

    Raises:
        InvalidFileError: If the file is not a table of them.
    """
    file = resources.files("lcrl_bench.assets").joinpath("house_statistics.toml")
    try:
        return Reference.model_validate(tomllib.loads(file.read_text("utf-8")))
    except (tomllib.TOMLDecodeError, ValidationError) as error:
        raise InvalidFileError(str(file), f"not house statistics: {error}") from error
