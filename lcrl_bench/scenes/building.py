"""The building of a house as labelled meshes and boxes: floors, ceilings, walls, linings, panes.

Closed by construction: walls extend 4 cm into floor and ceiling and overlap where they meet, and
one sheet under all floors and one over all ceilings cover rooms and walls, so no ray from inside a
room escapes between two parts. Faces of different classes never share a plane where both could be
visible, so a rasteriser and a ray tracer agree on every pixel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
import shapely
import trimesh
from shapely.geometry import LineString, Polygon
from shapely.geometry.polygon import orient

from lcrl_bench.houses.house import House, Opening, OpeningKind, Room, Wall
from lcrl_bench.scenes.panel import Box, Panel, Rectangle, cut_panel
from lcrl_bench.scenes.surface import Surface

OVERLAP: Final = 0.04
"""Metres a wall extends into the floor and the ceiling."""
SLAB: Final = 0.05
"""Thickness of a room's floor and ceiling."""
SHEET: Final = 0.01
"""Metres between a room's floor or ceiling and the common sheet behind it."""
LINING: Final = 0.02
"""Metres a door's lining extends into the hole; a window's frame extends twice as far."""
ARCHITRAVE: Final = 0.04
"""Metres a lining overlaps the wall around the hole."""
PROUD: Final = 0.01
"""Metres a lining or frame protrudes from each side of its wall."""
LEAF: Final = 0.04
"""Thickness of a closed door."""
PANE: Final = 0.02
"""Thickness of a window pane."""
WIDEST_FRAMED: Final = 2.2
"""Doorways wider than this, or as high as their wall, are open-plan and have no lining."""


def building_surfaces(house: House) -> tuple[Surface, ...]:
    """The labelled meshes of floors, ceilings, walls, linings, closed doors and windows."""
    surfaces = [_floor(room) for room in house.rooms]
    surfaces += [_ceiling(room, house.height) for room in house.rooms]
    surfaces += _sheets(house)
    for panel in building_panels(house):
        vertices, faces = panel.mesh()
        surfaces.append(Surface(panel.name, panel.label, vertices, faces, None))
    return tuple(surfaces)


def building_boxes(house: House) -> tuple[Box, ...]:
    """The same walls, linings, closed doors and windows as convex collision boxes."""
    return tuple(box for panel in building_panels(house) for box in panel.boxes())


def building_panels(house: House) -> tuple[Panel, ...]:
    """All upright parts: each wall, followed by the fillings of its openings."""
    panels: list[Panel] = []
    for wall, reach in zip(house.walls, _overlaps(house.walls), strict=True):
        top = wall.height + OVERLAP if wall.height > house.height - SLAB else wall.height
        outline = (-reach[0], -OVERLAP, wall.length + reach[1], top)
        holes = [_hole(wall, opening) for opening in wall.openings]
        name = f"wall:{wall.id}"
        panels.append(cut_panel(name, "wall", _line(wall), wall.thickness, outline, holes))
        for number, opening in enumerate(wall.openings):
            panels += _filling(wall, opening, number)
    return tuple(panels)


def is_framed(wall: Wall, opening: Opening) -> bool:
    """Whether an opening has a lining: doors always, doorways unless open-plan."""
    if opening.kind is OpeningKind.WINDOW:
        return False
    narrow = opening.end - opening.start <= WIDEST_FRAMED
    return opening.kind is not OpeningKind.DOORWAY or (
        narrow and opening.top < wall.height - OVERLAP
    )


def _line(wall: Wall) -> tuple[tuple[float, float], float]:
    (x0, y0), (x1, y1) = wall.start, wall.end
    return wall.start, math.atan2(y1 - y0, x1 - x0)


def _hole(wall: Wall, opening: Opening) -> Rectangle:
    """An opening's hole; at floor or ceiling height it includes the overlap."""
    low = -2 * OVERLAP if opening.bottom <= 0 else opening.bottom
    high = wall.height + 2 * OVERLAP if opening.top >= wall.height else opening.top
    return opening.start, low, opening.end, high


