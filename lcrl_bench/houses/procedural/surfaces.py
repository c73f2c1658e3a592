"""Things on furniture: lamps and pillows, the 14 objects that tasks move, and clutter.

Everything stands on a face of `houses.receptacles`, entirely inside it, touching it and nothing
else; task objects are within reach of a tile an agent can stand on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.houses.house import PlacedObject, RoomType
from lcrl_bench.houses.procedural.furnish import SHAPES
from lcrl_bench.houses.procedural.hangings import Box
from lcrl_bench.houses.procedural.recipes import (
    Dressing,
    Kind,
    TaskObject,
    draw_count,
    draw_size,
    kinds,
    surfaces,
)
from lcrl_bench.houses.procedural.roomfloor import RoomFloor
from lcrl_bench.houses.receptacles import Face, faces

TRIES: Final = 14
PLACES: Final = 12
"""Faces tried per object."""
GAP: Final = 0.012
"""Minimum gap between two things on one face, in metres."""
REACH: Final = 0.9
"""Largest distance of a task object's centre from the nearest free tile, in metres."""
ROUND: Final = frozenset(
    {"cup", "fruit_bowl", "vase", "bottle", "candle", "plate", "plant", "lamp"}
)
"""Classes without a front, turned any way."""
STEADY: Final = frozenset({"television", "microwave", "coffee_machine", "pillow"})
"""Classes aligned with what they stand on."""
TASK_CLASSES: Final = (8, 12)
"""Minimum and maximum number of the 14 classes in a house."""
SPREAD: Final = 0.35
"""Factor on an object's weight in a room type for each of its class already in one."""
HIGHEST: Final = 1.5
"""Largest height of task objects above the floor, in metres."""


@dataclass(eq=False)
class Stand:
    """A face and the things on it so far."""

    owner: PlacedObject
    face: Face
    room: RoomFloor
    headroom: float
    """Metres of free height above it."""
    levels: int
    """Number of faces of its owner."""
    tiles: NDArray[np.float64]
    """[tile, 2]: centres of the free tiles in that room."""
    taken: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Occupied rectangles in the face's frame."""


@dataclass(eq=False)
class Table:
    """All faces in a house, and the things on them."""

    stands: list[Stand]
    hung: dict[str, list[Box]]
    """Boxes of the things on the walls of each room."""
    things: list[PlacedObject] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)

    def place(
        self, stand: Stand, name: str, where: str, rng: np.random.Generator, *, near: bool = False
    ) -> bool:
        """Try to place a thing of the kind `name` on a face; return whether there was room.

        Args:
            stand: The face.
            name: The kind.
            where: Part of the face: "back", "edge", "centre", "head" or "any".
            rng: Draws size, place and turn.
            near: Whether it must be within reach of a free tile.
        """
        kind = kinds()[name]
        size, shape = _fitting(kind, stand.face, rng), int(rng.integers(SHAPES))
        if size[2] > stand.headroom - 0.02:
            return False
        for _ in range(TRIES):
            turn = _turn(kind.label, rng)
            half = _half(size, turn)
            spot = _spot(stand.face, half, where, rng)
            if spot is None:
                return False
            rect = (spot[0] - half[0], spot[1] - half[1], spot[0] + half[0], spot[1] + half[1])
            if any(_touch(rect, other) for other in stand.taken):
                continue
            thing = self._thing(stand, name, kind, size, spot, turn, shape)
            if self._is_clear(stand, thing, near):
                stand.taken.append(rect)
                self.things.append(thing)
                self.counts[kind.label] = self.counts.get(kind.label, 0) + 1
                return True
        return False

    def _thing(
        self,
        stand: Stand,
        name: str,
        kind: Kind,
        size: tuple[float, float, float],
        spot: tuple[float, float],
        turn: float,
        shape: int,
    ) -> PlacedObject:
        face = stand.face
        cos, sin = math.cos(face.yaw), math.sin(face.yaw)
        x = face.center[0] + spot[0] * cos - spot[1] * sin
        y = face.center[1] + spot[0] * sin + spot[1] * cos
        number = self.counts.get(kind.label, 0) + 1
        return PlacedObject(
            id=f"{kind.label.replace('_', '-')}-{number}",
            label=kind.label,
            room=stand.room.name,
            position=(round(x, 5), round(y, 5), face.height + size[2] / 2),
            size=size,
            yaw=math.remainder(face.yaw + turn, math.tau),
            support=stand.owner.id,
            shape=shape,
            source_label="" if name == kind.label else name,
        )

    def _is_clear(self, stand: Stand, thing: PlacedObject, near: bool) -> bool:
        xs, ys = zip(*thing.footprint(), strict=True)
        box = (min(xs), min(ys), thing.base, max(xs), max(ys), thing.top)
        for other in self.hung[stand.room.name]:
            if all(box[i] < other[i + 3] + 0.01 and other[i] < box[i + 3] + 0.01 for i in range(3)):
                return False
        if not near:
            return True
        away = np.hypot(*(stand.tiles - np.array(thing.position[:2])).T)
        return bool(away.min() <= REACH)


def _turn(label: str, rng: np.random.Generator) -> float:
    if label in STEADY:
        return 0.0
    if label in ROUND:
        return float(rng.uniform(-math.pi, math.pi))
    return float(np.clip(rng.normal(0.0, 0.15), -0.4, 0.4))


def _fitting(kind: Kind, face: Face, rng: np.random.Generator) -> tuple[float, float, float]:
    """A size drawn for a thing, no larger than the face if the kind can be that small."""
    width, depth, height = draw_size(kind, rng)
    widest, deepest = 2 * face.half[0] - 0.02, 2 * face.half[1] - 0.02
    return (
        round(min(width, max(widest, kind.width[0])), 3),
        round(min(depth, max(deepest, kind.depth[0])), 3),
        height,
    )


