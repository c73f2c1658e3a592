"""Televisions, laptops and phones."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import (
    about,
    inset,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Span,
    Tint,
    block,
    box,
)


def _screen(size: Vector, y: Span, bottom: float) -> list[Part]:
    """A flat panel whose picture faces the front."""
    x, _, z = spans(size)
    rise = (bottom, z[1])
    edge = min(0.015, 0.05 * size[0], 0.05 * size[2])
    return [
        box("case", x, within(y, 0, 0.8), rise, tints.RUBBER),
        box("screen", inset(x, edge), within(y, 0.7, 1), inset(rise, edge), tints.SCREEN),
    ]


def footed_television(size: Vector) -> list[Part]:
    """A screen on two feet; wall-mounted if there is no depth for feet."""
    if size[1] < 0.12 * size[2]:
        return wall_television(size)
    x, y, _ = spans(size)
    rise, thick = 0.08 * size[2], min(0.04, 0.1 * size[0])
    panel = about(0, min(0.06, 0.4 * size[1]))
    feet = [x[0] + 0.18 * size[0], x[1] - 0.18 * size[0]]
    return [
        *_screen(size, panel, rise),
        *[block(f"foot-{k + 1}", (about(center, thick), y), (about(center, 0.6 * thick),
                within(y, 0.4, 0.6)), (0.0, 1.4 * rise), tints.IRON)
          for k, center in enumerate(feet)],
    ]  # fmt: skip


def pedestal_television(size: Vector) -> list[Part]:
    """A screen on a neck and a broad foot; wall-mounted if there is no depth for a foot."""
    if size[1] < 0.12 * size[2]:
        return wall_television(size)
    x, y, _ = spans(size)
    rise, plate = 0.14 * size[2], 0.03 * size[2]
    panel = about(0, min(0.06, 0.4 * size[1]))
    return [
        *_screen(size, panel, rise),
        box("foot", within(x, 0.3, 0.7), y, (0.0, plate), tints.IRON),
        box("neck", within(x, 0.44, 0.56), within(y, 0.42, 0.58), (plate, 1.5 * rise), tints.IRON),
    ]


def wall_television(size: Vector) -> list[Part]:
    """A screen with a wall bracket behind it."""
    x, y, z = spans(size)
    return [
        *_screen(size, within(y, 0.45, 1), 0.0),
        box(
            "bracket", within(x, 0.35, 0.65), within(y, 0, 0.46), within(z, 0.35, 0.65), tints.IRON
        ),
    ]


def _open_laptop(size: Vector, case: Tint, lean: float) -> list[Part]:
    """`lean`: how far the screen's top is behind its hinge, as a share of the depth."""
    x, y, z = spans(size)
    board, lid = min(0.02, 0.3 * size[2]), min(0.012, 0.08 * size[1])
    hinge = y[0] + lean * size[1]
    foot, head = (hinge, hinge + lid), (y[0], y[0] + lid)
    ahead = 0.35 * lid

    def slope(low: float, high: float) -> tuple[Span, Span, Span]:
        """The y spans in front of the lid at two fractions of its height, and the z span."""
        rise = (board, z[1])
        ends = [hinge + (y[0] - hinge) * share + lid for share in (low, high)]
        front, rear = [(end - 0.5 * lid, end + ahead) for end in ends]
        return front, rear, within(rise, low, high)

    low, high, rise = slope(0.08, 0.94)
    narrow = within(x, 0.04, 0.96)
    return [
        box("base", x, (hinge - 0.2 * lid, y[1]), (0.0, 0.9 * board), case),
        box("keys", within(x, 0.08, 0.92), within((hinge + 2 * lid, y[1]), 0.05, 0.55),
            (0.85 * board, board), tints.RUBBER),
        box("touchpad", within(x, 0.36, 0.64), within((hinge + 2 * lid, y[1]), 0.64, 0.94),
            (0.85 * board, 0.97 * board), tints.STONE),
        block("lid", (x, foot), (x, head), (0.9 * board, z[1]), case),
        block("screen", (narrow, low), (narrow, high), rise, tints.SCREEN),
    ]  # fmt: skip


def silver_laptop(size: Vector) -> list[Part]:
    """An open laptop: keys, touchpad and a lit screen leaning back."""
    return _open_laptop(size, tints.STEEL, 0.22)


def black_laptop(size: Vector) -> list[Part]:
    """An open laptop with a steeper screen and a camera bar."""
    parts = _open_laptop(size, tints.IRON, 0.1)
    x, y, z = spans(size)
    lid = min(0.012, 0.08 * size[1])
    camera = box("camera", within(x, 0.47, 0.53), (y[0] + 0.5 * lid, y[0] + 1.6 * lid),
                 within(z, 0.955, 0.99), tints.GLASS)  # fmt: skip
    return [*parts, camera]


def smartphone(size: Vector) -> list[Part]:
    """A slab with a screen, a camera hump above it and a side button."""
    x, y, z = spans(size)
    slab = within(x, 0, 0.98)
    return [
        box("slab", slab, y, within(z, 0, 0.82), tints.IRON),
        box("screen", within(slab, 0.05, 0.95), within(y, 0.04, 0.96), within(z, 0.7, 0.94),
            tints.SCREEN),
        box("ear-piece", within(slab, 0.4, 0.6), within(y, 0.9, 0.93), within(z, 0.9, 1),
            tints.STEEL),
        box("button", within(x, 0.97, 1), within(y, 0.6, 0.72), within(z, 0.3, 0.6), tints.STEEL),
    ]  # fmt: skip


def button_phone(size: Vector) -> list[Part]:
    """A phone with a small screen above rows of keys."""
    x, y, z = spans(size)
    keys = [
        box(f"keys-{k + 1}", within(x, 0.12, 0.88), within(y, 0.08 + 0.11 * k, 0.16 + 0.11 * k),
            within(z, 0.7, 1), tints.PLASTIC)
        for k in range(4)
    ]  # fmt: skip
    return [
        box("case", x, y, within(z, 0, 0.8), tints.BLUE),
        box("screen", within(x, 0.1, 0.9), within(y, 0.56, 0.92), within(z, 0.7, 0.94),
            tints.SCREEN),
        *keys,
    ]  # fmt: skip
