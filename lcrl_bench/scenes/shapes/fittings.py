"""Parts of the building placed like objects: doors, stairs, columns, curtains and rugs."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import about, count_of, frame, inset, spans, split, within
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Span,
    Tint,
    block,
    box,
    cylinder,
    extrusion,
    lathe,
)


def _lever(size: Vector, side: float) -> list[Part]:
    """Handles on both faces of a leaf, near its edge at fraction `side` of x."""
    x, y, _ = spans(size)
    height = min(1.02, 0.5 * size[2])
    plate, grip = min(0.05, 0.08 * size[0]), min(0.13, 0.16 * size[0])
    center = x[0] + side * size[0]
    away = -1 if side > 0.5 else 1
    thick = min(0.025, 0.05 * size[2])
    reach = (center, center + away * grip)
    parts = []
    for name, outer, shield in (
        ("front", within(y, 0.88, 1), within(y, 0.78, 0.9)),
        ("rear", within(y, 0, 0.12), within(y, 0.1, 0.22)),
    ):
        parts += [
            box(f"shield-{name}", about(center, plate), shield, about(height, 4 * thick),
                tints.STEEL),
            box(f"lever-{name}", (min(reach), max(reach)), outer, about(height, thick),
                tints.STEEL),
        ]  # fmt: skip
    return parts


def panelled_door(size: Vector) -> list[Part]:
    """A leaf with two raised panels on each face and lever handles."""
    x, y, z = spans(size)
    panels = [
        box(f"panel-{k + 1}", within(x, 0.16, 0.84), within(y, 0.17, 0.83), within(z, *rise),
            tints.PLASTIC)
        for k, rise in enumerate(((0.08, 0.42), (0.56, 0.94)))
    ]  # fmt: skip
    leaf = box("leaf", x, within(y, 0.22, 0.78), z, tints.PAINT)
    return [leaf, *panels, *_lever(size, 0.92)]


def flush_door(size: Vector) -> list[Part]:
    """A plain leaf with round knobs."""
    x, y, z = spans(size)
    thick = min(0.06, 0.1 * size[0], 0.1 * size[2])
    center, height = x[0] + 0.9 * size[0], min(1.02, 0.5 * size[2])
    knob = about(center, thick), about(height, thick)
    return [
        box("leaf", x, within(y, 0.2, 0.8), z, tints.WOOD),
        cylinder("knob-front", knob[0], within(y, 0.8, 1), knob[1], tints.BRASS, axis="y"),
        cylinder("knob-rear", knob[0], within(y, 0, 0.2), knob[1], tints.BRASS, axis="y"),
    ]


def glazed_door(size: Vector) -> list[Part]:
    """A framed leaf with a pane above a solid lower panel."""
    x, y, z = spans(size)
    stile = min(0.11, 0.2 * size[0], 0.2 * size[2])
    leaf = within(y, 0.22, 0.78)
    low = within(z, 0.0, 0.42)[1]
    return [
        *frame(x, leaf, z, stile, tints.DARK_WOOD),
        box("panel", inset(x, stile), within(y, 0.3, 0.7), (stile, max(low, 1.1 * stile)),
            tints.WOOD),
        box("pane", inset(x, stile), within(y, 0.45, 0.55), (max(low, 1.1 * stile),
            z[1] - stile), tints.GLASS),
        *_lever(size, 0.94),
    ]  # fmt: skip


def closed_stairs(size: Vector) -> list[Part]:
    """A solid flight that rises from the front to the back, each step with a tread."""
    x, y, _ = spans(size)
    count = count_of(size[2], 0.18, 16, least=2)
    rise, run = size[2] / count, size[1] / count
    nose = min(0.03, 0.2 * run)
    board = min(0.03, 0.2 * rise)
    parts = []
    for k in range(count):
        front, top = y[1] - k * run, (k + 1) * rise
        rear = front - run
        parts.append(box(f"step-{k + 1}", inset(x, 0.01 * size[0]), (rear, front - nose),
                         (0.0, top - board), tints.PAINT))  # fmt: skip
        parts.append(box(f"tread-{k + 1}", x, (rear, front), (top - board, top), tints.WOOD))
    return parts


def open_stairs(size: Vector) -> list[Part]:
    """Treads between two slanting strings, rising from the front to the back."""
    x, y, _ = spans(size)
    count = count_of(size[2], 0.18, 16, least=2)
    rise, run = size[2] / count, size[1] / count
    board, string = min(0.05, 0.3 * rise), min(0.05, 0.1 * size[0])
    parts = []
    for k in range(count):
        front, top = y[1] - k * run, (k + 1) * rise
        parts.append(box(f"tread-{k + 1}", inset(x, 0.9 * string), (front - run, front),
                         (top - board, top), tints.WOOD))  # fmt: skip
    # As fractions of the depth from the back and of the height.
    outline = ((0.0, 0.8), (0.0, 1.0), (1.0, 0.16), (1.0, 0.0), (0.86, 0.0))
    for side, span in (("left", (x[0], x[0] + string)), ("right", (x[1] - string, x[1]))):
        parts.append(extrusion(f"string-{side}", span, y, (0.0, size[2]), tints.DARK_WOOD,
                               outline=outline, axis="x"))  # fmt: skip
    return parts


def round_column(size: Vector) -> list[Part]:
    """A round shaft between a square base and a square capital."""
    return _column(size, 12)


def square_column(size: Vector) -> list[Part]:
    """A square shaft between a base and a capital."""
    return _column(size, 4)


def _column(size: Vector, sides: int) -> list[Part]:
    x, y, z = spans(size)
    slab = min(0.12, 0.08 * size[2])
    inner_x, inner_y = inset(x, 0.12 * size[0]), inset(y, 0.12 * size[1])
    rise = inset(z, slab)
    shaft = (
        box("shaft", inner_x, inner_y, rise, tints.PAINT)
        if sides == 4
        else lathe("shaft", inner_x, inner_y, rise, tints.PAINT, sides=sides,
                   profile=((1.0, 0.0), (0.98, 0.5), (0.86, 1.0)))
    )  # fmt: skip
    return [
        box("base", x, y, (0.0, slab), tints.STONE),
        shaft,
        box("capital", x, y, (z[1] - slab, z[1]), tints.STONE),
    ]


def _folds(name: str, x: Span, y: Span, z: Span, tint: Tint, *, taper: float = 1.0) -> list[Part]:
    """A hanging cloth of overlapping folds; `taper` is the fraction of the width at the foot."""
    count = count_of(x[1] - x[0], 0.14, 7, least=2)
    width = (x[1] - x[0]) / count
    middle = x[0] if name.endswith("left") else x[1]
    parts = []
    for k in range(count):
        top = (x[0] + k * width, x[0] + (k + 1) * width)
        bottom = (middle + taper * (top[0] - middle), middle + taper * (top[1] - middle))
        deep = within(y, 0.0, 0.75) if k % 2 else within(y, 0.25, 1.0)
        parts.append(block(f"{name}-{k + 1}", (bottom, deep), (top, deep), z, tint))
    return parts


def parted_curtain(size: Vector) -> list[Part]:
    """Two drapes drawn to the sides of a rod."""
    x, y, z = spans(size)
    rod = min(0.04, 0.1 * size[2])
    rise = (0.0, z[1] - 0.5 * rod)
    return [
        box("rod", x, within(y, 0.3, 0.7), (z[1] - rod, z[1]), tints.BRASS),
        *_folds("drape-left", within(x, 0.02, 0.32), y, rise, tints.WARM_FABRIC),
        *_folds("drape-right", within(x, 0.68, 0.98), y, rise, tints.WARM_FABRIC),
    ]


def drawn_curtain(size: Vector) -> list[Part]:
    """A cloth drawn over the whole width of its rod."""
    x, y, z = spans(size)
    rod = min(0.04, 0.1 * size[2])
    return [
        box("rod", x, within(y, 0.3, 0.7), (z[1] - rod, z[1]), tints.STEEL),
        *_folds("cloth", within(x, 0.02, 0.98), y, (0.0, z[1] - 0.5 * rod), tints.FABRIC),
    ]


def tied_curtain(size: Vector) -> list[Part]:
    """Two drapes gathered by ties half way up."""
    x, y, z = spans(size)
    rod = min(0.04, 0.1 * size[2])
    tie = 0.4 * size[2]
    left, right = within(x, 0.02, 0.46), within(x, 0.54, 0.98)
    parts = [box("rod", x, within(y, 0.3, 0.7), (z[1] - rod, z[1]), tints.BRASS)]
    for side, wide in (("left", left), ("right", right)):
        narrow = within(wide, 0, 0.32) if side == "left" else within(wide, 0.68, 1)
        foot = within(wide, 0, 0.45) if side == "left" else within(wide, 0.55, 1)
        parts += [
            *_folds(f"upper-{side}", wide, y, (tie, z[1] - 0.5 * rod), tints.PALE_FABRIC,
                    taper=0.32),
            block(f"lower-{side}", (foot, y), (narrow, y), (0.0, tie), tints.PALE_FABRIC),
            box(f"tie-{side}", within(narrow, -0.05, 1.05), within(y, 0.1, 0.9),
                about(tie, min(0.08, 0.1 * size[2])), tints.BRASS),
        ]  # fmt: skip
    return parts


def bordered_rug(size: Vector) -> list[Part]:
    """A rectangular rug with a border around its field."""
    x, y, z = spans(size)
    edge = min(0.15, 0.15 * size[0], 0.15 * size[1])
    return [
        box("border", x, y, within(z, 0, 0.8), tints.LEATHER),
        box("field", inset(x, edge), inset(y, edge), within(z, 0.4, 1), tints.WARM_FABRIC),
    ]


def round_rug(size: Vector) -> list[Part]:
    """A round or oval rug with a ring around its field."""
    x, y, z = spans(size)
    return [
        cylinder("border", x, y, within(z, 0, 0.8), tints.PALE_FABRIC, sides=16),
        cylinder("field", within(x, 0.1, 0.9), within(y, 0.1, 0.9), within(z, 0.4, 1),
                 tints.FABRIC, sides=16),
    ]  # fmt: skip


def fringed_rug(size: Vector) -> list[Part]:
    """A long rug with stripes across and fringes at its two narrow ends."""
    x, y, z = spans(size)
    long_x = size[0] >= size[1]
    along, across = (x, y) if long_x else (y, x)
    fringe = min(0.06, 0.06 * (along[1] - along[0]))

    def strip(name: str, start: Span, side: Span, rise: Span, tint: Tint) -> Part:
        return box(name, start if long_x else side, side if long_x else start, rise, tint)

    body = inset(along, fringe)
    parts = [strip("field", body, across, within(z, 0, 0.8), tints.BLUE)]
    parts += [
        strip(f"stripe-{k + 1}", within(body, *share), within(across, 0.005, 0.995),
              within(z, 0.4, 1), tints.PALE_FABRIC)
        for k, share in enumerate(((0.12, 0.2), (0.46, 0.54), (0.8, 0.88)))
    ]  # fmt: skip
    teeth = split(inset(across, 0.01 * (across[1] - across[0])), 5,
                  0.08 * (across[1] - across[0]))  # fmt: skip
    for k, tooth in enumerate(teeth):
        parts.append(strip(f"fringe-a{k + 1}", (along[0], body[0]), tooth, within(z, 0, 0.5),
                           tints.LINEN))  # fmt: skip
        parts.append(strip(f"fringe-b{k + 1}", (body[1], along[1]), tooth, within(z, 0, 0.5),
                           tints.LINEN))  # fmt: skip
    return parts
