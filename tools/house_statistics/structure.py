"""Checks 1-7: rooms, their links, sizes and shapes, doors and windows."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse.csgraph import shortest_path
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.house import PASSABLE, OpeningKind, RoomType
from tools.house_statistics.view import (
    MAIN,
    Figure,
    Figures,
    HouseView,
    number,
    quantile,
    share,
)

BATH, BED = RoomType.BATHROOM, RoomType.BEDROOM
KITCHEN, LIVING = RoomType.KITCHEN, RoomType.LIVING_ROOM
ENTERED: Final = (LIVING, KITCHEN, RoomType.HALLWAY)
ROUNDING: Final = 1e-6
"""Overlap of two rooms that counts as rounding, in square metres."""


def measure_structure(houses: Sequence[HouseView]) -> Figures:
    """The figures of checks 1 to 7."""
    return {
        **_rooms(houses),
        **_graph(houses),
        **_links(houses),
        **_areas(houses),
        **_shapes(houses),
        **_doors(houses),
        **_windows(houses),
    }


def _types(house: HouseView) -> list[RoomType]:
    return [view.type for view in house.rooms]


def _rooms(houses: Sequence[HouseView]) -> Figures:
    large = [_types(house) for house in houses if len(house.rooms) >= 4]
    outside = [
        [wall for wall, _ in house.openings(OpeningKind.CLOSED_DOOR) if len(wall.rooms) == 1]
        for house in houses
    ]
    entered = [
        house.house.room(wall.rooms[0]).type in ENTERED
        for house, walls in zip(houses, outside, strict=True)
        for wall in walls
    ]
    return {
        "rooms simple and disjoint": share(_is_proper(house) for house in houses),
        "one kitchen and a living room": share(
            _types(h).count(KITCHEN) == 1 and LIVING in _types(h) for h in houses
        ),
        "bedroom and bathroom from 4 rooms on": share(BED in t and BATH in t for t in large),
        "exactly one outside door": share(len(walls) == 1 for walls in outside),
        "outside door in living room, kitchen, hallway": share(entered),
    }


def _is_proper(house: HouseView) -> bool:
    floors = [view.floor for view in house.rooms]
    disjoint = all(a.intersection(b).area < ROUNDING for a, b in combinations(floors, 2))
    return disjoint and all(floor.is_valid and floor.is_simple for floor in floors)


def _hops(house: HouseView) -> NDArray[np.float64]:
    """[room, room]: number of openings on the way; infinite if there is none."""
    table = np.zeros((len(house.rooms), len(house.rooms)))
    for a, b in house.links:
        table[a, b] = table[b, a] = 1
    return np.asarray(shortest_path(table, unweighted=True))


def _graph(houses: Sequence[HouseView]) -> Figures:
    hops = [_hops(house) for house in houses]
    figures = {
        "houses whose rooms are all linked": share(bool(np.isfinite(h).all()) for h in hops),
        "rooms linked twice": number(len(set(house.links)) < len(house.links) for house in houses),
        "links one fewer than rooms": share(len(h.links) == len(h.rooms) - 1 for h in houses),
    }
    for rooms in (4, 5, 6, 8):
        longest = [h.max() for h in hops if len(h) == rooms and np.isfinite(h).all()]
        mean = float(np.mean(longest)) if longest else None
        figures[f"mean diameter, {rooms} rooms"] = Figure(mean)
    return figures


def _links(houses: Sequence[HouseView]) -> Figures:
    pairs = [{_types(h)[a], _types(h)[b]} for h in houses for a, b in h.links]
    passed = [
        sum(room in link for link in house.links) > 1
        for house in houses
        for room, view in enumerate(house.rooms)
        if view.type is BATH
    ]
    return {
        "links bathroom-bedroom or -living room": share(
            pair in ({BATH, BED}, {BATH, LIVING}) for pair in pairs
        ),
        "links kitchen-living room": share(pair == {KITCHEN, LIVING} for pair in pairs),
        "links bedroom-kitchen": share(pair == {BED, KITCHEN} for pair in pairs),
        "bathrooms passed through": share(passed),
    }


def _areas(houses: Sequence[HouseView]) -> Figures:
    figures: Figures = {}
    for kind in MAIN:
        areas = [v.floor.area for h in houses for v in h.rooms if v.type is kind]
        figures[f"area p50, {kind}"] = quantile(areas, 0.5)
        figures[f"area p90/p10, {kind}"] = _ratio(areas)
    small = [sum(v.floor.area for v in h.rooms) for h in houses if len(h.rooms) in (4, 5)]
    return {**figures, "area p50, houses of 4-5 rooms": quantile(small, 0.5)}


def _ratio(values: list[float]) -> Figure:
    if not values:
        return Figure(None)
    low, high = np.quantile(values, (0.1, 0.9))
    return Figure(float(high / low))


def _aspect(polygon: BaseGeometry) -> float:
    x0, y0, x1, y1 = polygon.bounds
    return max(x1 - x0, y1 - y0) / min(x1 - x0, y1 - y0)


def _fill(polygon: BaseGeometry) -> float:
    x0, y0, x1, y1 = polygon.bounds
    return polygon.area / ((x1 - x0) * (y1 - y0))


def _shapes(houses: Sequence[HouseView]) -> Figures:
    views = [view for house in houses for view in house.rooms]
    footprints = [shapely.union_all([v.floor for v in house.rooms]) for house in houses]
    baths = [_aspect(view.floor) for view in views if view.type is BATH]
    dry = [view for view in views if view.type is not BATH]
    return {
        "room aspect p50": quantile((_aspect(view.floor) for view in views), 0.5),
        "room aspect p90, no bathrooms": quantile((_aspect(view.floor) for view in dry), 0.9),
        "room aspect p90, bathroom": quantile(baths, 0.9),
        "footprint aspect p50": quantile(map(_aspect, footprints), 0.5),
        "footprint aspect p90": quantile(map(_aspect, footprints), 0.9),
        "footprint fill p50": quantile(map(_fill, footprints), 0.5),
        "rooms that are no rectangles": share(_fill(view.floor) < 0.99 for view in views),
    }


def _doors(houses: Sequence[HouseView]) -> Figures:
    every = [o for h in houses for _, o in h.openings(*PASSABLE, OpeningKind.CLOSED_DOOR)]
    # An opening over a whole side is not a door.
    doors = [o for o in every if o.kind is not OpeningKind.DOORWAY or o.end - o.start < 1.3]
    widths = [round(door.end - door.start, 3) for door in doors]
    return {
        "wall height p50": quantile((house.house.height for house in houses), 0.5),
        "narrowest opening": quantile((o.end - o.start for o in every), 0.0),
        "lowest door": quantile((door.top for door in doors), 0.0),
        "highest door": quantile((door.top for door in doors), 1.0),
        "doors 1.0-1.1 m wide": share(1.0 <= width <= 1.1 for width in widths),
        "doors 1.9-2.0 m wide": share(1.9 <= width <= 2.0 for width in widths),
    }


def _is_open(house: HouseView) -> bool:
    """Whether an opening wider than a door joins the kitchen and a living room."""
    wide = [w.rooms for w, o in house.openings(OpeningKind.DOORWAY) if o.end - o.start >= 1.3]
    return any({house.house.room(r).type for r in rooms} == {KITCHEN, LIVING} for rooms in wide)


def _windows(houses: Sequence[HouseView]) -> Figures:
    every = [(h, w, o) for h in houses for w, o in h.openings(OpeningKind.WINDOW)]
    rooms = sum(len(house.rooms) for house in houses)
    baths = sum(_types(house).count(BATH) for house in houses)
    in_baths = sum(house.house.room(wall.rooms[0]).type is BATH for house, wall, _ in every)
    return {
        "houses with kitchen open to living room": share(_is_open(house) for house in houses),
        "windows per room": Figure(len(every) / rooms if rooms else None),
        "windows in inner walls": number(len(wall.rooms) != 1 for _, wall, _ in every),
        "sill p10": quantile((o.bottom for _, _, o in every), 0.1),
        "sill p90": quantile((o.bottom for _, _, o in every), 0.9),
        "window width p10": quantile((o.end - o.start for _, _, o in every), 0.1),
        "window width p90": quantile((o.end - o.start for _, _, o in every), 0.9),
        "windows per bathroom": Figure(in_baths / baths if baths else None),
    }
