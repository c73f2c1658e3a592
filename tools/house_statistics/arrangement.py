"""Checks 13-15: furniture at walls and in corners, its orientation, and what it stands next to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from lcrl_bench.houses.house import RoomType
from tools.house_statistics.view import Figure, Figures, HouseView, RoomView, Thing, share

AT_WALLS: Final = (
    *("bed", "dresser", "desk", "side_table", "countertop", "refrigerator", "toilet", "sink"),
    *("stove", "wardrobe", "tv_stand", "armchair", "sofa", "shelf", "trash_can", "chair"),
    *("dining_table", "coffee_table"),
)
BACKED: Final = AT_WALLS[:10]
"""Classes that should stand with their back to a wall."""
CORNERED: Final = ("bed", "dresser", "refrigerator")
LARGE: Final = frozenset(
    {*BACKED, "tv_stand", "sofa", "shelf", "dining_table", "base_cabinet", "bathtub", "shower",
     "dishwasher", "washing_machine", "coffee_table", "bench", "stairs"}
)  # fmt: skip
NEAR_WALL: Final = 0.3
SQUARE: Final = 0.01
"""Deviation from a right angle that counts as rounding, in quarter turns."""

Case = tuple[RoomView, Thing]


def measure_arrangement(houses: Sequence[HouseView]) -> Figures:
    """The figures of checks 13 to 15."""
    cases = [(view, thing) for h in houses for view in h.rooms for thing in view.standing]
    return {**_walls(cases), **_companions(houses, cases)}


def _of(cases: Sequence[Case], *labels: str) -> list[Case]:
    return [(view, thing) for view, thing in cases if thing.label in labels]


def _walls(cases: Sequence[Case]) -> Figures:
    figures = {
        f"at a wall, {label}": share(
            view.rim.distance(thing.floor) <= NEAR_WALL for view, thing in _of(cases, label)
        )
        for label in AT_WALLS
    }
    backs = [
        (thing.label, view.rim.intersects(thing.behind(NEAR_WALL)))
        for view, thing in _of(cases, *BACKED)
    ]
    figures["back to a wall"] = share(ok for _, ok in backs)
    for label in CORNERED:
        figures[f"in a corner, {label}"] = share(
            _in_corner(view, thing) for view, thing in _of(cases, label)
        )
    turned = [(t.placed.yaw / (math.pi / 2)) % 1 for _, t in _of(cases, *LARGE)]
    figures["large furniture square to the house"] = share(
        min(turn, 1 - turn) < SQUARE for turn in turned
    )
    return figures


def _in_corner(view: RoomView, thing: Thing) -> bool:
    """Whether walls on two perpendicular sides are near."""
    reach = thing.floor.buffer(NEAR_WALL, join_style="mitre")
    x0, y0, x1, y1 = view.rim.intersection(reach).bounds if reach.intersects(view.rim) else (0,) * 4
    # Walls that meet within reach span both directions; a single straight wall only one.
    return min(x1 - x0, y1 - y0) > 0.05


def _companions(houses: Sequence[HouseView], cases: Sequence[Case]) -> Figures:
    tables = ("dining_table", "desk", "countertop")
    chairs = _of(cases, "chair")
    sofas = [case for case in _of(cases, "sofa") if case[0].type is RoomType.LIVING_ROOM]
    seated = [(chair, _nearest(view, chair, *tables)) for view, chair in chairs]
    facing = [chair.faces(t) > 0.7 for chair, t in seated if t and _gap(chair, t) <= 0.35]
    screens = [(h, t) for h in houses for t in h.things if t.label == "television"]
    pillows = [(h, t) for h in houses for t in h.things if t.label == "pillow"]
    return {
        "chair at a table or desk": share(t is not None and _gap(c, t) <= 0.35 for c, t in seated),
        "chair faces its table": share(facing),
        "bed with side table within 0.5 m": _with(_of(cases, "bed"), "side_table", 0.5),
        "sofa with coffee table within 1 m": _with(sofas, "coffee_table", 1.0),
        "sofa faces a television": share(_watches(view, sofa) for view, sofa in sofas),
        "television on a stand or wall": share(
            t.placed.support is None or _on(h, t) == "tv_stand" for h, t in screens
        ),
        "armchair with floor lamp": _with(_of(cases, "armchair"), "lamp", 1.0),
        "pillow on a bed or sofa": share(_on(h, t) in ("bed", "sofa") for h, t in pillows),
    }


def _gap(a: Thing, b: Thing) -> float:
    return float(a.floor.distance(b.floor))


def _nearest(view: RoomView, thing: Thing, *labels: str) -> Thing | None:
    return min(view.of(*labels), key=lambda other: _gap(thing, other), default=None)


def _with(cases: Sequence[Case], label: str, reach: float) -> Figure:
    nearest = [(thing, _nearest(view, thing, label)) for view, thing in cases]
    return share(other is not None and _gap(thing, other) <= reach for thing, other in nearest)


def _watches(view: RoomView, sofa: Thing) -> bool:
    """Whether a sofa faces a television, or its stand, at viewing distance."""
    hung = [thing for thing in view.hung if thing.label == "television"]
    screens = [*view.of("tv_stand"), *hung]
    return any(sofa.faces(s) > 0.7 and 0.9 <= _gap(sofa, s) <= 4.3 for s in screens)


def _on(house: HouseView, thing: Thing) -> str:
    """The class of what a thing stands on; empty if it stands on nothing."""
    support = thing.placed.support
    return "" if support is None else house.house.object(support).label
