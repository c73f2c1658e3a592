"""`Surface`: a labelled triangle mesh in the house's frame, the only source of geometry.

The MJCF meshes, the panorama cameras, the rays and the recordings all use the same list of
surfaces, so they can't disagree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh of one class."""

    name: str
    """Unique in its house: `"wall-3"`, `"chair-12.seat"`."""
    label: str
    """Class name."""
    vertices: NDArray[np.float64]
    """[vertex, 3] metres, house frame."""
    faces: NDArray[np.int32]
    """[triangle, 3] vertex indices, counter-clockwise seen from outside."""
    room: str | None
    """Id of its room; None for walls and anything else that spans rooms."""
    object: str | None = None
    """Id of its placed object; None for the building."""