def _filling(wall: Wall, opening: Opening, number: int) -> Iterator[Panel]:
    key = f"{wall.id}.{number}"
    line, proud = _line(wall), wall.thickness + 2 * PROUD
    start, end, bottom, top = opening.start, opening.end, opening.bottom, opening.top
    if is_framed(wall, opening):
        outline = (start - ARCHITRAVE, -LINING, end + ARCHITRAVE, top + ARCHITRAVE)
        inner = (start + LINING, -2 * LINING, end - LINING, top - LINING)
        yield cut_panel(f"frame:{key}", "door_frame", line, proud, outline, [inner])
    if opening.kind is OpeningKind.CLOSED_DOOR:
        leaf = (start + LINING / 2, -LINING * 1.5, end - LINING / 2, top - LINING / 2)
        yield cut_panel(f"door:{key}", "door", line, LEAF, leaf, [])
    elif opening.kind is OpeningKind.WINDOW:
        outline = (start - LINING, bottom - LINING, end + LINING, top + LINING)
        inner = (
            start + 2 * LINING,
            bottom + 2 * LINING,
            end - 2 * LINING,
            top - 2 * LINING,
        )
        pane = (start + LINING, bottom + LINING, end - LINING, top - LINING)
        yield cut_panel(f"window-frame:{key}", "window", line, proud, outline, [inner])
        if pane[0] < pane[2] and pane[1] < pane[3]:
            yield cut_panel(f"window:{key}", "window", line, PANE, pane, [])


def _overlaps(walls: tuple[Wall, ...]) -> list[tuple[float, float]]:
    """How far each wall extends past its start and its end to close its corners."""
    if not walls:
        return []
    lines = [LineString([wall.start, wall.end]) for wall in walls]
    ends = shapely.points([point for wall in walls for point in (wall.start, wall.end)])
    half = np.array([wall.thickness / 2 for wall in walls])
    near = shapely.distance(ends[:, None], np.array(lines)[None, :])
    near = near.reshape(len(walls), 2, len(walls)) <= half + PROUD
    near[np.arange(len(walls)), :, np.arange(len(walls))] = False
    yaw = np.array([_line(wall)[1] for wall in walls])
    parallel = np.abs(np.sin(yaw[:, None] - yaw[None, :])) < 0.1
    # Collinear walls form no corner: they only need to leave no gap.
    reach = np.where(near, np.where(parallel, 0.001, half)[:, None, :], 0.0).max(axis=2)
    return [(float(start), float(end)) for start, end in reach]


def _floor(room: Room) -> Surface:
    vertices, faces = _slab(Polygon(room.polygon), -SLAB, 0.0)
    return Surface(f"floor:{room.id}", "floor", vertices, faces, room.id)


def _ceiling(room: Room, height: float) -> Surface:
    vertices, faces = _open_above(Polygon(room.polygon), height, height + SLAB)
    return Surface(f"ceiling:{room.id}", "ceiling", vertices, faces, room.id)


def _sheets(house: House) -> list[Surface]:
    """One sheet of floor and one of ceiling behind all rooms and walls, to close the seams."""
    grounds = [Polygon(room.polygon) for room in house.rooms]
    for wall in house.walls:
        half = wall.thickness / 2 - SHEET
        if half > 0:
            grounds.append(LineString([wall.start, wall.end]).buffer(half, cap_style="flat"))
    whole = shapely.union_all(grounds, grid_size=1e-4)
    sheets = []
    for number, part in enumerate(shapely.get_parts(whole)):
        if not isinstance(part, Polygon) or part.area < 1e-3:
            continue
        below = _slab(part, -2 * SLAB, -SHEET)
        above = _open_above(part, house.height + SHEET, house.height + SHEET + SLAB)
        sheets.append(Surface(f"floor-sheet:{number}", "floor", *below, None))
        sheets.append(Surface(f"ceiling-sheet:{number}", "ceiling", *above, None))
    return sheets


Mesh = tuple[np.ndarray, np.ndarray]


def _slab(polygon: Polygon, low: float, high: float) -> Mesh:
    """A closed prism over a polygon: [vertex, 3] and [triangle, 3]."""
    solid = trimesh.creation.extrude_polygon(orient(polygon), high - low, engine="earcut")
    vertices = np.asarray(solid.vertices, np.float64) + np.array([0.0, 0.0, low])
    return vertices, np.asarray(solid.faces, np.int32)


def _open_above(polygon: Polygon, low: float, high: float) -> Mesh:
    """A prism without its lid: opaque from below, and transparent from above to a rasteriser."""
    vertices, faces = _slab(polygon, low, high)
    lid = np.isclose(vertices[faces][:, :, 2], high).all(axis=1)
    return vertices, faces[~lid]
