"""Dining, coffee and side tables, and desks."""

from __future__ import annotations

import math

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import (
    about,
    count_of,
    fronts,
    handles,
    inset,
    knobs,
    legs,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import Part, Span, bar, block, box, cylinder, lathe


def _leg(size: Vector, most: float) -> float:
    return min(most, 0.1 * size[0], 0.1 * size[1])


def four_leg_table(size: Vector) -> list[Part]:
    """A top and an apron on four legs."""
    x, y, z = spans(size)
    board, thick = min(0.035, 0.15 * size[2]), _leg(size, 0.075)
    apron = min(0.09, 0.15 * size[2])
    under = z[1] - board
    return [
        box("top", x, y, (under, z[1]), tints.WOOD),
        box("apron", inset(x, 0.7 * thick), inset(y, 0.7 * thick), (under - apron, under),
            tints.WOOD),
        *legs(inset(x, 0.3 * thick), inset(y, 0.3 * thick), (0.0, under), thick, tints.WOOD,
              taper=0.7),
    ]  # fmt: skip


def trestle_table(size: Vector) -> list[Part]:
    """A thick top on two trestles joined by a beam."""
    x, y, z = spans(size)
    board, thick = min(0.05, 0.15 * size[2]), _leg(size, 0.09)
    under, foot = z[1] - board, min(0.06, 0.12 * size[2])
    parts = [
        box("top", x, y, (under, z[1]), tints.LIGHT_WOOD),
        box("beam", within(x, 0.15, 0.85), about(0, 0.6 * thick), within(z, 0.42, 0.54),
            tints.LIGHT_WOOD),
    ]  # fmt: skip
    for side, center in (("left", x[0] + 0.18 * size[0]), ("right", x[1] - 0.18 * size[0])):
        column = about(center, thick)
        parts += [
            box(f"foot-{side}", column, within(y, 0.1, 0.9), (0.0, foot), tints.LIGHT_WOOD),
            block(f"post-{side}", (column, within(y, 0.38, 0.62)), (column, within(y, 0.3, 0.7)),
                  (foot, under - foot), tints.LIGHT_WOOD),
            box(f"head-{side}", column, within(y, 0.15, 0.85), (under - foot, under),
                tints.LIGHT_WOOD),
        ]  # fmt: skip
    return parts


def pedestal_table(size: Vector) -> list[Part]:
    """A round top on a turned column with a spreading foot."""
    x, y, z = spans(size)
    board = min(0.035, 0.12 * size[2])
    return [
        cylinder("top", x, y, (z[1] - board, z[1]), tints.DARK_WOOD, sides=16),
        lathe("foot", within(x, 0.2, 0.8), within(y, 0.2, 0.8), within(z, 0, 0.16),
              tints.DARK_WOOD, profile=((1.0, 0.0), (0.9, 0.25), (0.25, 1.0)), sides=10),
        lathe("column", within(x, 0.42, 0.58), within(y, 0.42, 0.58), (0.14 * size[2],
              z[1] - board), tints.DARK_WOOD, profile=((0.7, 0.0), (1.0, 1.0))),
    ]  # fmt: skip


def shelf_table(size: Vector) -> list[Part]:
    """A top and a lower shelf on four straight legs."""
    x, y, z = spans(size)
    board, thick = min(0.03, 0.15 * size[2]), _leg(size, 0.05)
    under = z[1] - board
    low = 0.25 * under
    return [
        box("top", x, y, (under, z[1]), tints.LIGHT_WOOD),
        box("shelf", inset(x, 0.5 * thick), inset(y, 0.5 * thick), (low, low + 0.8 * board),
            tints.LIGHT_WOOD),
        *legs(inset(x, 0.1 * thick), inset(y, 0.1 * thick), (0.0, under), thick, tints.DARK_WOOD),
    ]  # fmt: skip


def sled_table(size: Vector) -> list[Part]:
    """A thick top on two closed metal frames."""
    x, y, z = spans(size)
    board, thick = min(0.06, 0.2 * size[2]), _leg(size, 0.04)
    under = z[1] - board
    parts = [box("top", x, y, (under, z[1]), tints.WOOD)]
    for side, center in (("left", x[0] + 0.12 * size[0]), ("right", x[1] - 0.12 * size[0])):
        column, deep = about(center, thick), within(y, 0.06, 0.94)
        rise = (thick, under)
        parts += [
            box(f"runner-{side}", column, deep, (0.0, thick), tints.IRON)
            if thick < under
            else box(f"runner-{side}", column, deep, (0.0, 0.4 * under), tints.IRON),
            box(f"front-{side}", column, (deep[1] - thick, deep[1]), _above(rise, under),
                tints.IRON),
            box(f"rear-{side}", column, (deep[0], deep[0] + thick), _above(rise, under),
                tints.IRON),
        ]  # fmt: skip
    return parts


def _above(rise: Span, under: float) -> Span:
    # A very low table: the posts start where its thinner runner ends.
    return rise if rise[0] < under else (0.4 * under, under)


def round_coffee_table(size: Vector) -> list[Part]:
    """A round top on a drum-shaped base ring of four splayed legs."""
    x, y, z = spans(size)
    board, thick = min(0.03, 0.15 * size[2]), _leg(size, 0.05)
    under = z[1] - board
    return [
        cylinder("top", x, y, (under, z[1]), tints.LIGHT_WOOD, sides=16),
        cylinder("rim", within(x, 0.18, 0.82), within(y, 0.18, 0.82),
                 (under - 0.5 * board, under), tints.WOOD, sides=8),
        *legs(within(x, 0.12, 0.88), within(y, 0.12, 0.88), (0.0, under), thick, tints.WOOD,
              taper=0.6, splay=0.1 * min(size[0], size[1])),
    ]  # fmt: skip


def nightstand(size: Vector) -> list[Part]:
    """A bedside cabinet: a drawer above an open shelf, on short legs."""
    x, y, z = spans(size)
    board = min(0.025, 0.08 * size[2], 0.08 * size[0], 0.08 * size[1])
    front, knob = min(0.02, 0.06 * size[1]), min(0.025, 0.06 * size[1])
    face = y[1] - knob - front
    leg, under = 0.18 * size[2], z[1] - board
    middle = 0.6 * size[2]
    inner = inset(x, board)
    drawer = box("drawer", inset(inner, 0.1 * board), (face, face + front),
                 (middle + board, under - 0.2 * board), tints.LIGHT_WOOD)  # fmt: skip
    return [
        box("top", x, y, (under, z[1]), tints.WOOD),
        box("side-left", (x[0] + 0.1 * board, x[0] + board), (y[0], face), (leg, under),
            tints.WOOD),
        box("side-right", (x[1] - board, x[1] - 0.1 * board), (y[0], face), (leg, under),
            tints.WOOD),
        box("back", inner, (y[0] + 0.1 * board, y[0] + 0.6 * board), (leg, under), tints.WOOD),
        box("floor", inner, (y[0] + 0.6 * board, face - 0.1 * board), (leg, leg + board),
            tints.WOOD),
        box("case", inner, (y[0] + 0.6 * board, face), (middle, under - 0.1 * board), tints.WOOD),
        drawer,
        *knobs([drawer], (face + front, y[1]), tints.BRASS),
        *legs(inset(x, 0.3 * board), (y[0], face), (0.0, leg), min(0.035, 0.12 * size[0],
              0.12 * size[1]), tints.WOOD, taper=0.7),
    ]  # fmt: skip


def tripod_table(size: Vector) -> list[Part]:
    """A small round top on a column with three curved feet."""
    x, y, z = spans(size)
    board = min(0.025, 0.1 * size[2])
    thick = min(0.04, 0.12 * size[0], 0.12 * size[1])
    parts = [
        cylinder("top", x, y, (z[1] - board, z[1]), tints.WOOD, sides=16),
        lathe("column", about(0, 1.3 * thick), about(0, 1.3 * thick), (0.2 * size[2],
              z[1] - board), tints.WOOD, profile=((0.8, 0.0), (1.0, 0.2), (0.6, 1.0)), sides=6),
    ]  # fmt: skip
    for k in range(3):
        angle = math.pi / 2 + k * 2 * math.pi / 3
        aim = (0.4 * size[0] * math.cos(angle), 0.4 * size[1] * math.sin(angle))
        foot = (about(aim[0], 0.7 * thick), about(aim[1], 0.7 * thick))
        head = (about(0.1 * aim[0], thick), about(0.1 * aim[1], thick))
        parts.append(block(f"foot-{k + 1}", foot, head, (0.0, 0.3 * size[2]), tints.WOOD))
    return parts


def drawer_desk(size: Vector) -> list[Part]:
    """A desk with a pedestal of drawers on the right and a panel on the left.

    Its user sits at the front (+y).
    """
    x, y, z = spans(size)
    board = min(0.03, 0.12 * size[2])
    under = z[1] - board
    front, grip = min(0.02, 0.05 * size[1]), min(0.02, 0.04 * size[1])
    face = y[1] - front - grip - 0.01 * size[1]
    pedestal = (x[1] - min(0.45, 0.36 * size[0]), x[1] - 0.01 * size[0])
    drawers = fronts(inset(pedestal, 0.005 * size[0]), (0.06 * size[2], under - 0.1 * board),
                     (face, face + front), 1, (1.6, 1, 1), tints.LIGHT_WOOD,
                     name="drawer")  # fmt: skip
    return [
        box("top", x, y, (under, z[1]), tints.WOOD),
        box("pedestal", pedestal, (y[0] + 0.02 * size[1], face), (0.0, under), tints.WOOD),
        *drawers,
        *handles(drawers, (face + front, face + front + grip), tints.STEEL),
        box("panel", (x[0] + 0.01 * size[0], x[0] + 0.01 * size[0] + min(0.03, 0.1 * size[0])),
            within(y, 0.03, 0.95), (0.0, under), tints.WOOD),
        box("modesty", (x[0] + 0.02 * size[0] + min(0.03, 0.1 * size[0]), pedestal[0]),
            within(y, 0.06, 0.1), (0.35 * size[2], under), tints.WOOD),
    ]  # fmt: skip


def writing_desk(size: Vector) -> list[Part]:
    """A desk with shallow drawers under its top, on four slender legs."""
    x, y, z = spans(size)
    board, thick = min(0.03, 0.12 * size[2]), _leg(size, 0.05)
    under, chest = z[1] - board, z[1] - board - min(0.12, 0.2 * size[2])
    front, knob = min(0.015, 0.04 * size[1]), min(0.02, 0.04 * size[1])
    face = y[1] - front - knob - 0.01 * size[1]
    drawers = fronts(inset(x, 1.2 * thick), (chest, under), (face, face + front),
                     count_of(size[0], 0.6, 3), 1, tints.LIGHT_WOOD, name="drawer")  # fmt: skip
    return [
        box("top", x, y, (under, z[1]), tints.LIGHT_WOOD),
        box("chest", inset(x, thick), (y[0] + 0.03 * size[1], face), (chest, under), tints.WOOD),
        *drawers,
        *knobs(drawers, (face + front, face + front + knob), tints.BRASS),
        *legs(inset(x, 0.2 * thick), (y[0] + 0.02 * size[1], face + 0.9 * front), (0.0, under),
              thick, tints.WOOD, taper=0.6),
    ]  # fmt: skip


def frame_desk(size: Vector) -> list[Part]:
    """A plain top on two steel frames with a cross bar and a cable tray."""
    x, y, z = spans(size)
    board, thick = min(0.03, 0.12 * size[2]), _leg(size, 0.05)
    under = z[1] - board
    parts = [
        box("top", x, y, (under, z[1]), tints.PAINT),
        box("tray", within(x, 0.2, 0.8), within(y, 0.08, 0.25), within((0.0, under), 0.84, 0.92),
            tints.IRON),
    ]  # fmt: skip
    left, right = x[0] + 0.08 * size[0], x[1] - 0.08 * size[0]
    for side, center in (("left", left), ("right", right)):
        column = about(center, thick)
        parts += [
            box(f"foot-{side}", column, within(y, 0.05, 0.95), within((0.0, under), 0, 0.05),
                tints.IRON),
            box(f"post-{side}", column, about(-0.1 * size[1], 1.5 * thick),
                within((0.0, under), 0.05, 1), tints.IRON),
        ]  # fmt: skip
    start, end = (left + thick / 2, -0.1 * size[1]), (right - thick / 2, -0.1 * size[1])
    bar_height = 0.7 * under
    parts.append(bar("beam", (*start, bar_height), (*end, bar_height), 0.7 * thick, tints.IRON))
    return parts
