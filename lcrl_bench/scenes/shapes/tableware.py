"""Cups, plates, bowls of fruit, pans, kettles, bottles and vases."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import about, inset, spans, within
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Tint,
    ball,
    block,
    box,
    cylinder,
    lathe,
    leaf,
)


def mug(size: Vector) -> list[Part]:
    """A straight mug with a handle on its right."""
    x, y, z = spans(size)
    return [
        hollow("mug", "mug", within(x, 0, 0.78), y, z, tints.RED),
        hollow("mug-handle", "handle", within(x, 0.74, 1), within(y, 0.42, 0.58),
               within(z, 0.18, 0.84), tints.RED),
        cylinder("coffee", within(x, 0.08, 0.7), within(y, 0.1, 0.9), within(z, 0.5, 0.78),
                 tints.DARK_WOOD, sides=6),
    ]  # fmt: skip


def tea_cup(size: Vector) -> list[Part]:
    """A flared cup with a handle, on a saucer."""
    x, y, z = spans(size)
    return [
        lathe("saucer", x, y, within(z, 0, 0.14), tints.CERAMIC,
              profile=((0.5, 0.0), (1.0, 0.7), (1.0, 1.0)), sides=10),
        hollow("tea-cup", "cup", within(x, 0.16, 0.76), within(y, 0.18, 0.82),
               within(z, 0.12, 1), tints.CERAMIC),
        hollow("mug-handle", "handle", within(x, 0.7, 0.92), within(y, 0.45, 0.55),
               within(z, 0.4, 0.9), tints.CERAMIC),
    ]  # fmt: skip


def tumbler(size: Vector) -> list[Part]:
    """A glass with water in it."""
    x, y, z = spans(size)
    return [
        hollow("tumbler", "glass", x, y, z, tints.GLASS),
        cylinder("water", within(x, 0.18, 0.82), within(y, 0.18, 0.82), within(z, 0.12, 0.62),
                 tints.BLUE, sides=6),
    ]  # fmt: skip


def _fruit(size: Vector, low: float) -> list[Part]:
    x, y, z = spans(size)
    heap = (
        ((0.14, 0.5), (0.2, 0.56), (0.0, 0.62), tints.RED),
        ((0.48, 0.84), (0.16, 0.52), (0.0, 0.6), tints.ORANGE),
        ((0.32, 0.68), (0.46, 0.82), (0.0, 0.64), tints.YELLOW),
        ((0.32, 0.66), (0.3, 0.64), (0.38, 1.0), tints.PALE_GREEN),
    )
    rise = (low * size[2], z[1])
    return [
        ball(f"fruit-{k + 1}", within(x, *a), within(y, *b), within(rise, *c), tint)
        for k, (a, b, c, tint) in enumerate(heap)
    ]


def fruit_bowl(size: Vector) -> list[Part]:
    """A bowl heaped with fruit."""
    x, y, z = spans(size)
    return [hollow("bowl", "bowl", x, y, within(z, 0, 0.62), tints.CERAMIC), *_fruit(size, 0.25)]


def footed_fruit_bowl(size: Vector) -> list[Part]:
    """A dish of fruit on a foot."""
    x, y, z = spans(size)
    return [
        lathe("foot", within(x, 0.25, 0.75), within(y, 0.25, 0.75), within(z, 0, 0.3), tints.GLASS,
              profile=((1.0, 0.0), (0.9, 0.25), (0.3, 1.0))),
        hollow("bowl", "bowl", x, y, within(z, 0.26, 0.66), tints.GLASS),
        *_fruit(size, 0.42),
    ]  # fmt: skip


def banana_bowl(size: Vector) -> list[Part]:
    """A wooden bowl with bananas laid over round fruit."""
    x, y, z = spans(size)
    thick = 0.16 * min(size[0], size[1])
    top = 0.5 * size[2]
    parts = [
        hollow("bowl", "bowl", x, y, within(z, 0, 0.66), tints.WOOD),
        ball("fruit-1", within(x, 0.14, 0.52), within(y, 0.12, 0.5), within(z, 0.25, 0.82),
             tints.RED),
        ball("fruit-2", within(x, 0.5, 0.88), within(y, 0.14, 0.52), within(z, 0.25, 0.8),
             tints.PALE_GREEN),
    ]  # fmt: skip
    for k, share in enumerate((-0.06, 0.1, 0.26)):
        middle = ((share + 0.04) * size[1], 0.86 * size[2])
        for j, end in enumerate((-0.34 * size[0], 0.34 * size[0])):
            tip = (end, share * size[1], top + 0.1 * size[2])
            parts.append(leaf(f"banana-{k + 1}-{j + 1}", tip, (-0.12 * end, *middle), thick, thick,
                              tints.YELLOW))  # fmt: skip
    parts.append(box("stalk", about(0, 0.05 * size[0]), about(0.12 * size[1], 0.3 * size[1]),
                     within(z, 0.84, 1), tints.DARK_WOOD))  # fmt: skip
    return parts


def _lengthwise(size: Vector) -> bool:
    """Whether a pan's handle lies along x: along the longer side."""
    return size[0] > size[1]


