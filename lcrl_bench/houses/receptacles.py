"""Receptacles: the flat upper faces of furniture, from `assets/receptacles.toml`."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

from lcrl_bench.houses.house import PlacedObject, Point


@dataclass(frozen=True)
class Face:
    """A level rectangle that things can stand on, in the house's frame."""

    owner: str
    """Id of the object it belongs to."""
    height: float
    """Metres above the floor."""
    center: Point
    half: Point
    """Half extents along the owner's own width and depth."""
    yaw: float
    """The owner's yaw."""

    def point(self, across: float, along: float) -> Point:
        """The point at fractions `across` and `along` (-1 .. 1) of the half extents."""
        dx, dy = across * self.half[0], along * self.half[1]
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return self.center[0] + dx * cos - dy * sin, self.center[1] + dx * sin + dy * cos


@lru_cache(maxsize=1)
def _table() -> dict[str, dict[str, Any]]:
    file = resources.files("lcrl_bench.assets").joinpath("receptacles.toml")
    return tomllib.loads(file.read_text("utf-8"))


def receptacle_labels() -> tuple[str, ...]:
    """Names of the classes that things can stand on."""
    return tuple(_table())


def face_shares(label: str) -> tuple[float, ...]:
    """Heights of a class's faces above its underside, as fractions of its height, ascending."""
    return tuple(_table()[label]["heights"])


def faces(thing: PlacedObject) -> tuple[Face, ...]:
    """The faces of `thing`, lowest first; empty if it has none."""
    row = _table().get(thing.label)
    if row is None:
        return ()
    (x0, x1), (y0, y1) = _rectangle(row, thing.shape)
    width, depth, height = thing.size
    cos, sin = math.cos(thing.yaw), math.sin(thing.yaw)
    dx, dy = (x0 + x1) / 2 * width, (y0 + y1) / 2 * depth
    center = (
        thing.position[0] + dx * cos - dy * sin,
        thing.position[1] + dx * sin + dy * cos,
    )
    half = ((x1 - x0) / 2 * width, (y1 - y0) / 2 * depth)
    return tuple(
        Face(thing.id, thing.base + share * height, center, half, thing.yaw)
        for share in row["heights"]
    )


def _rectangle(row: dict[str, Any], shape: int) -> tuple[Point, Point]:
    """The usable rectangle of a class's shape, as x and y fractions."""
    rounded = row.get("round")
    if rounded is not None and shape % rounded["of"] in rounded["shapes"]:
        row = rounded
    return row["x"], row["y"]
