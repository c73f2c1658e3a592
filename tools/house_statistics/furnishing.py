"""Checks 8-12: how much furniture rooms hold, which, how large, and that nothing overlaps."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import combinations
from typing import Final

import numpy as np
import shapely

from lcrl_bench.houses.house import RoomType
from tools.house_statistics.reference import Sizes, reference
from tools.house_statistics.view import (
    MAIN,
    Figure,
    Figures,
    HouseView,
    RoomView,
    Thing,
    number,
    quantile,
    share,
    within,
)

SEATS: Final = frozenset({"chair", "stool", "bench", "armchair"})
TABLES: Final = frozenset({"dining_table", "desk", "countertop"})
TUCKED: Final = 0.35
"""Largest share of a seat that may reach under a table."""
TOUCH: Final = 1e-4
"""Overlap that counts as rounding, in square metres."""
FEWEST: Final = 20
"""Classes with fewer objects than this are not judged by size."""
TOLERANCE: Final = 0.15
SPREAD: Final = 0.6

KITCHEN, LIVING = RoomType.KITCHEN, RoomType.LIVING_ROOM
BED, BATH = RoomType.BEDROOM, RoomType.BATHROOM
PRESENCE: Final[tuple[tuple[str, tuple[RoomType, ...], tuple[str, ...]], ...]] = (
    ("bed in bedroom", (BED,), ("bed",)),
    ("dresser or wardrobe in bedroom", (BED,), ("dresser", "wardrobe")),
    ("toilet in bathroom", (BATH,), ("toilet",)),
    ("sink in bathroom", (BATH,), ("sink",)),
    ("refrigerator in kitchen", (KITCHEN,), ("refrigerator",)),
    ("countertop in kitchen", (KITCHEN,), ("countertop",)),
    ("sofa in living room", (LIVING,), ("sofa",)),
    ("tv_stand in living room", (LIVING,), ("tv_stand",)),
    ("television in living room", (LIVING,), ("television",)),
    ("table in living room", (LIVING,), ("dining_table", "coffee_table")),
    ("table in kitchen", (KITCHEN,), ("dining_table",)),
    ("lamp in living room or bedroom", (LIVING, BED), ("lamp",)),
    ("plant in kitchen, living room, bedroom", (KITCHEN, LIVING, BED), ("plant",)),
    ("trash_can in kitchen", (KITCHEN,), ("trash_can",)),
    ("trash_can in bathroom", (BATH,), ("trash_can",)),
)
"""Figure name, room types, and the classes of which such a room should have one."""
IN_HOUSES: Final = (
    ("stove",),
    ("base_cabinet", "wall_cabinet"),
    ("wardrobe",),
    ("rug",),
    ("curtain",),
    ("bathtub", "shower"),
)


def measure_furnishing(houses: Sequence[HouseView]) -> Figures:
    """The figures of checks 8 to 12."""
    return {**_counts(houses), **_cover(houses), **_laws(houses), **_presence(houses),
            **_sizes(houses)}  # fmt: skip


def _rooms(houses: Sequence[HouseView], *types: RoomType) -> list[RoomView]:
    return [view for house in houses for view in house.rooms if view.type in types]


def _counts(houses: Sequence[HouseView]) -> Figures:
    figures: Figures = {}
    for kind in MAIN:
        counts = [len(view.standing) for view in _rooms(houses, kind)]
        figures[f"floor objects p50, {kind}"] = quantile(counts, 0.5)
    for kind in MAIN:
        counts = [len(view.on_surfaces) for view in _rooms(houses, kind)]
        figures[f"surface objects p50, {kind}"] = quantile(counts, 0.5)
    every = [view for house in houses for view in house.rooms]
    hung = [sum(t.label != "curtain" for t in view.hung) for view in every]
    figures["wall-hung objects, mean of a room"] = Figure(float(np.mean(hung)) if hung else None)
    figures["rooms with fewer than 2 floor objects"] = number(len(v.standing) < 2 for v in every)
    return figures


def _covered(view: RoomView) -> float:
    return float(shapely.union_all([thing.floor for thing in view.standing]).area)


def _cover(houses: Sequence[HouseView]) -> Figures:
    figures = {
        f"floor cover p50, {kind}": quantile(
            (_covered(view) / view.floor.area for view in _rooms(houses, kind)), 0.5
        )
        for kind in MAIN
    }
    whole = [
        sum(map(_covered, house.rooms)) / sum(view.floor.area for view in house.rooms)
        for house in houses
    ]
    figures["floor cover p10, house"] = quantile(whole, 0.1)
    figures["floor cover p90, house"] = quantile(whole, 0.9)
    return figures


def _laws(houses: Sequence[HouseView]) -> Figures:
    views = [view for house in houses for view in house.rooms]
    overlapping = [_overlaps(a, b) for view in views for a, b in combinations(view.standing, 2)]
    outside = [
        thing.floor.difference(view.floor.buffer(1e-3)).area > TOUCH
        for view in views
        for thing in (*view.standing, *view.hung)
    ]
    afloat = [abs(t.placed.base) > 0.01 for view in views for t in view.standing]
    spilled = [spill for house in houses for spill in _spills(house)]
    return {
        "overlapping footprints": number(overlapping),
        "objects outside their room": number(outside),
        "floor objects off the floor": number(afloat),
        "objects beyond what they stand on": number(spilled),
    }


def _overlaps(a: Thing, b: Thing) -> bool:
    seat = next((t for t in (a, b) if t.label in SEATS), None)
    paired = seat is not None and bool({a.label, b.label} & TABLES)
    allowed = TUCKED * seat.floor.area if paired and seat else 0.0
    return a.floor.intersects(b.floor) and a.floor.intersection(b.floor).area > allowed + TOUCH


def _spills(house: HouseView) -> list[bool]:
    known = {thing.placed.id: thing.floor for thing in house.things}
    return [
        thing.floor.difference(known[thing.placed.support].buffer(1e-3)).area > TOUCH
        for thing in house.things
        if thing.placed.support in known
    ]


def _presence(houses: Sequence[HouseView]) -> Figures:
    figures = {
        name: share(view.has(*labels) for view in _rooms(houses, *types))
        for name, types, labels in PRESENCE
    }
    for labels in IN_HOUSES:
        found = [any(t.label in labels for t in house.house.objects) for house in houses]
        figures[f"houses with {' or '.join(labels)}"] = share(found)
    return figures


def _sizes(houses: Sequence[HouseView]) -> Figures:
    sizes: dict[str, list[tuple[float, float, float]]] = defaultdict(list)
    for house in houses:
        for thing in house.things:
            sizes[thing.label].append(thing.placed.size)
    source = {label: row for label, row in reference().sizes.items() if len(sizes[label]) >= FEWEST}
    off = [m for label, row in source.items() for m in _off_median(label, row, sizes[label])]
    narrow = [m for label, row in source.items() for m in _narrow(label, row, sizes[label])]
    furniture = [label for label in source if label in reference().furniture]
    distinct = {label: len({_coarse(s) for s in sizes[label]}) for label in furniture}
    few = [f"{label} {count}" for label, count in distinct.items() if count < 10]
    chairs, others = _sets(houses)
    return {
        "class sizes with p50 within 15 %": within(off, 3 * len(source)),
        "class sizes with 60 % of the spread": within(narrow, 3 * len(source)),
        "furniture classes of 10 distinct sizes": within(few, len(furniture)),
        "distinct chairs among those of a house": chairs,
        "distinct other furniture of a house": others,
    }


def _off_median(label: str, row: Sizes, sizes: list[tuple[float, float, float]]) -> list[str]:
    found = np.median(np.array(sizes), axis=0)
    return [
        f"{label} {axis} {ours:.2f} for {theirs[1]:.2f}"
        for axis, ours, theirs in zip(("width", "depth", "height"), found, row.axes, strict=True)
        if abs(ours / theirs[1] - 1) > TOLERANCE
    ]


def _narrow(label: str, row: Sizes, sizes: list[tuple[float, float, float]]) -> list[str]:
    low, high = np.quantile(np.array(sizes), (0.1, 0.9), axis=0)
    return [
        f"{label} {axis} {ours:.2f} for {theirs[2] / theirs[0]:.2f}"
        for axis, ours, theirs in zip(
            ("width", "depth", "height"), high / low, row.axes, strict=True
        )
        if ours < SPREAD * theirs[2] / theirs[0]
    ]


def _coarse(size: tuple[float, float, float]) -> tuple[int, ...]:
    return tuple(round(side / 0.05) for side in size)


def _sets(houses: Sequence[HouseView]) -> tuple[Figure, Figure]:
    """Mean share of distinct pieces, over classes that a house has several of: chairs, others."""
    chairs, others = [], []
    for house in houses:
        kinds: dict[str, list[object]] = defaultdict(list)
        for thing in house.things:
            if thing.label in reference().furniture:
                kinds[thing.label].append((thing.placed.size, thing.placed.shape))
        for label, pieces in kinds.items():
            if len(pieces) > 1:
                into = chairs if label == "chair" else others
                into.append(len(set(pieces)) / len(pieces))
    mean = [float(np.mean(ratios)) if ratios else None for ratios in (chairs, others)]
    return Figure(mean[0]), Figure(mean[1])