def frying_pan(size: Vector) -> list[Part]:
    """A flat round pan with one long handle along its longer side."""
    x, y, z = spans(size)
    long_x = _lengthwise(size)
    across, along = (size[1], size[0]) if long_x else (size[0], size[1])
    # The dish is about as long as it is wide; the handle takes the rest.
    share = min(0.7, max(0.55, across / along))
    thick = min(0.03, 0.12 * across)
    level = within(z, 0.55, 1)
    dish, rest = (0.0, share), (share - 0.04, 0.97)
    grip = about(0, thick), within(y if not long_x else x, *rest)
    grips = (grip[1], grip[0]) if long_x else grip
    plate = (within(x, *dish), y) if long_x else (x, within(y, *dish))
    tip = within(x, 0.8, 1) if long_x else about(0, 1.6 * thick)
    end = about(0, 1.6 * thick) if long_x else within(y, 0.8, 1)
    return [
        hollow("pan", "pan", *plate, within(z, 0, 0.9), tints.IRON),
        box("handle", *grips, within(level, 0.1, 0.7), tints.IRON),
        box("grip", tip, end, level, tints.DARK_WOOD),
    ]


def saucepan(size: Vector) -> list[Part]:
    """A pot with a lid, a knob and one handle along its longer side."""
    x, y, z = spans(size)
    long_x = _lengthwise(size)
    across = size[1] if long_x else size[0]
    thick = min(0.03, 0.14 * across)
    dish, rest = (0.0, 0.64), (0.6, 1.0)
    body = (within(x, *dish), y) if long_x else (x, within(y, *dish))
    grips = (within(x, *rest), about(0, thick)) if long_x else (about(0, thick), within(y, *rest))
    lid = [within(span, 0.02, 0.98) for span in body]
    knob = [within(span, 0.4, 0.6) for span in body]
    return [
        hollow("pan", "pot", *body, within(z, 0, 0.72), tints.STEEL),
        lathe("lid", lid[0], lid[1], within(z, 0.7, 0.86), tints.STEEL,
              profile=((1.0, 0.0), (0.35, 1.0)), sides=10),
        cylinder("knob", knob[0], knob[1], within(z, 0.84, 1), tints.RUBBER, sides=6),
        box("handle", *grips, within(z, 0.5, 0.64), tints.RUBBER),
    ]  # fmt: skip


def wok(size: Vector) -> list[Part]:
    """A deep curved pan with a handle along its longer side and a loop opposite."""
    x, y, z = spans(size)
    long_x = _lengthwise(size)
    across = size[1] if long_x else size[0]
    thick = min(0.03, 0.12 * across)
    dish, rest, loop = (0.07, 0.68), (0.64, 1.0), (0.0, 0.1)
    body = (within(x, *dish), y) if long_x else (x, within(y, *dish))
    grips = (within(x, *rest), about(0, thick)) if long_x else (about(0, thick), within(y, *rest))
    side = about(0, 4 * thick)
    ear = (within(x, *loop), side) if long_x else (side, within(y, *loop))
    return [
        hollow("bowl", "wok", *body, within(z, 0, 0.96), tints.IRON),
        box("handle", *grips, within(z, 0.72, 1), tints.WOOD),
        box("loop", *ear, within(z, 0.78, 0.94), tints.IRON),
    ]


