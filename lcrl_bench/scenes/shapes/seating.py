"""Chairs, armchairs, sofas, stools and benches."""

from __future__ import annotations

import math

from lcrl_bench.houses.house import Vector
from lcrl_bench.houses.receptacles import face_shares
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import about, count_of, inset, legs, spans, split, within
from lcrl_bench.scenes.shapes.primitives import Part, Tint, bar, block, box, cylinder


def slat_chair(size: Vector) -> list[Part]:
    """Four legs, a seat, and a back of upright posts and cross slats."""
    x, y, z = spans(size)
    seat = face_shares("chair")[0] * size[2]
    thick, board = min(0.04, 0.1 * size[0], 0.1 * size[1]), min(0.04, 0.2 * seat)
    back = (y[0], y[0] + thick)
    post = inset(x, thick * 0.2)
    slat = inset(x, thick)
    rise = (seat, z[1])
    return [
        box("seat", x, (y[0] + 0.3 * thick, y[1]), (seat - board, seat), tints.WOOD),
        *legs(inset(x, 0.1 * thick), (y[0], y[1] - 0.2 * thick), (0.0, seat - board), thick,
              tints.WOOD, taper=0.8),
        box("post-left", (post[0], post[0] + thick), back, rise, tints.WOOD),
        box("post-right", (post[1] - thick, post[1]), back, rise, tints.WOOD),
        box("slat-upper", slat, inset(back, 0.2 * thick), within(rise, 0.72, 0.96), tints.WOOD),
        box("slat-lower", slat, inset(back, 0.2 * thick), within(rise, 0.38, 0.56), tints.WOOD),
    ]  # fmt: skip


def upholstered_chair(size: Vector) -> list[Part]:
    """A padded seat and a solid padded back that leans, on tapered legs."""
    x, y, z = spans(size)
    seat = face_shares("chair")[0] * size[2]
    thick, pad = min(0.045, 0.1 * size[0], 0.08 * size[1]), min(0.09, 0.3 * seat)
    foot, head = (y[0] + thick, y[0] + 2 * thick), (y[0], y[0] + 0.8 * thick)
    narrow = inset(x, 0.04 * size[0])
    return [
        box("seat", x, (y[0] + 0.9 * thick, y[1]), (seat - pad, seat), tints.FABRIC),
        block("back", (narrow, foot), (narrow, head), (seat - pad / 2, z[1]), tints.FABRIC),
        *legs(narrow, inset(y, thick), (0.0, seat - pad), thick, tints.DARK_WOOD, taper=0.5),
    ]


def swivel_chair(size: Vector) -> list[Part]:
    """An office chair: a star of five feet, a column, a seat and a back on a stem."""
    x, y, z = spans(size)
    seat = face_shares("chair")[0] * size[2]
    pad, thick = min(0.08, 0.3 * seat), min(0.05, 0.1 * size[0], 0.1 * size[1])
    parts = [
        block("seat", (inset(x, 0.04 * size[0]), (y[0] + 0.12 * size[1], y[1])),
              (x, (y[0] + 0.1 * size[1], y[1])), (seat - pad, seat), tints.FABRIC),
        cylinder("column", about(0, thick), about(0, thick), (thick, seat - pad), tints.STEEL,
                 sides=6),
        block("back", (within(x, 0.12, 0.88), (y[0] + thick, y[0] + 1.8 * thick)),
              (within(x, 0.18, 0.82), (y[0], y[0] + 0.8 * thick)),
              (seat + 0.15 * (z[1] - seat), z[1]), tints.FABRIC),
        block("stem", (about(0, 1.5 * thick), within(y, 0.1, 0.2)), (about(0, 1.5 * thick),
              (y[0] + 1.05 * thick, y[0] + 1.6 * thick)), (seat - 0.6 * pad,
              seat + 0.25 * (z[1] - seat)), tints.IRON),
    ]  # fmt: skip
    for k in range(5):
        angle = math.pi / 2 + k * 2 * math.pi / 5
        end = (0.42 * size[0] * math.cos(angle), 0.42 * size[1] * math.sin(angle), thick * 0.5)
        parts.append(bar(f"foot-{k + 1}", (0.0, 0.0, thick), end, thick * 0.9, tints.IRON))
    return parts


