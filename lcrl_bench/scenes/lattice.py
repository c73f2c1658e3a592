"""`Lattice`: where the agent's body fits, sampled at five by five points per tile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy import ndimage
from shapely.geometry import Polygon

from lcrl_bench.errors import InvalidHouseError
from lcrl_bench.houses.house import House
from lcrl_bench.scenes.probe import CollisionProbe

FINE: Final = 5
"""Lattice points along a tile's side; odd, so that one is the centre."""

WIDEST: Final = 200.0
"""Largest width or length of a house in metres; the lattice's memory grows with their product."""


@dataclass(frozen=True, eq=False)
class Lattice:
    """A fine lattice over a house; its answers about paths are fast approximations."""

    tile: float
    corner: NDArray[np.float64]
    """[2]: south-west corner of the first tile at phase 0."""
    free: NDArray[np.bool_]
    """[x, y]: whether the body touches nothing."""
    room: NDArray[np.int64]
    """[x, y]: index of the room of each point; -1 outside."""

    @classmethod
    def sample(cls, house: House, probe: CollisionProbe, tile: float) -> Lattice:
        """Test the body at every point in or just outside a room; `tile` is in metres.

        Raises:
            InvalidHouseError: If the rooms are too far apart to be one house.
        """
        floors = [Polygon(room.polygon) for room in house.rooms]
        west, south, east, north = shapely.total_bounds(floors)
        if max(east - west, north - south) > WIDEST:
            reason = f"its rooms span {east - west:.0f} x {north - south:.0f} m"
            fix = f"A house is at most {WIDEST:g} m wide: is it in metres, and only one?"
            raise InvalidHouseError(house.id, reason, fix=fix)
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
        # A little beyond the rooms too, as floors may end at the faces of the walls between them.
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

    def is_open(self, start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether the straight paths from [..., 2] to [..., 2] points look free: [...]."""
        shares = np.linspace(0, 1, 2 * FINE + 1).reshape(-1, *[1] * np.broadcast(start, end).ndim)
        way = start * (1 - shares) + end * shares
        return np.all(self.free[self.index(way)], axis=0)
