"""Radiators, air conditioners and heaters."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import (
    count_of,
    disc,
    spans,
    split,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    block,
    box,
)


def radiator(size: Vector) -> list[Part]:
    """A row of ribs between two pipes, with a valve."""
    x, y, z = spans(size)
    count = count_of(size[0], 0.09, 9, least=3)
    body = within(x, 0.02, 0.94)
    ribs = split(body, count, 0.3 * (body[1] - body[0]) / count)
    return [
        *[box(f"rib-{k + 1}", span, y, z, tints.PAINT) for k, span in enumerate(ribs)],
        box("pipe-upper", within(x, 0, 0.96), within(y, 0.3, 0.7), within(z, 0.84, 0.92),
            tints.PAINT),
        box("pipe-lower", within(x, 0, 0.96), within(y, 0.3, 0.7), within(z, 0.08, 0.16),
            tints.PAINT),
        box("valve", within(x, 0.94, 1), within(y, 0.25, 0.75), within(z, 0.82, 0.94),
            tints.STEEL),
    ]  # fmt: skip


def air_conditioner(size: Vector) -> list[Part]:
    """A wall unit with a rounded front, an outlet flap and a light."""
    x, y, z = spans(size)
    return [
        box("body", x, within(y, 0, 0.7), z, tints.PAINT),
        block("front", (within(x, 0.01, 0.99), within(y, 0.7, 0.92)), (within(x, 0.01, 0.99),
              within(y, 0.7, 1)), within(z, 0.3, 0.97), tints.CERAMIC),
        block("flap", (within(x, 0.06, 0.94), within(y, 0.7, 0.78)), (within(x, 0.06, 0.94),
              within(y, 0.82, 0.9)), within(z, 0.03, 0.27), tints.STEEL),
        box("light", within(x, 0.9, 0.93), within(y, 0.9, 0.985), within(z, 0.42, 0.48),
            tints.GREEN),
        box("grille", within(x, 0.08, 0.92), within(y, 0.95, 0.99), within(z, 0.8, 0.86),
            tints.STONE),
    ]  # fmt: skip


def fan_heater(size: Vector) -> list[Part]:
    """A standing heater: feet, a body with a grille of slats, a handle and a dial."""
    x, y, z = spans(size)
    return [
        box("foot-left", within(x, 0.05, 0.15), y, within(z, 0, 0.08), tints.RUBBER),
        box("foot-right", within(x, 0.85, 0.95), y, within(z, 0, 0.08), tints.RUBBER),
        box("body", x, within(y, 0.15, 0.75), within(z, 0.08, 0.9), tints.PAINT),
        *[box(f"slat-{k + 1}", within(x, 0.1, 0.9), within(y, 0.74, 0.86),
              within(z, 0.17 + 0.11 * k, 0.22 + 0.11 * k), tints.IRON) for k in range(5)],
        disc("dial", within(x, 0.7, 0.9), within(z, 0.74, 0.87), within(y, 0.75, 0.87),
               tints.IRON, sides=8),
        hollow("arch", "handle", within(x, 0.3, 0.7), within(y, 0.35, 0.55), within(z, 0.88, 1),
               tints.IRON),
    ]  # fmt: skip