def carver_chair(size: Vector) -> list[Part]:
    """A dining chair with arm rests."""
    x, y, z = spans(size)
    seat = face_shares("chair")[0] * size[2]
    thick, board = min(0.04, 0.09 * size[0], 0.09 * size[1]), min(0.05, 0.2 * seat)
    back = (y[0], y[0] + thick)
    arm = seat + 0.5 * (z[1] - seat)
    parts = [
        box("seat", inset(x, thick), (y[0] + 0.2 * thick, y[1]), (seat - board, seat),
            tints.PALE_FABRIC),
        box("back", inset(x, 0.9 * thick), inset(back, 0.15 * thick), (seat + board, z[1]),
            tints.PALE_FABRIC),
    ]  # fmt: skip
    for side, column in (("left", (x[0], x[0] + thick)), ("right", (x[1] - thick, x[1]))):
        parts += [
            box(f"post-{side}", column, back, (0.0, z[1] - 0.2 * thick), tints.DARK_WOOD),
            box(f"leg-{side}", column, (y[1] - 1.5 * thick, y[1] - 0.5 * thick),
                (0.0, arm - thick / 2), tints.DARK_WOOD),
            box(f"arm-{side}", column, (y[0] + thick, y[1] - 0.2 * thick),
                (arm - thick / 2, arm), tints.DARK_WOOD),
        ]  # fmt: skip
    return parts


def _couch(size: Vector, label: str, arm: float, tint: Tint, *, low_arms: bool) -> list[Part]:
    """Base, back, arms `arm` metres thick, and as many cushions as fit."""
    x, y, z = spans(size)
    seat = face_shares(label)[0] * size[2]
    back = min(0.25, 0.3 * size[1])
    foot = min(0.06, 0.25 * seat)
    inner = inset(x, arm)
    top = seat + 0.5 * (z[1] - seat) if low_arms else seat + 0.62 * (z[1] - seat)
    count = count_of(inner[1] - inner[0], 0.75, 3)
    seam = min(0.01, 0.02 * size[0])
    # The base is 3 mm below the cushions, so that seams are not holes.
    sink = min(0.003, 0.05 * seat)
    parts = [
        box("base", inset(x, 0.02 * arm), (y[0] + 0.02 * back, y[1] - 0.01 * size[1]),
            (foot, seat - sink), tint),
        box("back", inset(x, arm * 0.5), (y[0], y[0] + 0.7 * back), (foot * 1.2, z[1]), tint),
        box("arm-left", (x[0], x[0] + arm), (y[0] + 0.05 * back, y[1]), (foot * 0.9, top), tint),
        box("arm-right", (x[1] - arm, x[1]), (y[0] + 0.05 * back, y[1]), (foot * 0.9, top), tint),
        box("foot-front", inset(x, 0.1 * size[0]), (y[1] - 0.2 * back - 0.1 * size[1],
            y[1] - 0.1 * size[1]), (0.0, foot), tints.DARK_WOOD),
        box("foot-back", inset(x, 0.1 * size[0]), (y[0] + 0.1 * size[1],
            y[0] + 0.1 * size[1] + 0.2 * back), (0.0, foot), tints.DARK_WOOD),
    ]  # fmt: skip
    cushion = min(0.14, 0.4 * seat)
    for k, column in enumerate(split(inner, count, seam)):
        parts.append(box(f"cushion-{k + 1}", column, (y[0] + back * 0.6, y[1] - 0.005 * size[1]),
                         (seat - cushion, seat), tint))  # fmt: skip
        rest = (y[0] + 0.5 * back, y[0] + 1.2 * back)
        lean = (y[0] + 0.5 * back, y[0] + 0.95 * back)
        parts.append(block(f"rest-{k + 1}", (column, rest), (inset(column, seam), lean),
                           (seat, seat + 0.85 * (z[1] - seat)), tint))  # fmt: skip
    return parts


def box_sofa(size: Vector) -> list[Part]:
    """A sofa with broad square arms and loose cushions."""
    return _couch(size, "sofa", min(0.2, 0.13 * size[0]), tints.FABRIC, low_arms=False)


def rolled_sofa(size: Vector) -> list[Part]:
    """A sofa whose arms end in rolls."""
    arm = min(0.16, 0.1 * size[0])
    low, high = spans(size)[0]
    inner = (size[0] - 2 * (0.13 * size[0] - arm), size[1], size[2])
    parts = _couch(inner, "sofa", arm, tints.LEATHER, low_arms=True)
    seat = face_shares("sofa")[0] * size[2]
    top = seat + 0.66 * (size[2] - seat)
    roll = min(0.13 * size[0], 0.5 * (size[2] - seat))
    y = (-0.46 * size[1], 0.495 * size[1])
    for side, x in (("left", (low, low + roll)), ("right", (high - roll, high))):
        parts.append(
            cylinder(f"roll-{side}", x, y, (top - roll, top), tints.LEATHER, axis="y", sides=8)
        )
    return parts


