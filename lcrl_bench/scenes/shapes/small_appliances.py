"""Coffee machines and toasters."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import (
    disc,
    inset,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    block,
    box,
    cylinder,
    lathe,
)


def drip_coffee_machine(size: Vector) -> list[Part]:
    """A filter machine: a base, a tank behind, a head above, and a glass jug."""
    x, y, z = spans(size)
    return [
        box("base", within(x, 0.08, 0.92), y, within(z, 0, 0.09), tints.IRON),
        box("tank", within(x, 0.1, 0.9), within(y, 0, 0.34), within(z, 0.09, 0.72), tints.IRON),
        box("head", x, within(y, 0.01, 0.95), within(z, 0.72, 1), tints.STEEL),
        block("filter", (within(x, 0.36, 0.64), within(y, 0.52, 0.78)), (within(x, 0.24, 0.76),
              within(y, 0.42, 0.9)), within(z, 0.58, 0.73), tints.IRON),
        lathe("jug", within(x, 0.2, 0.8), within(y, 0.38, 0.92), within(z, 0.1, 0.56), tints.GLASS,
              profile=((0.85, 0.0), (1.0, 0.35), (0.6, 1.0))),
        box("jug-handle", within(x, 0.47, 0.53), within(y, 0.88, 0.99), within(z, 0.2, 0.48),
            tints.IRON),
    ]  # fmt: skip


def espresso_machine(size: Vector) -> list[Part]:
    """A steel body with a brewing head, a filter holder, a drip tray and a cup rail."""
    x, y, z = spans(size)
    return [
        box("tray", within(x, 0.02, 0.98), y, within(z, 0, 0.12), tints.IRON),
        box("body", x, within(y, 0, 0.5), within(z, 0.12, 0.93), tints.STEEL),
        box("head", within(x, 0.01, 0.99), within(y, 0.5, 0.88), within(z, 0.64, 0.93),
            tints.STEEL),
        box("rail", within(x, 0.05, 0.95), within(y, 0.05, 0.8), within(z, 0.93, 1), tints.IRON),
        cylinder("brewer", within(x, 0.32, 0.68), within(y, 0.52, 0.82), within(z, 0.54, 0.65),
                 tints.IRON),
        box("holder", within(x, 0.45, 0.55), within(y, 0.75, 1), within(z, 0.51, 0.57),
            tints.DARK_WOOD),
        hollow("tea-cup", "cup", within(x, 0.36, 0.64), within(y, 0.56, 0.82),
               within(z, 0.13, 0.32), tints.CERAMIC),
        disc("gauge", within(x, 0.42, 0.58), within(z, 0.7, 0.88), within(y, 0.86, 0.92),
               tints.PAINT, sides=8),
    ]  # fmt: skip


def capsule_machine(size: Vector) -> list[Part]:
    """A slim machine with an overhanging spout, a lever and a water tank behind."""
    x, y, z = spans(size)
    return [
        box("foot", within(x, 0.1, 0.9), within(y, 0.15, 1), within(z, 0, 0.1), tints.RUBBER),
        box("grid", within(x, 0.2, 0.8), within(y, 0.6, 0.96), within(z, 0.1, 0.13), tints.STEEL),
        block("column", (within(x, 0.14, 0.86), within(y, 0.2, 0.58)), (within(x, 0.14, 0.86),
              within(y, 0.2, 0.66)), within(z, 0.1, 0.7), tints.RED),
        cylinder("tank", x, within(y, 0, 0.34), within(z, 0.06, 0.84), tints.GLASS, sides=8),
        block("nose", (within(x, 0.18, 0.82), within(y, 0.22, 0.9)), (within(x, 0.14, 0.86),
              within(y, 0.25, 0.8)), within(z, 0.66, 0.92), tints.RED),
        box("spout", within(x, 0.42, 0.58), within(y, 0.72, 0.86), within(z, 0.56, 0.67),
            tints.STEEL),
        box("lever", within(x, 0.3, 0.7), within(y, 0.45, 0.92), within(z, 0.93, 1), tints.STEEL),
        box("hinge", within(x, 0.4, 0.6), within(y, 0.46, 0.54), within(z, 0.9, 0.95),
            tints.STEEL),
    ]  # fmt: skip


def slot_toaster(size: Vector) -> list[Part]:
    """Two slices standing in the slots of a steel body, with levers at its end."""
    x, y, z = spans(size)
    wide = inset(x, 0.06 * size[0])
    return [
        box("foot", within(wide, 0.03, 0.97), within(y, 0.05, 0.95), within(z, 0, 0.08),
            tints.RUBBER),
        box("body", wide, y, within(z, 0.08, 0.72), tints.STEEL),
        block("crown", (wide, y), (within(wide, 0.05, 0.95), within(y, 0.12, 0.88)),
              within(z, 0.72, 0.84), tints.STEEL),
        box("slice-front", within(wide, 0.16, 0.84), within(y, 0.62, 0.74), within(z, 0.6, 1),
            tints.FUR),
        box("slice-rear", within(wide, 0.16, 0.84), within(y, 0.26, 0.38), within(z, 0.6, 1),
            tints.FUR),
        box("lever", within(x, 0.93, 1), within(y, 0.4, 0.6), within(z, 0.5, 0.58), tints.IRON),
        box("stop", within(x, 0, 0.07), within(y, 0.42, 0.58), within(z, 0.24, 0.36), tints.IRON),
    ]  # fmt: skip


def long_toaster(size: Vector) -> list[Part]:
    """A rounded body with one long slot between rails, a lever and a dial in front."""
    x, y, z = spans(size)
    deep = within(y, 0, 0.9)
    return [
        block("lower", (within(x, 0.03, 0.97), within(deep, 0.06, 0.94)), (x, deep),
              within(z, 0, 0.2), tints.RED),
        box("body", x, deep, within(z, 0.2, 0.7), tints.RED),
        block("upper", (x, deep), (within(x, 0.05, 0.95), within(deep, 0.2, 0.8)),
              within(z, 0.7, 0.9), tints.RED),
        box("rail-front", within(x, 0.1, 0.9), within(deep, 0.62, 0.7), within(z, 0.85, 1),
            tints.STEEL),
        box("rail-rear", within(x, 0.1, 0.9), within(deep, 0.3, 0.38), within(z, 0.85, 1),
            tints.STEEL),
        box("lever", within(x, 0.84, 0.92), within(y, 0.88, 1), within(z, 0.52, 0.62),
            tints.STEEL),
        disc("dial", within(x, 0.55, 0.75), within(z, 0.2, 0.45), within(y, 0.89, 0.97),
               tints.STEEL, sides=8),
    ]  # fmt: skip