def _half(size: tuple[float, float, float], turn: float) -> tuple[float, float]:
    cos, sin = abs(math.cos(turn)), abs(math.sin(turn))
    return (size[0] * cos + size[1] * sin) / 2, (size[0] * sin + size[1] * cos) / 2


def _touch(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return all(a[i] < b[i + 2] + GAP and b[i] < a[i + 2] + GAP for i in range(2))


def _spot(
    face: Face, half: tuple[float, float], where: str, rng: np.random.Generator
) -> tuple[float, float] | None:
    """The centre of a thing in the face's frame; None if the face is too small for it."""
    room = face.half[0] - half[0] - 0.004, face.half[1] - half[1] - 0.004
    if min(room) < 0:
        return None
    u, v = float(rng.uniform(-1, 1)), float(rng.uniform(-1, 1))
    if where in ("back", "head"):
        v = -1.0 + 0.25 * abs(v) if where == "back" else -1.0
    elif where == "edge":
        v = 1.0 - 0.4 * abs(v)
    elif where == "centre":
        u, v = 0.45 * u, 0.45 * v
    elif min(room) > 0.3:
        # On large faces, things stand near an edge.
        if rng.random() < 0.5:
            u = math.copysign(1.0 - 0.5 * abs(u), u)
        else:
            v = math.copysign(1.0 - 0.5 * abs(v), v)
    return u * room[0], v * room[1]


def set_out(
    rooms: tuple[RoomFloor, ...],
    furniture: list[PlacedObject],
    hung: dict[str, list[Box]],
    counts: dict[str, int],
    rng: np.random.Generator,
) -> list[PlacedObject]:
    """Place everything that stands on the furniture of a house.

    Args:
        rooms: The furnished rooms.
        furniture: The pieces on the floor, as placed objects.
        hung: Boxes of the things on the walls of each room, by room id.
        counts: Number of objects per class so far, for their ids; updated in place.
        rng: Draws everything random.
    """
    table = Table(_stands(rooms, furniture), hung, counts=counts)
    recipe = surfaces()
    for entry in recipe.dressing:
        _dress(table, entry, rng)
    _task_objects(table, recipe.task, rng)
    for entry in recipe.clutter:
        _dress(table, entry, rng)
    return table.things


def _stands(rooms: tuple[RoomFloor, ...], furniture: list[PlacedObject]) -> list[Stand]:
    by_name = {room.name: room for room in rooms}
    tiles = {room.name: room.tiles[room.free()] for room in rooms}
    stands = []
    for owner in furniture:
        levels = faces(owner)
        ceilings = [face.height for face in levels[1:]] + [by_name[owner.room].height]
        for face, ceiling in zip(levels, ceilings, strict=False):
            stands.append(
                Stand(
                    owner,
                    face,
                    by_name[owner.room],
                    ceiling - face.height,
                    len(levels),
                    tiles[owner.room],
                )
            )
    return stands


def _dress(table: Table, entry: Dressing, rng: np.random.Generator) -> None:
    owners: dict[str, list[Stand]] = {}
    for stand in table.stands:
        fits = not entry.rooms or stand.room.type in entry.rooms
        if stand.owner.label in entry.on and fits:
            owners.setdefault(stand.owner.id, []).append(stand)
    for levels in owners.values():
        if rng.random() >= entry.chance:
            continue
        for _ in range(draw_count(entry.count, rng)):
            table.place(levels[int(rng.integers(len(levels)))], entry.kind, entry.where, rng)


def _task_objects(table: Table, recipes: dict[str, TaskObject], rng: np.random.Generator) -> None:
    present: list[str] = []
    for _ in range(50):
        present = [name for name, recipe in recipes.items() if rng.random() < recipe.chance]
        if TASK_CLASSES[0] <= len(present) <= TASK_CLASSES[1]:
            break
    # One of each first, as the first ones get the best places.
    found = [name for name in present if _stand_somewhere(table, name, recipes[name], rng)]
    others = [name for name in recipes if name not in present]
    for index in rng.permutation(len(others)):
        name = others[int(index)]
        if len(found) < TASK_CLASSES[0] and _stand_somewhere(table, name, recipes[name], rng):
            found.append(name)
    for name in found:
        more = rng.choice(len(recipes[name].counts), p=_shares(recipes[name].counts))
        for _ in range(int(more)):
            _stand_somewhere(table, name, recipes[name], rng)


def _shares(weights: tuple[float, ...]) -> NDArray[np.float64]:
    return np.array(weights) / sum(weights)


def _stand_somewhere(table: Table, name: str, recipe: TaskObject, rng: np.random.Generator) -> bool:
    """Place one object where its recipe puts it; return whether there was room anywhere."""
    homes = {stand.owner.id: stand.room.type for stand in table.stands}
    kin = [homes[thing.support or ""] for thing in table.things if thing.label == name]
    weights = np.array([_weight(stand, recipe, kin) for stand in table.stands])
    for _ in range(PLACES):
        if weights.sum() <= 0:
            return False
        choice = int(rng.choice(len(weights), p=weights / weights.sum()))
        if table.place(table.stands[choice], name, "any", rng, near=True):
            return True
        weights[choice] = 0.0
    return False


def _weight(stand: Stand, recipe: TaskObject, kin: list[RoomType]) -> float:
    """The weight of a stand; lower if such a room already has one of the class."""
    if stand.face.height > HIGHEST:
        return 0.0
    room = recipe.rooms.get(stand.room.type, 0.0)
    crowd = stand.levels * (1.0 + 0.25 * len(stand.taken))
    spread = SPREAD ** kin.count(stand.room.type)
    return room * recipe.on.get(stand.owner.label, 0.0) * spread / crowd
