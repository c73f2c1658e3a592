"""Checks 16 and 21-25: what stands on what, and the objects that tasks move."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from lcrl_bench.houses.house import RoomType
from lcrl_bench.houses.receptacles import receptacle_labels
from tools.house_statistics.reference import Task, reference
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

FEWEST: Final = 10
"""Classes with fewer objects than this are not judged."""
WORKTOPS: Final = frozenset({"countertop", "base_cabinet", "stove", "dining_table"})
KITCHEN_THINGS: Final = frozenset({"microwave", "toaster", "kettle", "pan", "coffee_machine"})


@dataclass(frozen=True, eq=False)
class Item:
    """A thing on a piece of furniture."""

    house: HouseView
    room: RoomView
    thing: Thing
    parent: str
    """Class of the furniture it stands on."""

    @property
    def label(self) -> str:
        """Its class."""
        return self.thing.label


def measure_belongings(houses: Sequence[HouseView]) -> Figures:
    """The figures of checks 16 and 21 to 25."""
    items = [item for house in houses for item in _items(house)]
    tasks = reference().tasks
    mine = {name: [item for item in items if item.label == name] for name in tasks}
    return {
        **_receptacles(items, mine, tasks),
        **_numbers(houses, tasks),
        **_names(mine, tasks),
        **_variety(mine),
        **_homes(houses, mine, tasks),
        **_samples(houses),
    }


def _items(house: HouseView) -> list[Item]:
    labels = {thing.placed.id: thing.label for thing in house.things}
    return [
        Item(house, room, thing, labels.get(thing.placed.support or "", ""))
        for room in house.rooms
        for thing in room.on_surfaces
    ]


def _receptacles(items: list[Item], mine: dict[str, list[Item]], tasks: dict[str, Task]) -> Figures:
    judged = {name: found for name, found in mine.items() if len(found) >= FEWEST}
    far = []
    for name, found in judged.items():
        distance = _variation(Counter(item.parent for item in found), tasks[name].on)
        if distance > 0.25:
            far.append(f"{name} {distance:.2f}")
    off = []
    for name, found in judged.items():
        height = float(np.median([item.thing.placed.base for item in found]))
        if abs(height - tasks[name].base) > 0.10:
            off.append(f"{name} {height:.2f} for {tasks[name].base:.2f}")
    kitchen = [item for item in items if item.label in KITCHEN_THINGS]
    stands = receptacle_labels()
    return {
        "task classes on receptacles like the source's": within(far, len(judged)),
        "task classes at the source's height": within(off, len(judged)),
        "kitchen things on a worktop or table": share(i.parent in WORKTOPS for i in kitchen),
        "things on what has no top or seat": number(i.parent not in stands for i in items),
    }


def _variation(ours: Counter[str], theirs: dict[str, float]) -> float:
    """Total variation distance; everything the source does not list counts as one class."""
    total = sum(ours.values())
    listed = sum(abs(ours[label] / total - part) for label, part in theirs.items())
    rest = 1 - sum(ours[label] for label in theirs) / total - (1 - sum(theirs.values()))
    return (listed + abs(rest)) / 2


def _numbers(houses: Sequence[HouseView], tasks: dict[str, Task]) -> Figures:
    counts = [Counter(t.label for t in h.things if t.label in tasks) for h in houses]
    medium = [c for c, h in zip(counts, houses, strict=True) if 5 <= len(h.rooms) <= 7]
    off = []
    for name, task in tasks.items():
        some = float(np.mean([c[name] > 0 for c in counts]))
        one = float(np.mean([c[name] == 1 for c in counts]))
        if abs(some - task.any) > 0.2:
            off.append(f"{name} any {some:.2f} for {task.any:.2f}")
        if abs(one - task.one) > 0.2:
            off.append(f"{name} one {one:.2f} for {task.one:.2f}")
    return {
        "task classes of a house p50": quantile((len(c) for c in counts), 0.5),
        "task objects p50, houses of 5-7 rooms": quantile((c.total() for c in medium), 0.5),
        "task classes in any, in one: as often": within(off, 2 * len(tasks)),
    }


def _names(mine: dict[str, list[Item]], tasks: dict[str, Task]) -> Figures:
    by_room = {n: _sole(found, lambda i: i.room.type) for n, found in mine.items() if found}
    by_place = {
        n: _sole(found, lambda i: (i.room.type, i.parent)) for n, found in mine.items() if found
    }
    named = {n: task.named for n, task in tasks.items() if task.named is not None and n in by_room}
    off = [
        f"{name} {by_room[name]:.2f} for {aim:.2f}"
        for name, aim in named.items()
        if abs(by_room[name] - aim) > 0.2
    ]
    vague = [f"{name} {found:.2f}" for name, found in by_place.items() if found < 0.5]
    return {
        "task classes named by room type as often": within(off, len(named)),
        "task classes half named by receptacle and room": within(vague, len(by_place)),
    }


def _sole(items: list[Item], key: Callable[[Item], Hashable]) -> float:
    """The share of things whose key is unique within their house."""
    counts = Counter((id(item.house), key(item)) for item in items)
    return sum(counts[id(item.house), key(item)] == 1 for item in items) / len(items)


def _variety(mine: dict[str, list[Item]]) -> Figures:
    judged = {name: found for name, found in mine.items() if len(found) >= FEWEST}
    alike, few = [], []
    for name, found in judged.items():
        kinds = Counter(tuple(round(side, 2) for side in item.thing.placed.size) for item in found)
        commonest = max(kinds.values()) / len(found)
        few += [f"{name} {len(kinds)}"] if len(kinds) < 8 else []
        alike += [f"{name} {commonest:.2f}"] if commonest > 0.3 else []
    return {
        "task classes of 8 distinct sizes": within(few, len(judged)),
        "task classes with no size above 30 %": within(alike, len(judged)),
    }


def _homes(
    houses: Sequence[HouseView], mine: dict[str, list[Item]], tasks: dict[str, Task]
) -> Figures:
    rooms = Counter(view.type for house in houses for view in house.rooms)
    off, cases = [], 0
    for name, found in mine.items():
        ours = np.array([_share_of_rooms(found, kind, rooms) for kind in MAIN])
        theirs = np.array(tasks[name].rooms)
        if not found or not ours.any():
            continue
        cases += 1
        cosine = float(ours @ theirs / np.linalg.norm(ours) / np.linalg.norm(theirs))
        if cosine < 0.8:
            off.append(f"{name} {cosine:.2f}")
    return {"task classes in the source's room types": within(off, cases)}


def _share_of_rooms(found: list[Item], kind: RoomType, rooms: Counter[RoomType]) -> float:
    with_one = {id(item.room) for item in found if item.room.type is kind}
    return len(with_one) / max(1, rooms[kind])


def _samples(houses: Sequence[HouseView]) -> Figures:
    """The share of common classes that occur in rooms as often as in the source."""
    views = [view for house in houses for view in house.rooms if view.type in MAIN]
    if not views:
        return {"common classes as often in a room": Figure(None)}
    counts = [
        (view.type, Counter(t.label for t in (*view.standing, *view.hung, *view.on_surfaces)))
        for view in views
    ]
    off = []
    for label, row in reference().in_rooms.items():
        distance = 0.0
        for most, theirs in enumerate((row.none, row.one)):
            expected = np.mean([theirs[MAIN.index(kind)] for kind, _ in counts])
            ours = np.mean([count[label] <= most for _, count in counts])
            distance = max(distance, float(abs(ours - expected)))
        if distance > 0.2:
            off.append(f"{label} {distance:.2f}")
    return {"common classes as often in a room": within(off, len(reference().in_rooms))}