def stove_kettle(size: Vector) -> list[Part]:
    """A round-bellied kettle with a spout in front, a lid and an arched handle."""
    x, y, z = spans(size)
    deep = within(y, 0, 0.8)
    return [
        lathe("body", x, deep, within(z, 0, 0.6), tints.STEEL, sides=10,
              profile=((0.85, 0.0), (1.0, 0.3), (0.85, 0.75), (0.45, 1.0))),
        cylinder("knob", within(x, 0.43, 0.57), within(deep, 0.43, 0.57), within(z, 0.58, 0.7),
                 tints.RUBBER, sides=6),
        block("spout", (within(x, 0.4, 0.6), within(y, 0.62, 0.8)), (within(x, 0.45, 0.55),
              within(y, 0.9, 1)), within(z, 0.25, 0.64), tints.STEEL),
        hollow("arch", "handle", within(x, 0.44, 0.56), within(deep, 0.06, 0.94),
               within(z, 0.42, 1), tints.RUBBER),
    ]  # fmt: skip


def jug_kettle(size: Vector) -> list[Part]:
    """An electric kettle: a base, a tapered jug with a lip, a lid and a handle behind."""
    x, y, z = spans(size)
    jug = within(y, 0.22, 0.94)
    return [
        cylinder("base", within(x, 0.04, 0.96), within(y, 0.2, 0.96), within(z, 0, 0.1),
                 tints.RUBBER, sides=10),
        lathe("jug", x, jug, within(z, 0.1, 0.86), tints.PAINT, sides=10,
              profile=((1.0, 0.0), (0.7, 1.0))),
        lathe("lid", within(x, 0.16, 0.84), within(jug, 0.16, 0.84), within(z, 0.86, 0.96),
              tints.STEEL, profile=((1.0, 0.0), (0.8, 1.0))),
        cylinder("knob", within(x, 0.44, 0.56), within(jug, 0.44, 0.56), within(z, 0.95, 1),
                 tints.RUBBER, sides=6),
        block("lip", (within(x, 0.44, 0.56), within(y, 0.8, 0.88)), (within(x, 0.36, 0.64),
              within(y, 0.76, 1)), within(z, 0.62, 0.86), tints.PAINT),
        box("handle", within(x, 0.43, 0.57), within(y, 0, 0.09), within(z, 0.2, 0.86),
            tints.RUBBER),
        box("bracket-upper", within(x, 0.44, 0.56), within(y, 0.09, 0.4), within(z, 0.74, 0.84),
            tints.RUBBER),
        box("bracket-lower", within(x, 0.44, 0.56), within(y, 0.09, 0.28), within(z, 0.22, 0.31),
            tints.RUBBER),
    ]  # fmt: skip


def _bottle(size: Vector, tint: Tint, shoulder: float, neck: float, body: float) -> list[Part]:
    """`shoulder` and `body` are shares of the height, `neck` of the width."""
    x, y, z = spans(size)
    slim = (1 - neck) / 2
    return [
        lathe("body", x, y, within(z, 0, shoulder), tint,
              profile=((0.92, 0.0), (1.0, 0.05), (1.0, body / shoulder), (neck, 1.0))),
        cylinder("neck", within(x, slim, 1 - slim), within(y, slim, 1 - slim),
                 within(z, shoulder, 0.92), tint, sides=8),
        cylinder("cap", within(x, slim - 0.02, 1.02 - slim), within(y, slim - 0.02, 1.02 - slim),
                 within(z, 0.9, 1), tints.DARK_WOOD, sides=8),
    ]  # fmt: skip


def wine_bottle(size: Vector) -> list[Part]:
    """A bottle with square shoulders and a long neck."""
    return _bottle(size, tints.GREEN, 0.66, 0.36, 0.5)


