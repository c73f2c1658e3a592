"""Furniture and objects as labelled meshes in the house's frame, and the whole house as meshes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import House, PlacedObject
from lcrl_bench.scenes.building import building_surfaces
from lcrl_bench.scenes.shapes import object_parts
from lcrl_bench.scenes.surface import Surface


def object_surfaces(thing: PlacedObject) -> tuple[Surface, ...]:
    """The labelled meshes of one object, named `"<id>.<part>"`, where it stands."""
    return tuple(
        Surface(
            f"{thing.id}.{part.name}",
            thing.label,
            to_house(part.vertices, thing),
            part.faces,
            thing.room,
            thing.id,
        )
        for part in object_parts(thing.label, thing.size, thing.shape)
    )


def house_surfaces(house: House) -> tuple[Surface, ...]:
    """The labelled meshes of the building and of everything in it."""
    furniture = (surface for thing in house.objects for surface in object_surfaces(thing))
    return (*building_surfaces(house), *furniture)


def to_house(vertices: NDArray[np.float64], thing: PlacedObject) -> NDArray[np.float64]:
    """Move points of an object's own frame, [vertex, 3] metres, into the house's frame."""
    cos, sin = math.cos(thing.yaw), math.sin(thing.yaw)
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return vertices @ turn + thing.position