def slim_sofa(size: Vector) -> list[Part]:
    """A sofa on tall tapered legs, with thin wooden arms."""
    return _slim(size, "sofa", tints.WARM_FABRIC)


def _slim(size: Vector, label: str, tint: Tint) -> list[Part]:
    x, y, z = spans(size)
    seat = face_shares(label)[0] * size[2]
    thick = min(0.06, 0.08 * size[0], 0.1 * size[1])
    leg = 0.45 * seat
    back = min(0.22, 0.3 * size[1])
    arm = seat + 0.45 * (z[1] - seat)
    count = count_of(size[0], 0.8, 3)
    column = split(inset(x, thick), count, min(0.01, 0.02 * size[0]))
    sink = min(0.003, 0.05 * seat)
    parts = [
        box("base", inset(x, 0.3 * thick), inset(y, 0.02 * size[1]), (leg, seat - sink),
            tints.WOOD),
        *legs(inset(x, 0.1 * thick), inset(y, 0.03 * size[1]), (0.0, leg), thick, tints.WOOD,
              taper=0.5),
    ]  # fmt: skip
    for side, span in (("left", (x[0], x[0] + thick)), ("right", (x[1] - thick, x[1]))):
        front, rear = (y[1] - 1.4 * thick, y[1] - 0.4 * thick), (y[0], y[0] + thick)
        parts += [
            box(f"arm-{side}", span, (y[0] + thick, y[1]), (arm - 0.7 * thick, arm), tints.WOOD),
            box(f"post-{side}", span, front, (leg * 1.05, arm - 0.7 * thick), tints.WOOD),
            box(f"stile-{side}", span, rear, (leg * 1.05, arm + 0.5 * thick), tints.WOOD),
        ]
    for k, across in enumerate(column):
        bottom, top = (y[0] + 0.5 * back, y[0] + 1.2 * back), (y[0], y[0] + 0.6 * back)
        parts += [
            box(f"cushion-{k + 1}", across, (y[0] + 0.5 * back, y[1] - 0.01 * size[1]),
                (seat - 0.4 * seat, seat), tint),
            block(f"rest-{k + 1}", (across, bottom), (across, top), (seat, z[1]), tint),
        ]  # fmt: skip
    return parts


def club_armchair(size: Vector) -> list[Part]:
    """An armchair with broad square arms."""
    return _couch(size, "armchair", min(0.2, 0.19 * size[0]), tints.WARM_FABRIC, low_arms=False)


def wooden_armchair(size: Vector) -> list[Part]:
    """An armchair of cushions in an open wooden frame."""
    return _slim(size, "armchair", tints.PALE_FABRIC)


def tub_armchair(size: Vector) -> list[Part]:
    """An armchair whose back curves round into its arms."""
    x, y, z = spans(size)
    seat = face_shares("armchair")[0] * size[2]
    foot = min(0.12, 0.35 * seat)
    return [
        hollow("round-back", "back", x, (y[0], y[1] - 0.08 * size[1]), (foot, z[1]), tints.FABRIC),
        box("seat", within(x, 0.1, 0.9), (y[0] + 0.2 * size[1], y[1]), (foot * 1.02, seat),
            tints.FABRIC),
        *legs(within(x, 0.1, 0.9), within(y, 0.12, 0.88), (0.0, foot), min(0.05, 0.1 * size[0],
              0.1 * size[1]), tints.DARK_WOOD, taper=0.6),
    ]  # fmt: skip


def round_stool(size: Vector) -> list[Part]:
    """A round seat on four splayed legs."""
    x, y, z = spans(size)
    board = min(0.04, 0.2 * size[2])
    thick = min(0.035, 0.1 * size[0], 0.1 * size[1])
    splay = 0.12 * min(size[0], size[1])
    return [
        cylinder("seat", x, y, (z[1] - board, z[1]), tints.WOOD, sides=12),
        *legs(within(x, 0.05, 0.95), within(y, 0.05, 0.95), (0.0, z[1] - board), thick, tints.WOOD,
              taper=0.7, splay=splay),
    ]  # fmt: skip