def water_bottle(size: Vector) -> list[Part]:
    """A bottle with a sloping shoulder, a short neck and a label."""
    x, y, z = spans(size)
    label = cylinder("label", x, y, within(z, 0.26, 0.5), tints.BLUE, sides=8)
    return [
        *_bottle((0.97 * size[0], 0.97 * size[1], size[2]), tints.GLASS, 0.85, 0.42, 0.6),
        label,
    ]


def squat_bottle(size: Vector) -> list[Part]:
    """A squared flask with a stopper."""
    x, y, z = spans(size)
    return [
        box("body", x, y, within(z, 0, 0.55), tints.BRASS),
        block("shoulder", (x, y), (within(x, 0.32, 0.68), within(y, 0.32, 0.68)),
              within(z, 0.55, 0.68), tints.BRASS),
        cylinder("neck", within(x, 0.34, 0.66), within(y, 0.34, 0.66), within(z, 0.68, 0.84),
                 tints.BRASS),
        lathe("stopper", within(x, 0.27, 0.73), within(y, 0.27, 0.73), within(z, 0.82, 1),
              tints.GLASS, profile=((0.6, 0.0), (1.0, 0.5), (0.6, 1.0))),
    ]  # fmt: skip


def round_plate(size: Vector) -> list[Part]:
    """A plate with a raised rim and a well."""
    x, y, z = spans(size)
    return [hollow("dish", "plate", x, y, z, tints.CERAMIC)]


def banded_plate(size: Vector) -> list[Part]:
    """A plate with a coloured disc in its well."""
    x, y, z = spans(size)
    return [
        hollow("dish", "plate", x, y, z, tints.CERAMIC),
        cylinder("disc", within(x, 0.24, 0.76), within(y, 0.24, 0.76), within(z, 0.3, 0.45),
                 tints.BLUE, sides=12),
    ]  # fmt: skip


def square_plate(size: Vector) -> list[Part]:
    """A square plate with a raised edge."""
    x, y, z = spans(size)
    return [hollow("basin-square", "plate", x, y, z, tints.STONE)]


def _flowers(size: Vector, low: float) -> list[Part]:
    """Three stems with blossoms, rising from a vase at fraction `low` of the height."""
    x, y, z = spans(size)
    stem = 0.05 * min(size[0], size[1])
    parts = []
    heads = ((0.3, 0.36, 0.86, tints.RED), (0.7, 0.42, 0.94, tints.YELLOW),
             (0.5, 0.68, 1.0, tints.ORANGE))  # fmt: skip
    for k, (u, v, top, tint) in enumerate(heads):
        center = x[0] + u * size[0], y[0] + v * size[1]
        foot = 0.2 * center[0], 0.2 * center[1]
        parts.append(block(f"stem-{k + 1}", (about(foot[0], stem), about(foot[1], stem)),
                           (about(center[0], stem), about(center[1], stem)),
                           (low * size[2], (top - 0.08) * size[2]), tints.GREEN))  # fmt: skip
        parts.append(ball(f"blossom-{k + 1}", about(center[0], 0.3 * size[0]),
                          about(center[1], 0.3 * size[1]), within(z, top - 0.18, top),
                          tint))  # fmt: skip
    return parts


def amphora_vase(size: Vector) -> list[Part]:
    """A bellied vase with a narrow neck."""
    x, y, z = spans(size)
    return [hollow("vase-amphora", "vase", x, y, z, tints.TERRACOTTA)]


def flower_vase(size: Vector) -> list[Part]:
    """A flared vase with flowers, or without if too low for stems."""
    x, y, z = spans(size)
    if size[2] < 0.9 * min(size[0], size[1]):
        return [hollow("vase-flute", "vase", x, y, z, tints.GLASS)]
    return [
        hollow("vase-flute", "vase", x, y, within(z, 0, 0.62), tints.BLUE),
        *_flowers(size, 0.4),
    ]


def globe_vase(size: Vector) -> list[Part]:
    """A round vase with a small lip and a painted band."""
    x, y, z = spans(size)
    return [
        hollow("vase-globe", "vase", inset(x, 0.01 * size[0]), inset(y, 0.01 * size[1]), z,
               tints.CERAMIC),
        cylinder("band", x, y, within(z, 0.4, 0.52), tints.BLUE, sides=8),
    ]  # fmt: skip
