"""`build_grid`: which tiles of a house the agent can stand in, and which ways are open.

Everything is asked of MuJoCo's own collision detection. A fixed grid of tile centres connects all
rooms of only half of the real houses, although the body fits through every door; so the grid may
be shifted, an agent may stand beside a blocked centre, and as a last resort tiles get smaller.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.house import PASSABLE, House
from lcrl_bench.scenes.grid import Grid, GridReport
from lcrl_bench.scenes.probe import CollisionProbe
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

SMALLER: Final = (0.6, 0.5)
"""Tiles, in metres, tried where the usual ones leave out a room that a door leads to."""
FINE: Final = 5
"""Lattice points along the side of a tile; odd, so that one is its centre."""
CANDIDATES: Final = 3
"""Phases that are tried with MuJoCo, of those that the lattice says are the best."""
BESIDE: Final = 0.3
"""Metres beside a wall at which the room an opening leads to is looked up."""


def build_grid(house: House, semantics: Semantics = DEFAULT_SEMANTICS) -> Grid:
    """Derive the grid of a house from collision queries.

    Args:
        house: The house.
        semantics: Side of a tile and size of the body.

    Returns:
        The largest connected part of the grid that reaches the most rooms; its report says what
        was left out and what it took. Tiles are in order of row, then column.

    Raises:
        InvalidHouseError: If the agent can stand nowhere.
    """
    probe = CollisionProbe(house, semantics)
    best: _Layout | None = None
    joined: NDArray[np.int64] | None = None
    for tile in (semantics.tile, *(side for side in SMALLER if side < semantics.tile)):
        lattice = _Lattice.sample(house, probe, tile)
        joined = _joined_rooms(house, lattice) if joined is None else joined
        layout = _best_layout(lattice, probe, joined)
        if layout is not None and (best is None or len(layout.reached) > len(best.reached)):
            best = layout
        if best is not None and best.connects(joined):
            break
    if best is None or joined is None:
        fix = "Move furniture aside or enlarge a room: its body is "
        fix += f"{2 * semantics.agent_radius:g} m wide."
        raise InvalidHouseError(house.id, "the agent can stand nowhere in it", fix=fix)
    return best.to_grid(house, semantics, joined)


@dataclass(frozen=True, eq=False)
class _Lattice:
    """Where the body fits, at five by five points a tile."""

    tile: float
    corner: NDArray[np.float64]
    """[2]: south-west corner of the first tile at phase 0."""
    free: NDArray[np.bool_]
    """[x, y]: whether the body touches nothing."""
    room: NDArray[np.int64]
    """[x, y]: index of the room a point lies in; -1 outside."""

    @classmethod
    def sample(cls, house: House, probe: CollisionProbe, tile: float) -> _Lattice:
        floors = [Polygon(room.polygon) for room in house.rooms]
        west, south, east, north = shapely.total_bounds(floors)
        low = np.floor(np.array([west, south]) / tile).astype(int)
        high = np.ceil(np.array([east, north]) / tile).astype(int)
        counts = (high - low) * FINE
        corner = low * tile
        x, y = (corner[k] + (np.arange(counts[k]) + 0.5) * tile / FINE for k in (0, 1))
        east_of, north_of = np.meshgrid(x, y, indexing="ij")
        room = np.full(counts, -1, np.int64)
        for index, floor in reversed(list(enumerate(floors))):
            shapely.prepare(floor)
            room[shapely.intersects_xy(floor, east_of, north_of)] = index
        # A little beyond the rooms too: floors may end at the faces of the walls between them.
        asked = np.asarray(ndimage.binary_dilation(room >= 0, iterations=2), bool)
        free = np.zeros(counts, bool)
        free[asked] = probe.free(np.stack([east_of[asked], north_of[asked]], axis=1))
        return cls(tile, corner, free, room)

    def clearance(self) -> NDArray[np.float64]:
        """[x, y]: lattice steps to the nearest point where the body doesn't fit."""
        return np.asarray(ndimage.distance_transform_edt(np.pad(self.free, 1)))[1:-1, 1:-1]

    def index(self, points: NDArray[np.float64]) -> tuple[NDArray[np.int64], ...]:
        """Indices of the lattice points nearest to [..., 2] points."""
        at = np.floor((points - self.corner) * FINE / self.tile).astype(np.int64)
        at = np.clip(at, 0, np.array(self.free.shape) - 1)
        return at[..., 0], at[..., 1]


