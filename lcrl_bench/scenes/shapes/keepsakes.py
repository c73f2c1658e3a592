"""Clocks, books and candles."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
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
    cylinder,
    lathe,
)


def _hands(x: Span, y: Span, z: Span) -> list[Part]:
    """Ten past ten on a dial in the x-z plane, `y` thick."""
    center, middle = sum(x) / 2, sum(z) / 2
    half, rise = (x[1] - x[0]) / 2, (z[1] - z[0]) / 2
    thick = 0.1 * min(half, rise)
    hour = (about(center - 0.38 * half, thick), y)
    minute = (about(center + 0.5 * half, thick), y)
    root = (about(center, 1.5 * thick), y)
    return [
        block("hour-hand", root, hour, (middle, middle + 0.38 * rise), tints.IRON),
        block("minute-hand", root, minute, (middle - 0.01 * rise, middle + 0.6 * rise),
              tints.IRON),
    ]  # fmt: skip


def alarm_clock(size: Vector) -> list[Part]:
    """A round face on two feet, with two bells and a hammer on top."""
    x, y, z = spans(size)
    body = within(x, 0.04, 0.96), within(z, 0.1, 0.8)
    dial = within(body[0], 0.1, 0.9), within(body[1], 0.1, 0.9)
    return [
        cylinder("case", body[0], within(y, 0.1, 0.8), body[1], tints.RED, axis="y", sides=12),
        cylinder("face", dial[0], within(y, 0.75, 0.9), dial[1], tints.PAPER, axis="y", sides=10),
        *_hands(dial[0], within(y, 0.88, 1), dial[1]),
        block("foot-left", (within(x, 0.1, 0.2), within(y, 0.2, 0.7)), (within(x, 0.2, 0.34),
              within(y, 0.2, 0.7)), within(z, 0, 0.25), tints.IRON),
        block("foot-right", (within(x, 0.8, 0.9), within(y, 0.2, 0.7)), (within(x, 0.66, 0.8),
              within(y, 0.2, 0.7)), within(z, 0, 0.25), tints.IRON),
        lathe("bell-left", within(x, 0, 0.42), within(y, 0, 0.9), within(z, 0.74, 0.95),
              tints.BRASS, profile=((1.0, 0.0), (0.8, 0.5), (0.3, 1.0)), sides=6),
        lathe("bell-right", within(x, 0.58, 1), within(y, 0, 0.9), within(z, 0.74, 0.95),
              tints.BRASS, profile=((1.0, 0.0), (0.8, 0.5), (0.3, 1.0)), sides=6),
        box("hammer", within(x, 0.46, 0.54), within(y, 0.35, 0.55), within(z, 0.76, 1),
            tints.IRON),
    ]  # fmt: skip


def mantel_clock(size: Vector) -> list[Part]:
    """A wooden case with an arched top on a plinth, and a round face."""
    x, y, z = spans(size)
    case = within(x, 0.08, 0.92), within(y, 0.08, 0.85)
    dial = within(x, 0.2, 0.8), within(z, 0.3, 0.82)
    return [
        box("plinth", x, within(y, 0, 0.96), within(z, 0, 0.12), tints.DARK_WOOD),
        box("case", *case, within(z, 0.12, 0.7), tints.WOOD),
        block("arch", case, (within(x, 0.32, 0.68), case[1]), within(z, 0.7, 1), tints.WOOD),
        cylinder("face", dial[0], within(y, 0.83, 0.92), dial[1], tints.PAPER, axis="y", sides=10),
        *_hands(dial[0], within(y, 0.9, 1), dial[1]),
    ]


def ring_clock(size: Vector) -> list[Part]:
    """A round dial in a steel rim on a small stand."""
    x, y, z = spans(size)
    rim = within(z, 0.1, 1)
    dial = within(x, 0.1, 0.9), within(rim, 0.1, 0.9)
    return [
        cylinder("rim", x, within(y, 0.2, 0.75), rim, tints.STEEL, axis="y", sides=12),
        cylinder("face", dial[0], within(y, 0.7, 0.84), dial[1], tints.CERAMIC, axis="y", sides=12),
        *_hands(dial[0], within(y, 0.82, 0.95), dial[1]),
        block(
            "stand",
            (within(x, 0.2, 0.8), y),
            (within(x, 0.35, 0.65), within(y, 0.25, 0.7)),
            within(z, 0, 0.2),
            tints.IRON,
        ),
    ]


def _volume(x: Span, y: Span, z: Span, cover: Tint, name: str = "") -> list[Part]:
    """A closed book lying with its spine to the left."""
    board = 0.14 * (z[1] - z[0])
    return [
        box(f"{name}front", x, y, (z[1] - board, z[1]), cover),
        box(f"{name}rear", x, y, (z[0], z[0] + board), cover),
        box(f"{name}spine", within(x, 0, 0.06), inset(y, 0.001 * (y[1] - y[0])),
            inset(z, board), cover),
        box(f"{name}pages", within(x, 0.06, 0.96), within(y, 0.03, 0.97), inset(z, board),
            tints.PAPER),
    ]  # fmt: skip


def closed_book(size: Vector) -> list[Part]:
    """A closed book: covers, spine and pages; standing if its box is upright."""
    x, y, z = spans(size)
    if size[2] > 2.5 * min(size[0], size[1]):
        return _standing_book(size)
    return _volume(x, y, z, tints.RED)


def _standing_book(size: Vector) -> list[Part]:
    x, y, z = spans(size)
    if size[0] > size[1]:
        # Its cover faces the front.
        return [
            box("front", x, within(y, 0.86, 1), z, tints.RED),
            box("rear", x, within(y, 0, 0.14), z, tints.RED),
            box("spine", within(x, 0, 0.06), within(y, 0.14, 0.86), within(z, 0.001, 0.999),
                tints.RED),
            box("pages", within(x, 0.06, 0.96), within(y, 0.14, 0.86), within(z, 0.03, 0.97),
                tints.PAPER),
        ]  # fmt: skip
    # Its spine faces the front, as on a shelf.
    return [
        box("left", within(x, 0, 0.14), y, z, tints.RED),
        box("right", within(x, 0.86, 1), y, z, tints.RED),
        box("spine", within(x, 0.14, 0.86), within(y, 0.94, 1), within(z, 0.001, 0.999), tints.RED),
        box(
            "pages",
            within(x, 0.14, 0.86),
            within(y, 0.04, 0.94),
            within(z, 0.03, 0.97),
            tints.PAPER,
        ),
    ]


def book_stack(size: Vector) -> list[Part]:
    """Two closed books, the smaller askew on the larger; standing if their box is upright."""
    x, y, z = spans(size)
    if size[2] > 2.5 * min(size[0], size[1]):
        return _standing_book(size)
    return [
        *_volume(x, y, within(z, 0, 0.52), tints.BLUE, "lower-"),
        *_volume(within(x, 0.06, 0.9), within(y, 0.1, 0.96), within(z, 0.52, 1), tints.GREEN,
                 "upper-"),
    ]  # fmt: skip


def open_book(size: Vector) -> list[Part]:
    """A book lying open, its pages arched on both sides; standing if its box is upright."""
    x, y, z = spans(size)
    if size[2] > 2.5 * min(size[0], size[1]):
        return _standing_book(size)
    deep = within(y, 0.03, 0.97)
    return [
        box("cover", x, y, within(z, 0, 0.22), tints.DARK_WOOD),
        block("left-rise", (within(x, 0.03, 0.3), deep), (within(x, 0.16, 0.3), deep),
              within(z, 0.22, 1), tints.PAPER),
        block("left-fall", (within(x, 0.3, 0.5), deep), (within(x, 0.3, 0.42), deep),
              within(z, 0.22, 1), tints.PAPER),
        block("right-fall", (within(x, 0.5, 0.7), deep), (within(x, 0.58, 0.7), deep),
              within(z, 0.22, 1), tints.PAPER),
        block("right-rise", (within(x, 0.7, 0.97), deep), (within(x, 0.7, 0.84), deep),
              within(z, 0.22, 1), tints.PAPER),
    ]  # fmt: skip


def _flame(x: Span, y: Span, z: Span, share: float) -> list[Part]:
    """A wick and a flame, taking `share` of the width and depth."""
    low, high = 0.5 - share / 2, 0.5 + share / 2
    return [
        box("wick", within(x, 0.5 - share / 8, 0.5 + share / 8),
            within(y, 0.5 - share / 8, 0.5 + share / 8), within(z, 0, 0.4), tints.IRON),
        lathe("flame", within(x, low, high), within(y, low, high), within(z, 0.3, 1), tints.FLAME,
              profile=((0.4, 0.0), (1.0, 0.35), (0.12, 1.0)), sides=6),
    ]  # fmt: skip


def pillar_candle(size: Vector) -> list[Part]:
    """A thick candle with a flame, on a dish."""
    x, y, z = spans(size)
    return [
        lathe("dish", x, y, within(z, 0, 0.09), tints.BRASS, profile=((0.7, 0.0), (1.0, 1.0)),
              sides=10),
        cylinder("candle", within(x, 0.16, 0.84), within(y, 0.16, 0.84), within(z, 0.09, 0.76),
                 tints.WAX, sides=10),
        *_flame(x, y, within(z, 0.75, 1), 0.26),
    ]  # fmt: skip


def tapered_candle(size: Vector) -> list[Part]:
    """A slender candle in a candlestick with a broad foot."""
    x, y, z = spans(size)
    return [
        lathe("foot", x, y, within(z, 0, 0.1), tints.BRASS, profile=((1.0, 0.0), (0.9, 0.5),
              (0.3, 1.0))),
        cylinder("stem", within(x, 0.42, 0.58), within(y, 0.42, 0.58), within(z, 0.1, 0.3),
                 tints.BRASS, sides=6),
        lathe("socket", within(x, 0.22, 0.78), within(y, 0.22, 0.78), within(z, 0.3, 0.4),
              tints.BRASS, profile=((0.4, 0.0), (1.0, 1.0)), sides=8),
        lathe("candle", within(x, 0.34, 0.66), within(y, 0.34, 0.66), within(z, 0.4, 0.84),
              tints.WAX, profile=((1.0, 0.0), (0.75, 1.0)), sides=8),
        *_flame(x, y, within(z, 0.83, 1), 0.22),
    ]  # fmt: skip


def jar_candle(size: Vector) -> list[Part]:
    """A candle in a glass, its flame rising above the rim."""
    x, y, z = spans(size)
    return [
        hollow("tumbler", "glass", x, y, within(z, 0, 0.72), tints.GLASS),
        cylinder("candle", within(x, 0.18, 0.82), within(y, 0.18, 0.82), within(z, 0.08, 0.45),
                 tints.WAX, sides=8),
        *_flame(x, y, within(z, 0.44, 1), 0.3),
    ]  # fmt: skip
