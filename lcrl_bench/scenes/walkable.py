"""`build_grid`: the tiles of a house the agent can stand on, and the open edges between them.

Everything is decided by MuJoCo's own collision detection. A fixed grid of tile centres connects
all rooms in only half of the real houses, although the body fits through every door; so the grid
may be shifted, an agent may stand beside a blocked centre, and as a last resort tiles get smaller.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.house import PASSABLE, House
from lcrl_bench.scenes.bridges import bridge
from lcrl_bench.scenes.grid import Grid
from lcrl_bench.scenes.lattice import FINE, Lattice
from lcrl_bench.scenes.layout import Layout, lay_tiles
from lcrl_bench.scenes.probe import CollisionProbe
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

SMALLER: Final = (0.6, 0.5)
"""Tile sizes in metres, tried if the usual one misses a room that a door leads to."""
CANDIDATES: Final = 3
"""Number of phases tried with MuJoCo, the best ones by the lattice."""
BESIDE: Final = 0.3
"""Metres from a wall at which the room behind an opening is looked up."""


def build_grid(house: House, semantics: Semantics = DEFAULT_SEMANTICS) -> Grid:
    """Derive the grid of a house from collision queries.

    Args:
        house: The house.
        semantics: Side of a tile and size of the body.

    Returns:
        The connected component with the most rooms, then the most tiles; its report says what was
        left out and which measures it took. Tiles are ordered by row, then column.

    Raises:
        InvalidHouseError: If the agent can't stand anywhere.
    """
    probe = CollisionProbe(house, semantics)
    best: Layout | None = None
    joined: NDArray[np.int64] | None = None
    for tile in (semantics.tile, *(side for side in SMALLER if side < semantics.tile)):
        lattice = Lattice.sample(house, probe, tile)
        joined = _joined_rooms(house, lattice) if joined is None else joined
        layout = _best_layout(lattice, probe, joined)
        if layout is not None and (best is None or len(layout.reached) > len(best.reached)):
            best = layout
        if best is not None and best.connects(joined):
            break
    if best is None or joined is None:
        fix = "Move furniture aside or enlarge a room: its body is "
        fix += f"{2 * semantics.agent_radius:g} m wide."
        raise InvalidHouseError(house.id, "the agent can't stand anywhere in it", fix=fix)
    return best.to_grid(house, semantics, joined)


def _best_layout(
    lattice: Lattice, probe: CollisionProbe, joined: NDArray[np.int64]
) -> Layout | None:
    """The best layout over all phases; the house's own lattice if it connects all rooms."""
    own = lay_tiles(lattice, (0, 0), probe)
    if own is not None and own.connects(joined):
        return own
    shifts = [(x, y) for x in range(FINE) for y in range(FINE)]
    guesses = [guess for shift in shifts if (guess := lay_tiles(lattice, shift)) is not None]
    guesses.sort(key=lambda guess: guess.score, reverse=True)
    tried = [lay_tiles(lattice, guess.phase, probe) for guess in guesses[:CANDIDATES]]
    layouts = [layout for layout in (own, *tried) if layout is not None]
    if not any(layout.connects(joined) for layout in layouts):
        layouts = [bridge(layout, lattice, probe) for layout in layouts]
    return max(layouts, key=lambda layout: layout.score, default=None)


def _joined_rooms(house: House, lattice: Lattice) -> NDArray[np.int64]:
    """[room]: its component of rooms connected by openings or open floor."""
    links = {*_open_floor(lattice), *_doors(house)}
    pairs = np.array(sorted(links), np.int64).reshape(-1, 2)
    size = len(house.rooms)
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _doors(house: House) -> Iterator[tuple[int, int]]:
    """Pairs of rooms with a passable opening between them."""
    names = {room.id: index for index, room in enumerate(house.rooms)}
    floors = np.array([Polygon(room.polygon) for room in house.rooms])
    for wall in house.walls:
        (x0, y0), (x1, y1) = wall.start, wall.end
        aside = np.array([y0 - y1, x1 - x0]) / wall.length * (wall.thickness / 2 + BESIDE)
        for opening in wall.openings:
            if opening.kind in PASSABLE:
                middle = np.array(wall.point((opening.start + opening.end) / 2))
                sides = [middle + aside, middle - aside]
                meets = [shapely.intersects_xy(floors, x, y) for x, y in sides]
                found = np.flatnonzero(np.any(meets, axis=0))
                found = found if len(found) == 2 else [names[name] for name in wall.rooms]
                if len(found) == 2:
                    yield int(found[0]), int(found[1])


def _open_floor(lattice: Lattice) -> Iterator[tuple[int, int]]:
    """Pairs of rooms between which the body fits from lattice point to lattice point."""
    room, fits = lattice.room, lattice.free & (lattice.room >= 0)
    for one, other in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        meets = fits[one] & fits[other] & (room[one] != room[other])
        pairs = np.stack([room[one][meets], room[other][meets]], axis=1)
        for first, second in np.unique(pairs, axis=0):
            yield int(first), int(second)
