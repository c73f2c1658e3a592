"""Toys."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import (
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    ball,
    block,
    box,
    cylinder,
    lathe,
)


def teddy_bear(size: Vector) -> list[Part]:
    """A sitting bear: belly, head with ears and muzzle, arms, and legs stretched forward."""
    x, y, z = spans(size)
    pieces = (
        ("belly", (0.2, 0.8), (0.05, 0.65), (0.0, 0.56), tints.FUR),
        ("head", (0.22, 0.78), (0.08, 0.66), (0.48, 0.94), tints.FUR),
        ("muzzle", (0.37, 0.63), (0.5, 0.78), (0.53, 0.73), tints.PALE_FABRIC),
        ("nose", (0.45, 0.55), (0.72, 0.82), (0.64, 0.71), tints.RUBBER),
        ("ear-left", (0.14, 0.4), (0.2, 0.48), (0.78, 1.0), tints.FUR),
        ("ear-right", (0.6, 0.86), (0.2, 0.48), (0.78, 1.0), tints.FUR),
        ("arm-left", (0.0, 0.28), (0.2, 0.62), (0.24, 0.52), tints.FUR),
        ("arm-right", (0.72, 1.0), (0.2, 0.62), (0.24, 0.52), tints.FUR),
        ("leg-left", (0.06, 0.36), (0.4, 1.0), (0.0, 0.24), tints.FUR),
        ("leg-right", (0.64, 0.94), (0.4, 1.0), (0.0, 0.24), tints.FUR),
        ("tail", (0.42, 0.58), (0.0, 0.14), (0.04, 0.18), tints.FUR),
    )
    small = {"nose", "tail", "ear-left", "ear-right"}
    return [
        ball(
            name,
            within(x, *a),
            within(y, *b),
            within(z, *c),
            tint,
            fineness=0 if name in small else 1,
        )
        for name, a, b, c, tint in pieces
    ]


def toy_ball(size: Vector) -> list[Part]:
    """A ball with a coloured band and caps."""
    x, y, z = spans(size)
    return [
        ball("ball", within(x, 0.03, 0.97), within(y, 0.03, 0.97), z, tints.ORANGE, fineness=2),
        lathe("band", x, y, within(z, 0.4, 0.6), tints.BLUE,
              profile=((0.96, 0.0), (1.0, 0.5), (0.96, 1.0)), sides=12),
    ]  # fmt: skip


def toy_car(size: Vector) -> list[Part]:
    """A car facing the front: body, cabin with windows, wheels and lights."""
    x, y, z = spans(size)
    wheels = [
        cylinder(f"wheel-{k + 1}", within(x, *side), within(y, *end), within(z, 0, 0.42),
                 tints.RUBBER, axis="x", sides=8)
        for k, (side, end) in enumerate(
            (side, end) for side in ((0.0, 0.16), (0.84, 1.0))
            for end in ((0.1, 0.34), (0.66, 0.9)))
    ]  # fmt: skip
    return [
        box("body", within(x, 0.06, 0.94), within(y, 0, 0.98), within(z, 0.18, 0.58), tints.RED),
        block("windows", (within(x, 0.1, 0.9), within(y, 0.14, 0.76)), (within(x, 0.16, 0.84),
              within(y, 0.24, 0.6)), within(z, 0.58, 0.92), tints.GLASS),
        box("roof", within(x, 0.14, 0.86), within(y, 0.23, 0.61), within(z, 0.92, 1), tints.RED),
        box("light-left", within(x, 0.14, 0.28), within(y, 0.97, 1), within(z, 0.36, 0.5),
            tints.YELLOW),
        box("light-right", within(x, 0.72, 0.86), within(y, 0.97, 1), within(z, 0.36, 0.5),
            tints.YELLOW),
        *wheels,
    ]  # fmt: skip


def toy_blocks(size: Vector) -> list[Part]:
    """A castle of building blocks with a pointed roof."""
    x, y, z = spans(size)
    return [
        box("block-1", within(x, 0, 0.46), within(y, 0.05, 0.6), within(z, 0, 0.36), tints.RED),
        box("block-2", within(x, 0.54, 1), within(y, 0, 0.55), within(z, 0, 0.36), tints.BLUE),
        box("block-3", within(x, 0.2, 0.62), within(y, 0.64, 1), within(z, 0, 0.34), tints.GREEN),
        box("block-4", within(x, 0.18, 0.84), within(y, 0.1, 0.5), within(z, 0.36, 0.66),
            tints.YELLOW),
        lathe("roof", within(x, 0.28, 0.74), within(y, 0.1, 0.5), within(z, 0.66, 1),
              tints.ORANGE, profile=((1.0, 0.0), (0.05, 1.0)), sides=4),
    ]  # fmt: skip
