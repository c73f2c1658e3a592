"""Furnishing recipes, read from `assets/recipes/*.toml`.

`kinds.toml` gives the size of each kind of thing, one file per room type says what stands in such
a room and where, and `surfaces.toml` says what stands on what.

Source: size ranges are the p10, p50 and p90 of published house datasets.
"""

from __future__ import annotations

import tomllib
from functools import lru_cache
from importlib import resources
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import Field, ValidationError

from lcrl_bench.documents import Document
from lcrl_bench.errors import InvalidFileError
from lcrl_bench.houses.house import RoomType

Range = tuple[float, float, float]
"""p10, p50 and p90 of a quantity."""
Chance = Annotated[float, Field(ge=0, le=1)]
Count = tuple[int, int]
"""Minimum and maximum."""
Model = TypeVar("Model", bound=Document)


class Kind(Document):
    """A kind of thing: its class and its sizes in metres."""

    label: str = ""
    """Class name; empty if it is the kind's own name."""
    width: Range
    depth: Range
    height: Range
    base: Range = (0.0, 0.0, 0.0)
    """Height of the underside, for things on walls."""
    front: float = 0.0
    """Depth kept clear in front of it."""
    twins: bool = False
    """Whether all of them in a house are alike (a set of chairs)."""
    flat: bool = False
    """Whether it can be walked over (a rug)."""
    turn: float = 0.0
    """Largest deviation from a quarter turn, in radians."""
    shape: int | None = None
    """Its only shape; drawn if None."""
    full_height: bool = False
    """Whether it reaches from the floor to `headroom` below the ceiling."""
    headroom: float = 0.0
    """Metres left between it and the ceiling if `full_height`."""


class Furniture(Document):
    """A kind of thing that stands on the floor, how many, and where."""

    kind: str
    place: Literal[
        "wall",
        "corner",
        "row",
        "middle",
        "beside",
        "before",
        "facing",
        "flank",
        "around",
        "seat",
        "under",
        "opposite",
    ]
    """Against a wall, also in a corner or in a row; free-standing; or relative to its parent."""
    chance: Chance = 1.0
    count: Count = (1, 1)
    must: bool = False
    """Whether the room (for a companion: the group) requires it."""
    area: float = 0.0
    """Smallest room in m2 that gets one."""
    corner: float = 0.0
    """Score for a corner."""
    centre: float = 0.0
    """Score for the middle of its wall."""
    window: float = 0.0
    """Score for standing under a window; may be negative."""
    touch: tuple[str, ...] = ()
    """Kinds it stands side by side with."""
    gap: tuple[float, float] = (0.01, 0.04)
    """Metres to the wall, or to the thing it accompanies; negative means under it."""
    along: float = 0.0
    """Largest shift sideways, in metres."""
    instead: str = ""
    """A kind: this one is only tried where that one is absent."""
    companions: tuple[Furniture, ...] = ()


class Hanging(Document):
    """A kind of thing that hangs on a wall."""

    kind: str
    chance: Chance = 1.0
    count: Count = (1, 1)
    over: tuple[str, ...] = ()
    """Kinds above whose middle it hangs."""
    only_over: bool = False
    """Whether it hangs only there."""
    opposite: str = ""
    """A kind it faces."""
    instead: str = ""
    """A kind: this one is only tried where that one is absent."""
    exterior: bool = False
    """Whether it prefers outside walls (heaters hang below windows)."""


class RoomRecipe(Document):
    """What a room of a type is like."""

    area: tuple[float, float]
    """Smallest and largest floor area in m2."""
    side: int
    """Minimum number of cells along its shorter side."""
    aspect: float = 2.0
    """Largest aspect ratio."""
    free: int = 4
    """Minimum number of tiles an agent can stand on."""
    free_share: Chance = 0.36
    """Minimum share of its tiles that stays free."""
    windows: tuple[Chance, ...]
    """Probability of 0, 1, 2 ... windows."""
    sill: Range
    window_width: Range
    window_height: Range
    furniture: tuple[Furniture, ...]
    hanging: tuple[Hanging, ...] = ()
    curtains: Chance = 0.0


class Dressing(Document):
    """Things that stand on one kind of furniture, placed in order."""

    kind: str
    on: tuple[str, ...]
    """Labels of furniture."""
    rooms: tuple[RoomType, ...] = ()
    """Room types; empty for all."""
    chance: Chance = 1.0
    count: Count = (1, 1)
    where: Literal["back", "edge", "centre", "any", "head"] = "any"


class TaskObject(Document):
    """Where one of the 14 objects that tasks move is found, and how many a house has."""

    chance: Chance
    """Share of houses that have it."""
    counts: tuple[Chance, ...]
    """Probability of 1, 2, 3 ... of them in a house that has it."""
    rooms: dict[RoomType, float]
    on: dict[str, float]
    """Weight of each class of furniture."""


class Surfaces(Document):
    """What stands on furniture."""

    dressing: tuple[Dressing, ...]
    clutter: tuple[Dressing, ...]
    task: dict[str, TaskObject]


def _read(name: str, model: type[Model]) -> Model:
    file = resources.files("lcrl_bench.assets").joinpath("recipes", name)
    try:
        return model.model_validate(tomllib.loads(file.read_text("utf-8")))
    except (tomllib.TOMLDecodeError, ValidationError) as error:
        raise InvalidFileError(str(file), f"not a recipe: {error}") from error


class _Kinds(Document):
    kinds: dict[str, Kind]


@lru_cache(maxsize=1)
def kinds() -> dict[str, Kind]:
    """Every kind of thing, by name."""
    file = resources.files("lcrl_bench.assets").joinpath("recipes", "kinds.toml")
    rows: dict[str, dict[str, Any]] = tomllib.loads(file.read_text("utf-8"))
    named = {name: {"label": name, **row} for name, row in rows.items()}
    try:
        return _Kinds.model_validate({"kinds": named}).kinds
    except ValidationError as error:
        raise InvalidFileError(str(file), f"not a table of kinds: {error}") from error


@lru_cache(maxsize=1)
def room_recipes() -> dict[RoomType, RoomRecipe]:
    """The recipes, by room type."""
    types = [room_type for room_type in RoomType if room_type is not RoomType.OTHER]
    return {t: _read(f"{t.value.replace(' ', '_')}.toml", RoomRecipe) for t in types}


@lru_cache(maxsize=1)
def surfaces() -> Surfaces:
    """What stands on furniture."""
    return _read("surfaces.toml", Surfaces)


def draw(spread: Range, rng: np.random.Generator) -> float:
    """A value between p10 and p90, below p50 with probability one half."""
    return float(np.interp(rng.random(), (0.0, 0.5, 1.0), spread))


def draw_size(kind: Kind, rng: np.random.Generator) -> tuple[float, float, float]:
    """Width, depth and height of a thing of this kind, in whole millimetres."""
    width, depth, height = (
        round(draw(spread, rng), 3) for spread in (kind.width, kind.depth, kind.height)
    )
    return width, depth, height


def draw_count(count: Count, rng: np.random.Generator) -> int:
    """An integer from `count[0]` to `count[1]`, inclusive."""
    return int(rng.integers(count[0], count[1] + 1))