@dataclass(frozen=True, eq=False)
class _Layout:
    """Tiles of one phase, where the agent stands in them, and which ways are open."""

    tile: float
    phase: tuple[int, int]
    cells: NDArray[np.int64]
    points: NDArray[np.float64]
    centered: NDArray[np.bool_]
    room: NDArray[np.int64]
    pairs: NDArray[np.int64]
    """[pair, 2]: neighbouring tiles with an open way, the western or southern one first."""
    part: NDArray[np.int64]
    """[tile]: which connected part each belongs to."""
    kept: int
    """The part that reaches the most rooms, then has the most tiles."""

    @property
    def inside(self) -> NDArray[np.bool_]:
        """[tile]: whether each belongs to the part that is kept."""
        return self.part == self.kept

    @property
    def reached(self) -> frozenset[int]:
        """Indices of the rooms reached."""
        return frozenset(np.unique(self.room[self.inside]).tolist())

    @property
    def score(self) -> tuple[int, int]:
        """Rooms reached and tiles: more is better."""
        return len(self.reached), int(self.inside.sum())

    def missed(self, joined: NDArray[np.int64]) -> frozenset[int]:
        """Indices of the rooms left out that openings join to those reached."""
        hoped = np.flatnonzero(np.isin(joined, joined[list(self.reached)])).tolist()
        return frozenset(hoped) - self.reached

    def connects(self, joined: NDArray[np.int64]) -> bool:
        """Whether it reaches as many rooms as openings join, and all that it should."""
        return not self.missed(joined) and len(self.reached) >= np.bincount(joined).max()

    def to_grid(self, house: House, semantics: Semantics, joined: NDArray[np.int64]) -> Grid:
        """The grid of the part that is kept."""
        kept = np.flatnonzero(self.inside)
        kept = kept[np.lexsort((self.cells[kept, 0], self.cells[kept, 1]))]
        renumbered = np.full(len(self.cells), -1)
        renumbered[kept] = np.arange(len(kept))
        neighbours = np.full((len(kept), 4), -1, np.int64)
        for one, other in renumbered[self.pairs[self.inside[self.pairs[:, 0]]]]:
            east = self.cells[kept[one], 1] == self.cells[kept[other], 1]
            neighbours[one, 1 if east else 0] = other
            neighbours[other, 3 if east else 2] = one
        first = self.cells[kept].min(axis=0)
        center = (first + 0.5 + np.array(self.phase) / FINE) * self.tile
        names = [room.id for room in house.rooms]
        others = [index for index in range(len(names)) if index not in self.reached]
        report = GridReport(
            tiles_free=len(self.cells),
            tiles_reachable=len(kept),
            rooms_reached=tuple(names[index] for index in sorted(self.reached)),
            rooms_unreached=tuple(names[index] for index in others),
            rooms_missed=tuple(names[index] for index in sorted(self.missed(joined))),
            measures=tuple(self._measures(semantics)),
        )
        return Grid(
            tile=self.tile,
            origin=(float(center[0]), float(center[1])),
            cells=self.cells[kept] - first,
            points=self.points[kept],
            neighbours=neighbours,
            rooms=tuple(names[index] for index in self.room[kept]),
            report=report,
        )

    def _measures(self, semantics: Semantics) -> Iterator[str]:
        if self.phase != (0, 0):
            yield "phase"
        pairs = self.pairs[self.centered[self.pairs].all(axis=1)]
        room = np.where(self.centered, self.room, -1)
        part, kept = _parts(pairs, room)
        if not self.reached <= frozenset(room[part == kept].tolist()):
            yield "standing points"
        if self.tile < semantics.tile:
            yield "smaller tile"


def _best_layout(
    lattice: _Lattice, probe: CollisionProbe, joined: NDArray[np.int64]
) -> _Layout | None:
    """The best layout over all phases; the house's own lattice if it connects all rooms."""
    own = _layout(lattice, (0, 0), probe)
    if own is not None and own.connects(joined):
        return own
    shifts = [(x, y) for x in range(FINE) for y in range(FINE)]
    guesses = [guess for shift in shifts if (guess := _layout(lattice, shift, None)) is not None]
    guesses.sort(key=lambda guess: guess.score, reverse=True)
    layouts = [_layout(lattice, guess.phase, probe) for guess in guesses[:CANDIDATES]]
    return max(
        (layout for layout in (own, *layouts) if layout is not None),
        key=lambda layout: layout.score,
        default=None,
    )


