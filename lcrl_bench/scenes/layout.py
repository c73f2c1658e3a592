"""`Layout`: tiles laid over a house, their standing points, and the open edges between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from lcrl_bench.houses.house import House
from lcrl_bench.scenes.grid import Grid, GridReport
from lcrl_bench.scenes.lattice import FINE, Lattice
from lcrl_bench.scenes.probe import CollisionProbe
from lcrl_bench.semantics import Semantics


@dataclass(frozen=True, eq=False)
class Layout:
    """Tiles of one phase, their standing points, and the open edges between them."""

    tile: float
    phase: tuple[int, int]
    cells: NDArray[np.int64]
    points: NDArray[np.float64]
    centered: NDArray[np.bool_]
    room: NDArray[np.int64]
    pairs: NDArray[np.int64]
    """[pair, 2]: adjacent tiles with an open edge, the western or southern one first."""
    part: NDArray[np.int64]
    """[tile]: the connected component of each."""
    kept: int
    """The component with the most rooms, then the most tiles."""

    @property
    def inside(self) -> NDArray[np.bool_]:
        """[tile]: whether each belongs to the component kept."""
        return self.part == self.kept

    @property
    def reached(self) -> frozenset[int]:
        """Indices of the rooms reached."""
        return frozenset(np.unique(self.room[self.inside]).tolist())

    @property
    def score(self) -> tuple[int, int]:
        """Numbers of rooms reached and of tiles; higher is better."""
        return len(self.reached), int(self.inside.sum())

    def missed(self, joined: NDArray[np.int64]) -> frozenset[int]:
        """Indices of the unreached rooms that openings connect to reached ones."""
        hoped = np.flatnonzero(np.isin(joined, joined[list(self.reached)])).tolist()
        return frozenset(hoped) - self.reached

    def connects(self, joined: NDArray[np.int64]) -> bool:
        """Whether it reaches every room that openings connect, and as many as possible."""
        return not self.missed(joined) and len(self.reached) >= np.bincount(joined).max()

    def to_grid(self, house: House, semantics: Semantics, joined: NDArray[np.int64]) -> Grid:
        """The grid of the component kept."""
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
        part, kept = connected(pairs, room)
        if not self.reached <= frozenset(room[part == kept].tolist()):
            yield "standing points"
        if self.tile < semantics.tile:
            yield "smaller tile"


def lay_tiles(
    lattice: Lattice, phase: tuple[int, int], probe: CollisionProbe | None = None
) -> Layout | None:
    """Lay tiles over the lattice; without a probe, edges are estimated from the lattice."""
    cells, points, centered = _standing_points(lattice, phase)
    if len(cells) == 0:
        return None
    room = lattice.room[lattice.index(points)]
    pairs = adjacent(cells)
    if probe is None:
        is_open = lattice.is_open(points[pairs[:, 0]], points[pairs[:, 1]])
    else:
        is_open = np.array([probe.is_clear(*points[pair]) for pair in pairs], bool)
    pairs = pairs[is_open]
    part, kept = connected(pairs, room)
    return Layout(lattice.tile, phase, cells, points, centered, room, pairs, part, kept)


def _standing_points(
    lattice: Lattice, phase: tuple[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
    """Tiles where the body fits: [tile, 2] cells, [tile, 2] points, [tile] at the centre."""
    shift = tuple((-step) % FINE for step in phase)
    fits = lattice.free & (lattice.room >= 0)
    # The centre if the body fits there, else the point with most clearance; ties: most central.
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


def adjacent(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """[pair, 2]: indices of adjacent cells, the western or southern one first."""
    index = {(int(column), int(row)): number for number, (column, row) in enumerate(cells)}
    pairs = [
        (number, index[beside])
        for (column, row), number in index.items()
        for beside in ((column + 1, row), (column, row + 1))
        if beside in index
    ]
    return np.array(pairs, np.int64).reshape(-1, 2)


def connected(pairs: NDArray[np.int64], room: NDArray[np.int64]) -> tuple[NDArray[np.int64], int]:
    """[tile]: the connected component; and the component with the most rooms, then tiles."""
    size = len(room)
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(size, size))
    count, part = connected_components(links, directed=False)
    tiles = np.bincount(part, minlength=count)
    rooms = np.bincount(np.unique(np.stack([part, room]), axis=1)[0], minlength=count)
    return part.astype(np.int64), int(np.lexsort((tiles, rooms))[-1])
