"""`bridge`: move standing points to connect parts of a layout.

A door may lie between two rows of tiles: the centres on both sides are free, but the straight path
between them hits a jamb. Standing a little to the side opens the path.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.scenes.lattice import FINE, Lattice
from lcrl_bench.scenes.layout import Layout, adjacent, connected
from lcrl_bench.scenes.probe import CollisionProbe

TRIES: Final = 30
"""Maximum number of moves tried with MuJoCo per layout."""


def bridge(layout: Layout, lattice: Lattice, probe: CollisionProbe) -> Layout:
    """Connect parts of a layout while that reaches more rooms.

    Args:
        layout: Tiles, standing points and open edges.
        lattice: The lattice under it, which proposes moves.
        probe: Decides whether a moved point and its edges are free.

    Returns:
        A layout that reaches at least as many rooms.
    """
    tries = TRIES
    better: Layout | None = layout
    while better is not None and tries > 0:
        layout, better = better, None
        for pair, points in _moves(layout, lattice):
            tries -= 1
            moved = _moved(layout, pair, points, lattice, probe)
            if moved.score > layout.score:
                better = moved
            if better is not None or tries == 0:
                break
    return better or layout


def _moves(
    layout: Layout, lattice: Lattice
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float64]]]:
    """Pairs of adjacent tiles, one of them leading to unreached rooms, and points to stand on."""
    pairs = adjacent(layout.cells)
    inside = layout.inside[pairs]
    lacking = ~np.isin(layout.room, list(layout.reached))
    wanted = np.isin(layout.part, np.unique(layout.part[lacking]))[pairs] & ~inside
    for pair in pairs[(inside[:, 0] != inside[:, 1]) & wanted.any(axis=1)]:
        first, second = (_standing_room(layout, lattice, int(tile)) for tile in pair)
        if len(first) == 0 or len(second) == 0:
            continue
        ways = lattice.is_open(first[:, None], second[None, :])
        value = _ways_kept(layout, lattice, int(pair[0]), first)[:, None]
        value = value + _ways_kept(layout, lattice, int(pair[1]), second)[None, :]
        value = np.where(ways, value, -np.inf)
        one, other = np.unravel_index(int(value.argmax()), value.shape)
        if ways[one, other]:
            yield pair, np.stack([first[one], second[other]])


def _standing_room(layout: Layout, lattice: Lattice, tile: int) -> NDArray[np.float64]:
    """[point, 2]: the lattice points of a tile inside a room where the body fits."""
    offset = (np.arange(FINE) - FINE // 2) / FINE
    east, north = np.meshgrid(offset, offset, indexing="ij")
    aside = np.stack([east.ravel(), north.ravel()], axis=1)
    center = layout.cells[tile] + 0.5 + np.array(layout.phase) / FINE
    points = (center + aside) * layout.tile
    at = lattice.index(points)
    return points[lattice.free[at] & (lattice.room[at] >= 0)]


def _ways_kept(
    layout: Layout, lattice: Lattice, tile: int, points: NDArray[np.float64]
) -> NDArray[np.float64]:
    """[point]: number of a tile's open edges each point would keep; ties: the least moved."""
    beside = layout.pairs[(layout.pairs == tile).any(axis=1)]
    others = layout.points[beside[beside != tile]]
    kept = lattice.is_open(points[:, None], others[None, :]).sum(axis=1)
    return kept - 0.1 * np.linalg.norm(points - layout.points[tile], axis=1)


def _moved(
    layout: Layout,
    pair: NDArray[np.int64],
    points: NDArray[np.float64],
    lattice: Lattice,
    probe: CollisionProbe,
) -> Layout:
    """The layout with the standing points of two tiles moved and their edges checked again."""
    if not probe.free(points).all():
        return layout
    standing, centered, room = layout.points.copy(), layout.centered.copy(), layout.room.copy()
    centered[pair] &= (standing[pair] == points).all(axis=1)
    standing[pair] = points
    room[pair] = lattice.room[lattice.index(points)]
    pairs = adjacent(layout.cells)
    touched = np.isin(pairs, pair).any(axis=1)
    opened = [probe.is_clear(*standing[tiles]) for tiles in pairs[touched]]
    others = layout.pairs[~np.isin(layout.pairs, pair).any(axis=1)]
    pairs = np.concatenate([others, pairs[touched][np.array(opened, bool)]])
    part, kept = connected(pairs, room)
    return replace(
        layout,
        points=standing,
        centered=centered,
        room=room,
        pairs=pairs,
        part=part,
        kept=kept,
    )
