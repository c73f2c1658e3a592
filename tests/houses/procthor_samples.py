"""ProcTHOR house files written by hand, as plain JSON values."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from lcrl_bench.houses.imported import ImportedHouse
from lcrl_bench.houses.procthor import import_procthor
from lcrl_bench.houses.procthor.models import models

Json = dict[str, Any]
HEIGHT = 3.0
KITCHEN, BEDROOM = "room|1", "room|2"
SHARED = "wall|1|4.00|0.00|4.00|4.00", "wall|2|4.00|0.00|4.00|4.00"
SOUTH = "wall|1|0.00|0.00|4.00|0.00", "wall|exterior|0.00|0.00|4.00|0.00"
EAST = "wall|2|8.00|0.00|8.00|4.00", "wall|exterior|8.00|0.00|8.00|4.00"


def asset(kind: str, place: int = 0) -> str:
    """An asset id of the index with this object type."""
    return [name for name, model in models().items() if model.type == kind][place]


def xyz(x: float, y: float, z: float) -> Json:
    return {"x": x, "y": y, "z": z}


def room(name: str, kind: str, west: float, south: float, east: float, north: float) -> Json:
    """A rectangular room; its floor runs clockwise in (x, z), as in every real file."""
    corners = [(west, south), (west, north), (east, north), (east, south)]
    return {
        "id": name,
        "roomType": kind,
        "floorPolygon": [xyz(x, 0, z) for x, z in corners],
        "floorMaterial": {"name": "WoodFloor"},
        "ceilings": [],
        "children": [],
    }


def side(name: str, owner: str, start: tuple, end: tuple, *, high_first: bool = False) -> Json:
    """One side of a wall from `start` to `end`; outer sides list their high points first."""
    low = [xyz(start[0], 0, start[1]), xyz(end[0], 0, end[1])]
    high = [xyz(start[0], HEIGHT, start[1]), xyz(end[0], HEIGHT, end[1])]
    polygon = [*high, *low] if high_first else [*low, *high]
    return {"id": name, "roomId": owner, "polygon": polygon, "material": {"name": "Paint"}}


def outer(name: str, owner: str, start: tuple, end: tuple) -> list[Json]:
    """Both sides of an outer wall: the room's, and the outside's the other way."""
    number = owner.split("|")[1]
    twin = name.replace(f"wall|{number}|", "wall|exterior|")
    return [side(name, owner, start, end), side(twin, "exterior", end, start, high_first=True)]


def door(
    walls: tuple[str, str], rooms: tuple[str, str], low: float, high: float, **more: Any
) -> Json:
    """A door or a window, its hole in the plane of the first wall."""
    return {
        "id": f"door|{rooms[0][5:]}|{rooms[1][5:]}",
        "assetId": asset("Doorway"),
        "room0": rooms[0],
        "room1": rooms[1],
        "wall0": walls[0],
        "wall1": walls[1],
        "holePolygon": [xyz(low, 0, 0), xyz(high, 2.1, 0)],
        "assetPosition": xyz((low + high) / 2, 1.05, 0),
        "openable": True,
        "openness": 1,
        **more,
    }


def thing(
    name: str, kind: str, x: float, z: float, *, turn: float = 0.0, y: float | None = None
) -> Json:
    """An object of a type; on the floor unless `y`, the height of its centre, is given."""
    model = asset(kind)
    centre = models()[model].size[2] / 2 if y is None else y
    return {
        "id": name,
        "assetId": model,
        "position": xyz(x, centre, z),
        "rotation": xyz(0, turn, 0),
        "kinematic": True,
    }


def two_rooms() -> Json:
    """A kitchen (west) and a bedroom (east), 4 m square each, with a door between them."""
    table = thing("DiningTable|1|0", "DiningTable", 2.0, 2.0)
    top = models()[table["assetId"]].size[2]
    half = models()[asset("Cup")].size[2] / 2
    table["children"] = [thing("Cup|surface|1|0", "Cup", 2.1, 2.0, y=top + half)]
    window = door(EAST, (BEDROOM, BEDROOM), 1.0, 2.0)
    window |= {"id": "window|2|0", "assetId": asset("Window")}
    window["holePolygon"] = [xyz(1.0, 0.9, 0), xyz(2.0, 2.0, 0)]
    return {
        "rooms": [
            room(KITCHEN, "Kitchen", 0, 0, 4, 4),
            room(BEDROOM, "Bedroom", 4, 0, 8, 4),
        ],
        "walls": [
            *outer(SOUTH[0], KITCHEN, (4, 0), (0, 0)),
            *outer("wall|1|0.00|0.00|0.00|4.00", KITCHEN, (0, 0), (0, 4)),
            *outer("wall|1|0.00|4.00|4.00|4.00", KITCHEN, (0, 4), (4, 4)),
            side(SHARED[0], KITCHEN, (4, 4), (4, 0)),
            side(SHARED[1], BEDROOM, (4, 0), (4, 4)),
            *outer("wall|2|4.00|4.00|8.00|4.00", BEDROOM, (4, 4), (8, 4)),
            *outer(EAST[0], BEDROOM, (8, 4), (8, 0)),
            *outer("wall|2|4.00|0.00|8.00|0.00", BEDROOM, (8, 0), (4, 0)),
        ],
        "doors": [
            door(SHARED, (KITCHEN, BEDROOM), 0.5, 1.5),
            door(SOUTH, (KITCHEN, KITCHEN), 1.0, 2.0, openable=False, openness=0),
        ],
        "windows": [window],
        "objects": [
            table,
            thing("Chair|1|1", "Chair", 1.0, 2.0, turn=90),
            thing("Bed|2|0", "Bed", 6.0, 2.0),
            thing("Painting|2|1", "Painting", 6.0, 3.98, turn=180, y=1.6),
        ],
        "proceduralParameters": {"lights": [], "skyboxId": "Sky1"},
        "metadata": {"schema": "1.0.0", "roomSpecId": "kitchen-bedroom", "warnings": {}},
    }


def write(value: object, folder: Path, name: str = "house.json") -> Path:
    """Write a JSON value as a file; NaN and infinity as Python's json writes them."""
    path = folder / name
    path.write_text(json.dumps(value))
    return path


def read(value: object, folder: Path) -> ImportedHouse:
    """Write a house file and import it."""
    return import_procthor(write(value, folder))
