"""`Arrangement`: how a house differs from its House JSON while an object is moved."""

from __future__ import annotations

from dataclasses import dataclass

from lcrl_bench.houses.house import PlacedObject


@dataclass(frozen=True)
class Arrangement:
    """Which object is away from its place, and where it is now."""

    hidden: str | None = None
    """Id of an object that is not at its place; None if all are."""
    placed: PlacedObject | None = None
    """That object at its new place; None while it is held and thus invisible."""


AS_FOUND = Arrangement()
"""Everything where the House JSON places it."""