def _layout(
    lattice: _Lattice, phase: tuple[int, int], probe: CollisionProbe | None
) -> _Layout | None:
    """Lay tiles over the lattice; without a probe, ways are only guessed from the lattice."""
    cells, points, centered = _standing_points(lattice, phase)
    if len(cells) == 0:
        return None
    room = lattice.room[lattice.index(points)]
    pairs = _adjacent(cells)
    if probe is None:
        shares = np.linspace(0, 1, 2 * FINE + 1)[:, None, None]
        way = points[pairs[:, 0]] * (1 - shares) + points[pairs[:, 1]] * shares
        is_open = lattice.free[lattice.index(way)].all(axis=0)
    else:
        is_open = np.array([probe.is_clear(*points[pair]) for pair in pairs], bool)
    pairs = pairs[is_open]
    part, kept = _parts(pairs, room)
    return _Layout(lattice.tile, phase, cells, points, centered, room, pairs, part, kept)


def _standing_points(
    lattice: _Lattice, phase: tuple[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
    """Tiles with room for the body: [tile, 2] cells, [tile, 2] points, [tile] at the centre."""
    shift = tuple((-step) % FINE for step in phase)
    fits = lattice.free & (lattice.room >= 0)
    # The freest point; the centre wherever the body fits there; of equals the most central.
    value = np.where(fits, lattice.clearance(), 0.0)
    pads = [(skip, -(size + skip) % FINE) for skip, size in zip(shift, fits.shape, strict=True)]
    value = np.pad(value, pads)
    columns, rows = (size // FINE for size in value.shape)
    value = value.reshape(columns, FINE, rows, FINE).transpose(0, 2, 1, 3)
    offset = np.arange(FINE) - FINE // 2
    central = 0.01 * (offset[:, None] ** 2 + offset[None, :] ** 2)
    value = np.where(value > 0, value - central, 0.0)
    middle = value[:, :, FINE // 2, FINE // 2] > 0
    choice = value.reshape(columns, rows, -1).argmax(axis=-1)
    choice[middle] = FINE * FINE // 2
    cells = np.argwhere(value.max(axis=(2, 3)) > 0)
    column, row = cells.T
    fine = np.stack(np.divmod(choice[column, row], FINE), axis=-1)
    lattice_index = cells * FINE + fine - np.array(shift)
    points = lattice.corner + (lattice_index + 0.5) * lattice.tile / FINE
    first = np.rint(lattice.corner / lattice.tile).astype(np.int64)
    cells = cells + first - np.array([step > 0 for step in phase])
    return cells, points, middle[column, row]


def _adjacent(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """[pair, 2]: indices of cells side by side, the western or southern one first."""
    index = {(int(column), int(row)): number for number, (column, row) in enumerate(cells)}
    pairs = [
        (number, index[beside])
        for (column, row), number in index.items()
        for beside in ((column + 1, row), (column, row + 1))
        if beside in index
    ]
    return np.array(pairs, np.int64).reshape(-1, 2)


def _parts(pairs: NDArray[np.int64], room: NDArray[np.int64]) -> tuple[NDArray[np.int64], int]:
    """[tile]: number of the connected part, and the part with the most rooms, then tiles."""
    size = len(room)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    count, part = connected_components(links, directed=False)
    tiles = np.bincount(part, minlength=count)
    rooms = np.bincount(np.unique(np.stack([part, room]), axis=1)[0], minlength=count)
    return part.astype(np.int64), int(np.lexsort((tiles, rooms))[-1])


def _joined_rooms(house: House, lattice: _Lattice) -> NDArray[np.int64]:
    """[room]: which set of rooms each belongs to that openings or open floor join."""
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


def _open_floor(lattice: _Lattice) -> Iterator[tuple[int, int]]:
    """Pairs of rooms between which the body passes from lattice point to lattice point."""
    room, fits = lattice.room, lattice.free & (lattice.room >= 0)
    for one, other in ((np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:])):
        meets = fits[one] & fits[other] & (room[one] != room[other])
        pairs = np.stack([room[one][meets], room[other][meets]], axis=1)
        for first, second in np.unique(pairs, axis=0):
            yield int(first), int(second)
