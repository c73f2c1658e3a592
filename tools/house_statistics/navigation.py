"""Checks 17-20: where an agent of radius 0.2 m can go on 0.75 m tiles, and clearances."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import shortest_path
from shapely.geometry.base import BaseGeometry

from lcrl_bench.houses.house import RoomType
from tools.house_statistics.view import (
    DoorSide,
    Figure,
    Figures,
    HouseView,
    RoomView,
    Thing,
    number,
    quantile,
    share,
)

SOURCE_AREAS: Final = {2: 50, 3: 65, 4: 107, 5: 108, 6: 152, 7: 140, 8: 328, 9: 300, 10: 268}
"""Median area of published houses in square metres, by number of rooms."""
STARTS: Final = 24
"""Paths measured per house."""
FRONTED: Final = frozenset(
    {"bed", "dresser", "refrigerator", "sofa", "tv_stand", "toilet", "sink", "countertop"}
    | {"side_table"}
)
SLACK: Final = 0.005


def measure_navigation(houses: Sequence[HouseView]) -> Figures:
    """The figures of checks 17 to 20."""
    return {**_free(houses), **_paths(houses), **_clearances(houses)}


def _free(houses: Sequence[HouseView]) -> Figures:
    tiles: dict[bool, list[int]] = {True: [], False: []}
    shares, by_room, connected, reached = [], [], [], []
    for house in houses:
        found = house.walk
        rooms = np.array(found.rooms)
        main = rooms[found.groups == 0]
        shares.append(len(rooms) / max(1, sum(found.tiles.values())))
        connected.append(len(main) / max(1, len(rooms)))
        for view in house.rooms:
            count = int((rooms == view.room.id).sum())
            tiles[view.type is RoomType.BATHROOM].append(count)
            by_room.append(count / max(1, found.tiles[view.room.id]))
            reached.append(bool((main == view.room.id).any()))
    return {
        "fewest free tiles, no bathrooms": quantile(tiles[False], 0.0),
        "fewest free tiles, bathroom": quantile(tiles[True], 0.0),
        "rooms not reached": number(not ok for ok in reached),
        "smallest connected share of free tiles": quantile(connected, 0.0),
        "free share p50, house": quantile(shares, 0.5),
        "free share p10, room": quantile(by_room, 0.1),
    }


def _paths(houses: Sequence[HouseView]) -> Figures:
    """Steps between random tiles of random rooms, scaled to the area of published houses."""
    rng = np.random.default_rng(0)
    few, many, steps = [], [], []
    for house in houses:
        lengths = _lengths(house, rng)
        steps += lengths
        area = sum(view.floor.area for view in house.rooms)
        scale = math.sqrt(SOURCE_AREAS.get(len(house.rooms), area) / area)
        scaled = [length * scale for length in lengths]
        few += scaled if 4 <= len(house.rooms) <= 6 else []
        many += scaled if len(house.rooms) >= 8 else []
    return {
        "path p50, 4-6 rooms, scaled": quantile(few, 0.5),
        "path p90, 4-6 rooms, scaled": quantile(few, 0.9),
        "path p50, 8+ rooms, scaled": quantile(many, 0.5),
        "path p90 in steps, unscaled": quantile(steps, 0.9),
    }


def _lengths(house: HouseView, rng: np.random.Generator) -> list[float]:
    found = house.walk
    rooms = np.array(found.rooms)
    names = sorted(set(found.rooms))
    if not names or not len(found.steps):
        return []
    a, b = found.steps.T
    graph = coo_matrix((np.ones(len(a)), (a, b)), shape=(len(rooms), len(rooms))).tocsr()
    pick = [rng.choice(np.nonzero(rooms == rng.choice(names))[0]) for _ in range(2 * STARTS)]
    starts, ends = pick[:STARTS], pick[STARTS:]
    away = np.asarray(shortest_path(graph, directed=False, unweighted=True, indices=starts))
    known = away[np.arange(STARTS), ends]
    return [float(length) for length in known if np.isfinite(length)]


def _clearances(houses: Sequence[HouseView]) -> Figures:
    sides = [side for house in houses for side in house.door_sides]
    depths = [_depth(side) for side in sides]
    near = [
        _near_door(thing, view, house)
        for house in houses
        for view in house.rooms
        for thing in view.standing
    ]
    fronts = [
        (thing.label, _is_clear_ahead(thing, view))
        for house in houses
        for view in house.rooms
        for thing in view.standing
        if thing.label in FRONTED
    ]
    worst = sorted({label for label, _ in fronts if _rate(fronts, label) < 0.95})
    return {
        "door sides without 0.5 m free": number(depth < 0.5 for depth in depths),
        "door sides with 0.75 m free": share(depth >= 0.75 for depth in depths),
        "door sides with 1.0 m free": share(depth >= 1.0 for depth in depths),
        "floor objects within 0.5 m of a door": share(near),
        "fronts with 0.5 m free": Figure(share(ok for _, ok in fronts).value, ", ".join(worst)),
    }


def _rate(fronts: list[tuple[str, bool]], label: str) -> float:
    cases = [ok for name, ok in fronts if name == label]
    return sum(cases) / len(cases)


def _depth(side: DoorSide) -> float:
    """Metres of free floor in front of a door, over its whole width."""
    zone = side.zone(3.0).buffer(-SLACK, join_style="mitre")
    ahead = [thing.floor for thing in side.room.standing if thing.floor.intersects(zone)]
    parts = shapely.intersection(np.array(ahead, dtype=object), zone)
    return float(shapely.distance(side.line, parts).min()) if len(ahead) else 3.0


def _near_door(thing: Thing, view: RoomView, house: HouseView) -> bool:
    return any(
        side.room is view and side.line.distance(thing.floor) <= 0.5 for side in house.door_sides
    )


def _is_clear_ahead(thing: Thing, view: RoomView) -> bool:
    zone = thing.ahead(0.5).buffer(-SLACK, join_style="mitre")
    if not view.inner.contains(zone):
        return False
    others: list[BaseGeometry] = [other.floor for other in view.standing if other is not thing]
    return not bool(np.any(shapely.intersects(np.array(others, dtype=object), zone)))
