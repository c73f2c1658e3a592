"""Lamps: floor lamps if tall, else table lamps."""

from __future__ import annotations

import math

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import (
    about,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    ball,
    bar,
    block,
    box,
    cylinder,
    lathe,
)

_TALL = 1.0
"""Height in metres from which a lamp is a floor lamp."""


def shade_lamp(size: Vector) -> list[Part]:
    """A foot, a pole and a conical shade around a bulb; a turned body for a table lamp."""
    x, y, z = spans(size)
    tall = size[2] >= _TALL
    shade = (z[1] - (min(0.4, 0.25 * size[2]) if tall else 0.42 * size[2]), z[1])
    pole = min(0.03, 0.08 * size[0], 0.08 * size[1])
    plate = min(0.03, 0.06 * size[2])
    parts = [
        cylinder("foot", within(x, 0.18, 0.82), within(y, 0.18, 0.82), (0.0, plate), tints.BRASS,
                 sides=10),
        cylinder("pole", about(0, pole), about(0, pole), (plate, within(shade, 0, 0.3)[1]),
                 tints.BRASS, sides=6),
        ball("bulb", about(0, 2.5 * pole), about(0, 2.5 * pole), within(shade, 0.25, 0.6),
             tints.LAMPLIGHT),
        hollow("shade-cone", "shade", x, y, shade, tints.LAMPLIGHT),
    ]  # fmt: skip
    if not tall:
        parts.append(lathe("body", within(x, 0.28, 0.72), within(y, 0.28, 0.72),
                           (plate, 0.9 * shade[0]), tints.TERRACOTTA,
                           profile=((0.5, 0.0), (1.0, 0.35), (0.3, 1.0))))  # fmt: skip
    return parts


def tripod_lamp(size: Vector) -> list[Part]:
    """A drum shade on three splayed legs."""
    x, y, z = spans(size)
    shade = (z[1] - (min(0.4, 0.24 * size[2]) if size[2] >= _TALL else 0.4 * size[2]), z[1])
    leg = min(0.03, 0.08 * size[0], 0.08 * size[1])
    hub = shade[0] - 0.02 * size[2]
    parts = [
        hollow("shade-drum", "shade", x, y, shade, tints.LINEN),
        cylinder("hub", about(0, 3 * leg), about(0, 3 * leg), (hub - 0.05 * size[2], hub),
                 tints.WOOD, sides=6),
        box("stem", about(0, leg), about(0, leg), (hub, shade[0] + 0.4 * (z[1] - shade[0])),
            tints.BRASS),
        ball("bulb", about(0, 2.5 * leg), about(0, 2.5 * leg), within(shade, 0.3, 0.7),
             tints.LAMPLIGHT),
    ]  # fmt: skip
    for k in range(3):
        angle = math.pi / 2 + k * 2 * math.pi / 3
        aim = (0.4 * size[0] * math.cos(angle), 0.4 * size[1] * math.sin(angle))
        parts.append(block(f"leg-{k + 1}", (about(aim[0], leg), about(aim[1], leg)),
                           (about(0.1 * aim[0], leg), about(0.1 * aim[1], leg)),
                           (0.0, hub - 0.02 * size[2]), tints.WOOD))  # fmt: skip
    return parts


def reading_lamp(size: Vector) -> list[Part]:
    """A foot at the back, a jointed arm and a head that looks forward and down."""
    x, y, z = spans(size)
    arm = min(0.03, 0.1 * size[0], 0.1 * size[1], 0.1 * size[2])
    plate = min(0.03, 0.06 * size[2])
    elbow = (0.0, y[0] + 0.1 * size[1], 0.62 * size[2])
    neck = (0.0, y[0] + 0.62 * size[1], z[1] - 0.7 * arm)
    head = min(0.3 * size[2], 0.3)
    return [
        cylinder("foot", x, within(y, 0, 0.7), (0.0, plate), tints.IRON, sides=10),
        bar("arm-lower", (0.0, y[0] + 0.34 * size[1], plate * 0.7), elbow, arm, tints.IRON),
        bar("arm-upper", elbow, neck, arm, tints.IRON),
        lathe("head", within(x, 0.12, 0.88), within(y, 0.45, 1), (z[1] - head, z[1]), tints.IRON,
              profile=((1.0, 0.0), (0.9, 0.25), (0.3, 1.0))),
        ball("bulb", within(x, 0.3, 0.7), within(y, 0.58, 0.87), (z[1] - 1.15 * head,
             z[1] - 0.7 * head), tints.LAMPLIGHT),
    ]  # fmt: skip