def square_stool(size: Vector) -> list[Part]:
    """A padded square seat on straight legs with stretchers."""
    x, y, z = spans(size)
    pad = min(0.07, 0.25 * size[2])
    thick = min(0.04, 0.12 * size[0], 0.12 * size[1])
    rung = within(z, 0.25, 0.25 + 0.5 * thick / max(size[2], thick))
    inner, across = inset(x, 1.05 * thick), inset(y, 1.05 * thick)
    return [
        box("seat", x, y, (z[1] - pad, z[1]), tints.WARM_FABRIC),
        *legs(inset(x, 0.05 * thick), inset(y, 0.05 * thick), (0.0, z[1] - pad), thick,
              tints.DARK_WOOD),
        box("rung-left", (x[0] + 0.2 * thick, x[0] + 0.8 * thick), across, rung, tints.DARK_WOOD),
        box("rung-right", (x[1] - 0.8 * thick, x[1] - 0.2 * thick), across, rung, tints.DARK_WOOD),
        box("rung-front", inner, (y[1] - 0.8 * thick, y[1] - 0.2 * thick), rung, tints.DARK_WOOD),
    ]  # fmt: skip


def bar_stool(size: Vector) -> list[Part]:
    """A round seat on one steel column with a foot plate and a foot rest."""
    x, y, z = spans(size)
    pad, plate = min(0.07, 0.2 * size[2]), min(0.02, 0.1 * size[2])
    thick = 0.14 * min(size[0], size[1])
    rest = 0.3 * size[2]
    return [
        cylinder("seat", x, y, (z[1] - pad, z[1]), tints.LEATHER, sides=12),
        cylinder("foot", within(x, 0.05, 0.95), within(y, 0.05, 0.95), (0.0, plate), tints.STEEL,
                 sides=12),
        cylinder("column", about(0, thick), about(0, thick), (plate, z[1] - pad), tints.STEEL),
        box("rest", within(x, 0.25, 0.75), (0.0, 0.4 * size[1]), (rest, rest + 0.3 * thick),
            tints.STEEL),
    ]  # fmt: skip


def plank_bench(size: Vector) -> list[Part]:
    """A plank on two panels with a stretcher between them."""
    x, y, z = spans(size)
    board = min(0.05, 0.2 * size[2])
    panel = min(0.05, 0.1 * size[0])
    left, right = x[0] + 0.08 * size[0], x[1] - 0.08 * size[0]
    deep, rise = inset(y, 0.06 * size[1]), (0.0, z[1] - board)
    return [
        box("seat", x, y, (z[1] - board, z[1]), tints.WOOD),
        box("panel-left", (left, left + panel), deep, rise, tints.WOOD),
        box("panel-right", (right - panel, right), deep, rise, tints.WOOD),
        box("stretcher", (left + panel, right - panel), within(y, 0.44, 0.56),
            within(z, 0.45, 0.65), tints.WOOD),
    ]  # fmt: skip


def padded_bench(size: Vector) -> list[Part]:
    """A padded seat on four tapered legs."""
    x, y, z = spans(size)
    pad = min(0.1, 0.3 * size[2])
    thick = min(0.05, 0.1 * size[0], 0.15 * size[1])
    return [
        box("seat", x, y, (z[1] - pad, z[1]), tints.PALE_FABRIC),
        box("rail", inset(x, thick * 0.3), inset(y, thick * 0.3),
            (z[1] - pad - 0.5 * thick if pad + thick < size[2] else 0.5 * (z[1] - pad),
             z[1] - pad), tints.DARK_WOOD),
        *legs(inset(x, thick * 0.5), inset(y, thick * 0.5), (0.0, z[1] - pad), thick,
              tints.DARK_WOOD, taper=0.6),
    ]  # fmt: skip


def chest_bench(size: Vector) -> list[Part]:
    """A storage bench: a chest with panels and a padded lid."""
    x, y, z = spans(size)
    pad = min(0.06, 0.2 * size[2])
    relief = min(0.012, 0.05 * size[1])
    count = count_of(size[0], 0.5, 3, least=2)
    return [
        box("seat", x, y, (z[1] - pad, z[1]), tints.WARM_FABRIC),
        box("chest", within(x, 0.01, 0.99), (y[0], y[1] - 2 * relief), (0.0, z[1] - pad),
            tints.PAINT),
        *[box(f"panel-{k + 1}", span, (y[1] - 2 * relief, y[1] - relief),
              within((0.0, z[1] - pad), 0.15, 0.85), tints.PAINT)
          for k, span in enumerate(split(within(x, 0.06, 0.94), count, 0.05 * size[0]))],
    ]  # fmt: skip
