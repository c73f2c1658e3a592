"""Pictures, plants, bins and unnamed small things."""

from __future__ import annotations

import math

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import (
    about,
    count_of,
    frame,
    inset,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Span,
    Tint,
    ball,
    block,
    box,
    cylinder,
    lathe,
    leaf,
)


def framed_picture(size: Vector) -> list[Part]:
    """A frame, a mount and a landscape."""
    x, y, z = spans(size)
    edge = min(0.04, 0.12 * size[0], 0.12 * size[2])
    inner = inset(x, 2 * edge), inset(z, 2 * edge)
    return [
        *frame(x, y, z, edge, tints.DARK_WOOD),
        box("mount", inset(x, edge), within(y, 0, 0.55), inset(z, edge), tints.PAPER),
        box("sky", inner[0], within(y, 0.5, 0.65), within(inner[1], 0.4, 1), tints.BLUE),
        box("land", inner[0], within(y, 0.5, 0.65), within(inner[1], 0, 0.4), tints.GREEN),
    ]


def canvas_picture(size: Vector) -> list[Part]:
    """A canvas without a frame, with three fields of colour."""
    x, y, z = spans(size)
    return [
        box("canvas", x, within(y, 0, 0.8), z, tints.LINEN),
        box("field-1", within(x, 0.08, 0.55), within(y, 0.7, 1), within(z, 0.45, 0.92), tints.RED),
        box("field-2", within(x, 0.6, 0.92), within(y, 0.7, 0.98), within(z, 0.3, 0.85),
            tints.YELLOW),
        box("field-3", within(x, 0.15, 0.7), within(y, 0.7, 0.96), within(z, 0.08, 0.25),
            tints.BLUE),
    ]  # fmt: skip


def gallery_picture(size: Vector) -> list[Part]:
    """A gilt frame with bevelled corners round an oval portrait."""
    x, y, z = spans(size)
    edge = min(0.06, 0.15 * size[0], 0.15 * size[2])
    return [
        *frame(x, within(y, 0, 0.9), z, edge, tints.BRASS),
        *[box(f"corner-{k + 1}", span, within(y, 0.8, 1), rise, tints.BRASS)
          for k, (span, rise) in enumerate(
              (u, v) for u in ((x[0], x[0] + edge), (x[1] - edge, x[1]))
              for v in ((0.0, edge), (z[1] - edge, z[1])))],
        box("ground", inset(x, edge), within(y, 0, 0.5), inset(z, edge), tints.DARK_WOOD),
        cylinder("portrait", within(x, 0.3, 0.7), within(y, 0.45, 0.6), within(z, 0.25, 0.8),
                 tints.PALE_FABRIC, axis="y", sides=10),
    ]  # fmt: skip


def _pot(size: Vector, height: float, share: float, tint: Tint) -> list[Part]:
    """A tapered pot with a rim and soil, taking `share` of the width and depth."""
    x, y, _ = spans(size)
    low, high = 0.5 - share / 2, 0.5 + share / 2
    wide = within(x, low, high), within(y, low, high)
    body = within(x, low + 0.04, high - 0.04), within(y, low + 0.04, high - 0.04)
    rim = 0.82 * height
    return [
        lathe("pot", *body, (0.0, rim), tint, profile=((0.7, 0.0), (1.0, 1.0))),
        lathe("rim", *wide, (rim, height), tint, profile=((0.95, 0.0), (1.0, 1.0))),
        cylinder("soil", within(wide[0], 0.12, 0.88), within(wide[1], 0.12, 0.88),
                 (0.95 * height, 1.02 * height), tints.SOIL, sides=6),
    ]  # fmt: skip


def leafy_plant(size: Vector) -> list[Part]:
    """A pot of long leaves that rise and arch outward."""
    z = spans(size)[2]
    pot = min(0.4, 0.34 * size[2])
    blade, thick = 0.2 * min(size[0], size[1]), 0.03 * min(size[0], size[1])
    parts = _pot(size, pot, 0.6, tints.TERRACOTTA)
    for k in range(10):
        angle = k * 2.399963  # the golden angle: no two leaves overlap
        out = 0.15 + 0.34 * (1 - k / 9)
        height = pot + (z[1] - pot) * (0.45 + 0.55 * k / 9)
        tip = (out * size[0] * math.cos(angle), out * size[1] * math.sin(angle), height)
        base = (0.05 * tip[0], 0.05 * tip[1], 0.98 * pot)
        parts.append(leaf(f"leaf-{k + 1}", base, tip, blade, thick,
                          tints.GREEN if k % 2 else tints.PALE_GREEN))  # fmt: skip
    return parts


