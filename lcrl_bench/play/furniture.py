"""Map colours of the places where the agent can't stand: those of the furniture there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import shapely
from rich.color import blend_rgb
from rich.color_triplet import ColorTriplet

from lcrl_bench.houses.classes import class_id
from lcrl_bench.houses.house import House
from lcrl_bench.recording.palette import WHITE, Color, class_colors

Place = tuple[int, int]
"""Row and column of a map, in tiles."""

BARE: Final[Color] = (150, 150, 150)
"""A place that is only too narrow to stand in."""
_NEAR: Final = 0.3
"""Metres between furniture and the middle of a place it occupies."""
_WHITENING: Final = 0.35
"""Share of white in the colour of furniture."""


def furniture_colors(
    house: House, places: Mapping[Place, tuple[float, float]]
) -> dict[Place, Color]:
    """The colour of each place inside the house: that of the largest object there.

    Args:
        house: The house.
        places: Places and their middles, (x, y) in metres; those outside are left out.
    """
    rooms = shapely.union_all([shapely.Polygon(room.polygon) for room in house.rooms])
    colors = class_colors()
    # Largest last, so that a bed is not hidden by its pillows; one walks on rugs.
    things = sorted(
        (thing for thing in house.objects if thing.label != "rug"),
        key=lambda thing: (thing.size[0] * thing.size[1], thing.id),
    )
    shapes = [shapely.Polygon(thing.footprint()) for thing in things]
    filled = {}
    for place, at in places.items():
        point = shapely.Point(at)
        if not rooms.covers(point):
            continue
        over = [thing for thing, shape in zip(things, shapes, strict=True) if shape.covers(point)]
        near = over or [
            thing
            for thing, shape in zip(things, shapes, strict=True)
            if shape.dwithin(point, _NEAR)
        ]
        if near:
            color = ColorTriplet(*colors[class_id(near[-1].label)].tolist())
            filled[place] = blend_rgb(color, ColorTriplet(*WHITE), _WHITENING)
        else:
            filled[place] = BARE
    return filled
