"""Non-convex templates: bowls, shades, basins, rings, handles.

Each has a name; its convex hulls, for collisions, are in `assets/hulls/<name>.npz`, made from the
template in the unit box by `scripts/make_hulls.py`. Hollows are only ever stretched along x, y
and z, so their hulls stretch with them and fit at any size.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Final

import numpy as np
import trimesh

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.houses.house import Point
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Span,
    Template,
    Tint,
    extruded,
    loft,
    normalised,
    place,
    ring,
)


def hollow(name: str, label: str, x: Span, y: Span, z: Span, tint: Tint) -> Part:
    """The hollow `name` as a part named `label`, filling the box of three spans."""
    return place(hollow_template(name), label, x, y, z, tint, hollow=name)


@lru_cache(maxsize=128)
def hollow_template(name: str) -> Template:
    """The template named `name`.

    Raises:
        UnknownNameError: If there is none.
    """
    if name not in _BUILDERS:
        raise UnknownNameError("hollow", name, _BUILDERS)
    return _BUILDERS[name]()


def hollow_names() -> tuple[str, ...]:
    """Names of all hollows, sorted."""
    return tuple(sorted(_BUILDERS))


def _vessel(*profile: Point, sides: int = 8) -> Template:
    """A vessel of revolution: (radius, height) up the outside, over the rim and down inside."""
    line = [(0.0, profile[0][1]), *profile, (0.0, profile[-1][1])]
    return normalised(trimesh.creation.revolve(np.array(line), sections=sides))


def _sleeve(*profile: Point, sides: int = 8) -> Template:
    """A ring of revolution, open at both ends: (radius, height) around its section."""
    line = [*profile, profile[0]]
    return normalised(trimesh.creation.revolve(np.array(line), sections=sides))


def _trough(points: int, roundness: float, rim: float, foot: float, floor: float) -> Template:
    """A rounded rectangular vessel.

    `rim`: the wall's share of the half width. `foot`: the underside's share of the outline.
    `floor`: height of the inner floor.
    """
    inner = 1 - rim
    # The floor stays inside the outline at its height.
    base = inner * min(max(foot, 0.75), foot + (1 - foot) * floor)
    rings = [(foot, 0.0), (1.0, 1.0), (inner, 1.0), (base, floor)]
    return loft(np.stack([ring(points, roundness, (half, half), z) for half, z in rings]))


def _oval_ring(points: int, width: float) -> Template:
    """A flat oval ring with a rectangular section; `width` is a share of the half width."""
    inner = 1 - width
    rings = [(inner, 0.0), (1.0, 0.0), (1.0, 1.0), (inner, 1.0)]
    return loft(np.stack([ring(points, 1.0, (s, s), z) for s, z in rings]), closed=True)


_MUG_HANDLE: Final = (
    (0.0, 0.0), (1.0, 0.15), (1.0, 0.85), (0.0, 1.0),
    (0.0, 0.78), (0.72, 0.68), (0.72, 0.32), (0.0, 0.22),
)  # fmt: skip
_ARCH: Final = (
    (0.0, 0.0), (0.13, 0.0), (0.25, 0.8), (0.75, 0.8),
    (0.87, 0.0), (1.0, 0.0), (0.85, 1.0), (0.15, 1.0),
)  # fmt: skip
# Seen from above, open to the front (+y).
_ROUND_BACK: Final = (
    (0.0, 1.0), (0.0, 0.35), (0.12, 0.1), (0.35, 0.0), (0.65, 0.0), (0.88, 0.1), (1.0, 0.35),
    (1.0, 1.0), (0.86, 1.0), (0.86, 0.45), (0.74, 0.24), (0.26, 0.24), (0.14, 0.45), (0.14, 1.0),
)  # fmt: skip

_BUILDERS: Final[dict[str, Callable[[], Template]]] = {
    "arch": partial(extruded, _ARCH, "x"),
    "basin-oval": partial(_trough, 12, 0.8, 0.1, 0.45, 0.2),
    "basin-square": partial(_trough, 4, 1.0, 0.08, 0.85, 0.15),
    "bathtub-oval": partial(_trough, 12, 0.8, 0.07, 0.75, 0.14),
    "bathtub-square": partial(_trough, 12, 0.3, 0.1, 1.0, 0.14),
    "bin-round": partial(_vessel, (0.75, 0.0), (1.0, 1.0), (0.94, 1.0), (0.7, 0.05)),
    "bin-square": partial(_trough, 4, 1.0, 0.06, 0.75, 0.05),
    "bowl": partial(_vessel, (0.5, 0.0), (1.0, 1.0), (0.92, 1.0), (0.42, 0.2), sides=10),
    "dish": partial(_vessel, (0.6, 0.0), (1.0, 0.8), (1.0, 1.0), (0.58, 0.35), sides=10),
    "mug": partial(_vessel, (0.94, 0.0), (1.0, 1.0), (0.87, 1.0), (0.8, 0.12)),
    "mug-handle": partial(extruded, _MUG_HANDLE, "y"),
    "pan": partial(_vessel, (0.82, 0.0), (1.0, 1.0), (0.93, 1.0), (0.77, 0.15), sides=10),
    "round-back": partial(extruded, _ROUND_BACK, "z"),
    "seat-ring": partial(_oval_ring, 10, 0.3),
    "shade-cone": partial(_sleeve, (1.0, 0.0), (0.55, 1.0), (0.5, 1.0), (0.94, 0.0)),
    "shade-drum": partial(_sleeve, (1.0, 0.0), (0.9, 1.0), (0.85, 1.0), (0.94, 0.0)),
    "tea-cup": partial(_vessel, (0.4, 0.0), (0.85, 0.4), (1.0, 1.0), (0.88, 1.0), (0.35, 0.15)),
    "toilet-bowl": partial(_trough, 10, 0.9, 0.26, 0.6, 0.35),
    "tumbler": partial(_vessel, (0.8, 0.0), (1.0, 1.0), (0.88, 1.0), (0.7, 0.1)),
    "vase-amphora": partial(
        _vessel, (0.45, 0.0), (1.0, 0.5), (0.85, 0.7), (0.4, 0.88), (0.55, 1.0), (0.44, 1.0),
        (0.28, 0.88), sides=8,
    ),
    "vase-flute": partial(
        _vessel, (0.7, 0.0), (0.45, 0.15), (0.6, 0.6), (1.0, 1.0), (0.88, 1.0), (0.45, 0.6),
        sides=8,
    ),
    "vase-globe": partial(
        _vessel, (0.5, 0.0), (0.95, 0.25), (1.0, 0.5), (0.75, 0.8), (0.42, 0.92), (0.5, 1.0),
        (0.4, 1.0), (0.3, 0.9), sides=8,
    ),
}  # fmt: skip