def bushy_plant(size: Vector) -> list[Part]:
    """A small tree: a pot, a stem and a crown of round clusters."""
    x, y, z = spans(size)
    pot = min(0.35, 0.28 * size[2])
    stem = 0.08 * min(size[0], size[1])
    crown = pot + 0.3 * (z[1] - pot)
    rise = (crown, z[1])
    clusters: tuple[tuple[Span, Span, Span], ...] = (
        ((0.0, 0.58), (0.02, 0.6), (0.05, 0.62)),
        ((0.42, 1.0), (0.05, 0.62), (0.12, 0.68)),
        ((0.1, 0.66), (0.42, 1.0), (0.0, 0.58)),
        ((0.44, 0.98), (0.4, 0.96), (0.08, 0.6)),
        ((0.18, 0.82), (0.18, 0.82), (0.42, 1.0)),
    )
    return [
        *_pot(size, pot, 0.55, tints.CERAMIC),
        cylinder("stem", about(0, stem), about(0, stem), (0.98 * pot, within(rise, 0, 0.5)[1]),
                 tints.DARK_WOOD, sides=6),
        *[ball(f"crown-{k + 1}", within(x, *a), within(y, *b), within(rise, *c),
               tints.GREEN if k % 2 else tints.PALE_GREEN)
          for k, (a, b, c) in enumerate(clusters)],
    ]  # fmt: skip


def cactus(size: Vector) -> list[Part]:
    """A pot on a saucer, with a column cactus and two raised arms."""
    x, y, z = spans(size)
    pot = min(0.3, 0.3 * size[2])
    rise, deep = (pot, z[1]), within(y, 0.41, 0.59)
    tip = ((0.8, 0.0), (1.0, 0.7), (0.4, 1.0))
    return [
        cylinder("saucer", x, y, (0.0, 0.08 * pot), tints.STONE, sides=10),
        *_pot(size, pot, 0.6, tints.BLUE),
        lathe("trunk", within(x, 0.37, 0.63), within(y, 0.37, 0.63), (0.98 * pot, z[1]),
              tints.GREEN, profile=((0.85, 0.0), (1.0, 0.8), (0.4, 1.0)), sides=6),
        box("branch-left", within(x, 0.18, 0.42), within(y, 0.44, 0.56), within(rise, 0.35, 0.45),
            tints.GREEN),
        lathe("arm-left", within(x, 0.08, 0.26), deep, within(rise, 0.32, 0.8), tints.GREEN,
              profile=tip, sides=6),
        box("branch-right", within(x, 0.58, 0.82), within(y, 0.44, 0.56), within(rise, 0.5, 0.6),
            tints.GREEN),
        lathe("arm-right", within(x, 0.74, 0.92), deep, within(rise, 0.47, 0.92), tints.GREEN,
              profile=tip, sides=6),
    ]  # fmt: skip


def open_bin(size: Vector) -> list[Part]:
    """A round tapered waste-paper bin, open at the top, with a rim."""
    x, y, z = spans(size)
    return [
        hollow("bin-round", "bin", within(x, 0.02, 0.98), within(y, 0.02, 0.98),
               within(z, 0, 0.97), tints.STEEL),
        hollow("shade-drum", "rim", x, y, within(z, 0.93, 1), tints.IRON),
    ]  # fmt: skip


def pedal_bin(size: Vector) -> list[Part]:
    """A cylinder with a domed lid, a base ring and a pedal in front."""
    x, y, z = spans(size)
    deep = within(y, 0, 0.9)
    return [
        cylinder("base", x, deep, within(z, 0, 0.08), tints.IRON, sides=12),
        cylinder("bin", within(x, 0.03, 0.97), within(deep, 0.03, 0.97), within(z, 0.08, 0.8),
                 tints.STEEL, sides=12),
        lathe("lid", x, deep, within(z, 0.8, 1), tints.IRON, sides=12,
              profile=((1.0, 0.0), (1.0, 0.25), (0.7, 0.8), (0.3, 1.0))),
        box("pedal", within(x, 0.38, 0.62), within(y, 0.85, 1), within(z, 0.02, 0.06),
            tints.STEEL),
    ]  # fmt: skip


def swing_bin(size: Vector) -> list[Part]:
    """A rectangular bin with a pitched swing lid."""
    x, y, z = spans(size)
    return [
        block("bin", (within(x, 0.1, 0.9), within(y, 0.1, 0.9)), (within(x, 0.03, 0.97),
              within(y, 0.03, 0.97)), within(z, 0, 0.72), tints.PLASTIC),
        box("collar", x, y, within(z, 0.72, 0.79), tints.FABRIC),
        block("lid", (within(x, 0.02, 0.98), within(y, 0.02, 0.98)), (within(x, 0.06, 0.94),
              within(y, 0.4, 0.6)), within(z, 0.79, 1), tints.FABRIC),
        box("flap", within(x, 0.2, 0.8), within(y, 0.86, 0.98), within(z, 0.8, 0.84), tints.IRON),
    ]  # fmt: skip


def open_square_bin(size: Vector) -> list[Part]:
    """A rectangular bin, open at the top, with a bag hanging over its rim."""
    x, y, z = spans(size)
    return [
        hollow("bin-square", "bin", within(x, 0.02, 0.98), within(y, 0.02, 0.98),
               within(z, 0, 0.98), tints.FABRIC),
        *_rim(x, y, within(z, 0.86, 1), 0.1 * min(size[0], size[1])),
    ]  # fmt: skip


def _rim(x: Span, y: Span, z: Span, thickness: float) -> list[Part]:
    """A level rectangular rim of four boards."""
    side = inset(y, thickness)
    return [
        box("rim-front", x, (y[1] - thickness, y[1]), z, tints.LINEN),
        box("rim-rear", x, (y[0], y[0] + thickness), z, tints.LINEN),
        box("rim-left", (x[0], x[0] + thickness), side, z, tints.LINEN),
        box("rim-right", (x[1] - thickness, x[1]), side, z, tints.LINEN),
    ]


def lidded_box(size: Vector) -> list[Part]:
    """A box with an overlapping lid and a ribbon; a remote control if flat."""
    if _is_flat(size):
        return _handset(size)
    x, y, z = spans(size)
    return [
        box("box", within(x, 0.03, 0.97), within(y, 0.03, 0.97), within(z, 0, 0.75), tints.ORANGE),
        box("lid", x, within(y, 0.005, 0.995), within(z, 0.7, 0.96), tints.RED),
        box(
            "ribbon",
            within(x, 0.44, 0.56),
            within(y, -0.0, 1.0),
            within(z, 0.68, 0.98),
            tints.LINEN,
        ),
        box("bow", within(x, 0.3, 0.7), within(y, 0.42, 0.58), within(z, 0.94, 1), tints.LINEN),
    ]


def jar(size: Vector) -> list[Part]:
    """A round jar with a shoulder, a label and a knobbed lid."""
    x, y, z = spans(size)
    return [
        lathe("jar", x, y, within(z, 0, 0.78), tints.CERAMIC,
              profile=((0.8, 0.0), (1.0, 0.15), (1.0, 0.8), (0.75, 1.0))),
        lathe("lid", within(x, 0.08, 0.92), within(y, 0.08, 0.92), within(z, 0.78, 0.9),
              tints.BLUE, profile=((1.0, 0.0), (0.7, 1.0))),
        ball("knob", within(x, 0.38, 0.62), within(y, 0.38, 0.62), within(z, 0.86, 1), tints.BLUE),
    ]  # fmt: skip


def _is_flat(size: Vector) -> bool:
    return size[2] < 0.35 * min(size[0], size[1])


def remote_control(size: Vector) -> list[Part]:
    """A flat handset with rows of buttons; a bell-shaped figurine if not flat."""
    return _handset(size) if _is_flat(size) else _figurine(size)


def _figurine(size: Vector) -> list[Part]:
    x, y, z = spans(size)
    return [
        lathe("skirt", x, y, within(z, 0, 0.62), tints.BLUE,
              profile=((1.0, 0.0), (0.85, 0.25), (0.35, 1.0))),
        ball("head", within(x, 0.28, 0.72), within(y, 0.28, 0.72), within(z, 0.56, 0.92),
             tints.PALE_FABRIC),
        lathe("hat", within(x, 0.24, 0.76), within(y, 0.24, 0.76), within(z, 0.82, 1),
              tints.RED, profile=((1.0, 0.0), (0.2, 1.0)), sides=6),
    ]  # fmt: skip


def _handset(size: Vector) -> list[Part]:
    """Rows of buttons along the longer side."""
    x, y, z = spans(size)
    long_x = size[0] > size[1]
    count = count_of(max(size[0], size[1]) / min(size[0], size[1]), 0.6, 5, least=2)
    parts = [box("case", x, y, within(z, 0, 0.8), tints.RUBBER)]
    for k in range(count):
        along = (0.15 + 0.6 * k / count, 0.15 + 0.6 * (k + 0.6) / count)
        for j, across in enumerate(((0.18, 0.45), (0.55, 0.82))):
            u, v = (along, across) if long_x else (across, along)
            parts.append(box(f"button-{k + 1}-{j + 1}", within(x, *u), within(y, *v),
                             within(z, 0.75, 0.98), tints.PLASTIC))  # fmt: skip
    power = ((0.82, 0.92), (0.35, 0.65)) if long_x else ((0.35, 0.65), (0.82, 0.92))
    parts.append(box("power", within(x, *power[0]), within(y, *power[1]), within(z, 0.75, 1),
                     tints.RED))  # fmt: skip
    return parts


def basket(size: Vector) -> list[Part]:
    """A basket with a handle over it."""
    x, y, z = spans(size)
    return [
        hollow("bowl", "basket", x, y, within(z, 0, 0.6), tints.LIGHT_WOOD),
        hollow("arch", "handle", within(x, 0.44, 0.56), within(y, 0.04, 0.96), within(z, 0.5, 1),
               tints.WOOD),
    ]  # fmt: skip
