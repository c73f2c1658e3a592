"""Sinks, toilets, bathtubs, showers and mirrors."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.hollows import hollow
from lcrl_bench.scenes.shapes.pieces import (
    about,
    count_of,
    frame,
    fronts,
    handles,
    inset,
    legs,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import Part, Span, block, box, cylinder, lathe


def _tap(y: Span, z: Span, thickness: float) -> list[Part]:
    """A tap that rises from the back and reaches forward, with a lever on top."""
    rise = z[1] - z[0]
    lever = min(0.25 * rise, thickness)
    return [
        box("tap", about(0, thickness), (y[0], y[0] + thickness), (z[0], z[1] - lever),
            tints.STEEL),
        box("spout", about(0, 0.9 * thickness), (y[0] + thickness, y[1]),
            (z[1] - lever - 0.25 * rise, z[1] - lever), tints.STEEL),
        block("tap-lever", (about(0, 0.6 * thickness), (y[0] + 0.2 * thickness,
              y[0] + 0.9 * thickness)), (about(0, 0.6 * thickness), (y[0], y[0] + 0.5 * thickness)),
              (z[1] - lever, z[1]), tints.STEEL),
    ]  # fmt: skip


def _sink_height(size: Vector) -> float:
    """Height of the rim; the tap is above it."""
    return size[2] - min(0.18, 0.35 * size[2])


def pedestal_sink(size: Vector) -> list[Part]:
    """An oval basin on a column."""
    x, y, z = spans(size)
    rim = _sink_height(size)
    bowl = min(0.22, 0.6 * rim)
    thick = min(0.04, 0.1 * size[0], 0.08 * size[1])
    return [
        block("foot", (within(x, 0.35, 0.65), within(y, 0.12, 0.52)),
              (within(x, 0.4, 0.6), within(y, 0.15, 0.5)), (0.0, rim - 0.85 * bowl),
              tints.CERAMIC),
        hollow("basin-oval", "basin", x, within(y, 0.1, 1), (rim - bowl, rim), tints.CERAMIC),
        box("ledge", within(x, 0.2, 0.8), within(y, 0, 0.16), (rim - 0.4 * bowl, rim - 0.01 * bowl),
            tints.CERAMIC),
        *_tap((y[0] + 0.04 * size[1], y[0] + 0.36 * size[1]), (rim - 0.01 * bowl, z[1]), thick),
    ]  # fmt: skip


def vanity_sink(size: Vector) -> list[Part]:
    """A basin set into the top of a cabinet with doors."""
    x, y, z = spans(size)
    rim = _sink_height(size)
    bowl, plinth = min(0.14, 0.4 * rim), min(0.1, 0.12 * rim)
    grip = min(0.02, 0.04 * size[1])
    face = y[1] - 2 * grip
    low = rim - bowl
    thick = min(0.04, 0.1 * size[0], 0.08 * size[1])
    doors = fronts(inset(x, 0.03 * size[0]), (plinth, low), (face, face + grip),
                   count_of(size[0], 0.4, 4), 1, tints.PAINT, name="door")  # fmt: skip
    return [
        hollow("basin-square", "basin", x, (y[0] + 0.14 * size[1], y[1]), (low, rim),
               tints.CERAMIC),
        box("ledge", x, (y[0], y[0] + 0.15 * size[1]), (low, rim - 0.001 * size[2]), tints.CERAMIC),
        box("cabinet", inset(x, 0.02 * size[0]), (y[0] + 0.01 * size[1], face), (plinth, low),
            tints.PAINT),
        box("plinth", inset(x, 0.04 * size[0]), (y[0] + 0.02 * size[1], face - 2 * grip),
            (0.0, plinth), tints.IRON),
        *doors,
        *handles(doors, (face + grip, y[1] - 0.1 * grip), tints.STEEL, upright=True),
        *_tap((y[0] + 0.04 * size[1], y[0] + 0.42 * size[1]), (rim - 0.002 * size[2], z[1]), thick),
    ]  # fmt: skip


def kitchen_sink(size: Vector) -> list[Part]:
    """A steel basin beside a draining board, over a cupboard if tall enough."""
    x, y, z = spans(size)
    rim = _sink_height(size)
    bowl = min(0.2, 0.9 * rim) if rim < 0.45 else min(0.2, 0.4 * rim)
    low = rim - bowl
    left, right = within(x, 0, 0.58), within(x, 0.58, 1)
    rear = within(y, 0, 0.13)
    thick = min(0.035, 0.1 * size[0], 0.06 * size[1])
    parts = [
        hollow("basin-square", "basin", left, within(y, 0.13, 1), (low, rim), tints.STEEL),
        box("drainer", right, within(y, 0.13, 1), (low, rim - 0.08 * bowl), tints.STEEL),
        *[box(f"ridge-{k + 1}", within(right, 0.12 + 0.22 * k, 0.2 + 0.22 * k),
              within(y, 0.2, 0.94), (rim - 0.09 * bowl, rim - 0.02 * bowl), tints.STEEL)
          for k in range(4)],
        box("ledge", x, rear, (low, rim - 0.01 * bowl), tints.STEEL),
        *_tap(within(y, 0.03, 0.42), (rim - 0.02 * bowl, z[1]), thick),
    ]  # fmt: skip
    if low < 0.1 * size[2]:
        # A basin without a cupboard: its underside carries a plate.
        return [*parts, box("plate", within(x, 0.04, 0.96), within(y, 0.04, 0.96), (0.0, low),
                            tints.STEEL)]  # fmt: skip
    grip = min(0.02, 0.04 * size[1])
    face = y[1] - 2 * grip
    doors = fronts(inset(x, 0.01 * size[0]), (0.1 * low, low), (face, face + grip), 2, 1,
                   tints.LIGHT_WOOD, name="door")  # fmt: skip
    return [
        *parts,
        box("cupboard", inset(x, 0.005 * size[0]), (y[0], face), (0.0, low), tints.LIGHT_WOOD),
        *doors,
        *handles(doors, (face + grip, y[1] - 0.1 * grip), tints.STEEL, upright=True),
    ]


def close_coupled_toilet(size: Vector) -> list[Part]:
    """A bowl with a seat and a raised lid, and a tank behind with a button."""
    x, y, z = spans(size)
    rim, button = 0.5 * size[2], 0.03 * size[2]
    lid = min(0.03, 0.06 * size[2])
    bowl = within(x, 0.08, 0.92), within(y, 0.24, 0.99)
    seat = min(0.03, 0.05 * size[2])
    return [
        box("foot", within(x, 0.28, 0.72), within(y, 0.12, 0.72), (0.0, 0.55 * rim),
            tints.CERAMIC),
        hollow("toilet-bowl", "bowl", *bowl, (0.3 * rim, rim), tints.CERAMIC),
        hollow("seat-ring", "seat", within(x, 0.06, 0.94), within(y, 0.25, 1), (rim, rim + seat),
               tints.PAINT),
        box("shelf", within(x, 0.2, 0.8), within(y, 0.02, 0.34), (0.5 * rim, rim), tints.CERAMIC),
        block("lid", (within(x, 0.14, 0.86), within(y, 0.25, 0.3)), (within(x, 0.2, 0.8),
              within(y, 0.21, 0.25)), (rim + seat, 0.94 * size[2]), tints.PAINT),
        block("tank", (within(x, 0.06, 0.94), within(y, 0.01, 0.19)), (within(x, 0.02, 0.98),
              within(y, 0.005, 0.2)), (rim, z[1] - button - lid), tints.CERAMIC),
        box("tank-lid", x, within(y, 0, 0.205), (z[1] - button - lid, z[1] - button),
            tints.CERAMIC),
        box("button", within(x, 0.44, 0.56), within(y, 0.07, 0.14), (z[1] - button, z[1]),
            tints.STEEL),
    ]  # fmt: skip


def closed_toilet(size: Vector) -> list[Part]:
    """A bowl under a closed lid, with a slim tall cistern and a flush plate."""
    x, y, z = spans(size)
    rim, cover = 0.5 * size[2], min(0.03, 0.05 * size[2])
    bowl = within(x, 0.06, 0.94), within(y, 0.2, 0.99)
    return [
        box("cistern", x, within(y, 0, 0.22), z, tints.PAINT),
        box("plate", within(x, 0.33, 0.67), within(y, 0.21, 0.24), within(z, 0.76, 0.88),
            tints.STEEL),
        box("foot", within(x, 0.26, 0.74), within(y, 0.2, 0.7), (0.0, 0.5 * rim), tints.CERAMIC),
        hollow("toilet-bowl", "bowl", *bowl, (0.25 * rim, rim), tints.CERAMIC),
        hollow("seat-ring", "seat", within(x, 0.05, 0.95), within(y, 0.205, 0.995),
               (rim, rim + cover), tints.PAINT),
        lathe("lid", within(x, 0.04, 0.96), within(y, 0.2, 1), (rim + cover, rim + 2 * cover),
              tints.CERAMIC, profile=((1.0, 0.0), (0.94, 1.0)), sides=12),
    ]  # fmt: skip


def panelled_bathtub(size: Vector) -> list[Part]:
    """A built-in tub with a flat front, and taps at its narrow end."""
    x, y, z = spans(size)
    rim = size[2] - min(0.12, 0.2 * size[2])
    front = min(0.02, 0.03 * size[1])
    thick = min(0.04, 0.05 * size[0], 0.1 * size[1])
    inner = y[0], y[1] - front
    # Where the tap stands and where its spout ends, on the rim of a narrow end.
    if size[0] >= size[1]:
        stand, reach = (within(x, 0.01, 0.04), about(sum(inner) / 2, thick)), within(x, 0.01, 0.13)
        spout = (reach, stand[1])
    else:
        stand, reach = (about(0, thick), within(inner, 0.01, 0.04)), within(inner, 0.01, 0.13)
        spout = (stand[0], reach)
    return [
        hollow("bathtub-square", "tub", x, inner, (0.0, rim), tints.CERAMIC),
        box("panel", within(x, 0.03, 0.97), (y[1] - 2 * front, y[1]), within((0.0, rim), 0.05, 0.9),
            tints.PAINT),
        box("tap", *stand, (rim - 0.02 * size[2], z[1]), tints.STEEL),
        box("spout", *spout, within((rim, z[1]), 0.5, 0.9), tints.STEEL),
    ]  # fmt: skip


def standing_bathtub(size: Vector) -> list[Part]:
    """A free-standing oval tub on four feet, with a tall tap beside its back edge."""
    x, y, z = spans(size)
    rim, foot = 0.84 * size[2], 0.14 * size[2]
    thick = min(0.04, 0.05 * size[0], 0.06 * size[1])
    return [
        hollow("bathtub-oval", "tub", x, within(y, 0.06, 1), (foot, rim), tints.CERAMIC),
        *legs(within(x, 0.2, 0.8), within(y, 0.28, 0.8), (0.0, 1.3 * foot),
              min(0.07, 0.1 * size[0], 0.1 * size[1]), tints.BRASS, taper=0.6),
        box("tap", about(0, thick), (y[0], y[0] + thick), z, tints.BRASS),
        box("spout", about(0, 0.9 * thick), (y[0] + thick, y[0] + 0.26 * size[1]),
            within(z, 0.93, 0.985), tints.BRASS),
    ]  # fmt: skip


def _shower_head(size: Vector, floor: float) -> list[Part]:
    """A mixer, a riser at the back wall and a head on an arm."""
    _, y, _ = spans(size)
    pipe = min(0.025, 0.05 * size[0], 0.05 * size[1])
    disc = min(0.24, 0.3 * size[0], 0.3 * size[1])
    top = 0.93 * size[2]
    reach = y[0] + 0.35 * size[1]
    mixer = floor + 0.45 * (size[2] - floor)
    return [
        box("riser", about(0, pipe), (y[0] + pipe, y[0] + 2 * pipe), (mixer, top), tints.STEEL),
        box("arm", about(0, pipe), (y[0] + pipe, reach), (top, top + pipe), tints.STEEL),
        cylinder("head", about(0, disc), about(reach, disc), (top - 1.2 * pipe, top), tints.STEEL,
                 sides=10),
        box("mixer", about(0, min(0.2, 0.3 * size[0])), (y[0] + 0.8 * pipe, y[0] + 3 * pipe),
            (mixer - 1.2 * pipe, mixer + 1.2 * pipe), tints.STEEL),
    ]  # fmt: skip


def corner_shower(size: Vector) -> list[Part]:
    """A tray with a tiled back wall, a glass side, a glass front with a door, and a rain head."""
    x, y, z = spans(size)
    tray = min(0.08, 0.06 * size[2])
    pane = min(0.012, 0.02 * size[0], 0.02 * size[1])
    post = 2 * pane
    return [
        box("tray", x, y, (0.0, tray), tints.CERAMIC),
        box("wall", inset(x, post), (y[0], y[0] + pane), (tray, z[1]), tints.PAINT),
        box("side", (x[1] - pane, x[1] - 0.2 * pane), inset(y, post), (tray, 0.98 * z[1]),
            tints.GLASS),
        box("front", within(x, 0.5, 0.98), (y[1] - 1.5 * pane, y[1] - 0.5 * pane),
            (tray, 0.98 * z[1]), tints.GLASS),
        *legs(x, y, (tray, z[1]), post, tints.STEEL),
        box("rail", inset(x, post), (y[1] - post, y[1]), (0.98 * z[1], z[1]), tints.STEEL),
        box("handle", within(x, 0.52, 0.54), (y[1] - 0.6 * pane, y[1]), within(z, 0.42, 0.56),
            tints.STEEL),
        *_shower_head(size, tray),
    ]  # fmt: skip


def walk_in_shower(size: Vector) -> list[Part]:
    """A flat tray open at the front beside one glass screen, with a drain and a shelf."""
    x, y, z = spans(size)
    tray = min(0.05, 0.05 * size[2])
    pane = min(0.012, 0.02 * size[0], 0.02 * size[1])
    return [
        box("tray", x, y, (0.0, tray), tints.STONE),
        cylinder("drain", within(x, 0.44, 0.56), within(y, 0.44, 0.56), (tray, tray + 0.2 * tray),
                 tints.STEEL, sides=8),
        box("wall", within(x, 0.01, 0.99), (y[0], y[0] + pane), (tray, z[1]), tints.PAINT),
        box("screen", (x[0], x[0] + pane), within(y, 0.02, 0.98), (tray, z[1]), tints.GLASS),
        box("brace", (x[0] + pane, x[1] - 0.01 * size[0]), within(y, 0.9, 0.92),
            within(z, 0.97, 0.99), tints.STEEL),
        box("post", (x[1] - 2 * pane, x[1]), within(y, 0.89, 0.93), (tray, z[1]), tints.STEEL),
        box("shelf", within(x, 0.7, 0.96), (y[0] + pane, y[0] + 0.14 * size[1]),
            within(z, 0.5, 0.51), tints.GLASS),
        *_shower_head(size, tray),
    ]  # fmt: skip


def framed_mirror(size: Vector) -> list[Part]:
    """A pane in a wooden frame, leaning on a strut if its box is deep enough."""
    x, y, z = spans(size)
    edge = min(0.06, 0.12 * size[0], 0.12 * size[2])
    if size[1] > 0.2 * size[2]:
        return standing_mirror(size)
    return [
        *frame(x, y, z, edge, tints.BRASS),
        box("pane", inset(x, edge), within(y, 0, 0.6), inset(z, edge), tints.GLASS),
    ]


def round_mirror(size: Vector) -> list[Part]:
    """A round or oval pane in a rim."""
    x, y, z = spans(size)
    if size[1] > 0.2 * size[2]:
        return standing_mirror(size)
    edge = min(0.04, 0.08 * size[0], 0.08 * size[2])
    return [
        cylinder("rim", x, within(y, 0, 0.8), z, tints.DARK_WOOD, axis="y", sides=14),
        cylinder("pane", inset(x, edge), within(y, 0.7, 1), inset(z, edge), tints.GLASS, axis="y",
                 sides=14),
    ]  # fmt: skip


def standing_mirror(size: Vector) -> list[Part]:
    """A tall pane that leans in a frame between two feet."""
    x, y, z = spans(size)
    post = min(0.04, 0.1 * size[0], 0.1 * size[2])
    lean_low, lean_high = within(y, 0.56, 0.7), within(y, 0.3, 0.44)
    inner = inset(x, 1.2 * post)
    parts = [
        block("frame", (inner, lean_low), (inner, lean_high), (0.06 * size[2], z[1]), tints.WOOD),
        block("pane", (inset(inner, post), within(y, 0.66, 0.74)), (inset(inner, post),
              within(y, 0.43, 0.49)), within(z, 0.12, 0.95), tints.GLASS),
    ]  # fmt: skip
    for side, span in (("left", (x[0], x[0] + post)), ("right", (x[1] - post, x[1]))):
        parts += [
            box(f"foot-{side}", span, y, (0.0, min(post, 0.05 * size[2])), tints.WOOD),
            box(f"post-{side}", span, within(y, 0.44, 0.56), (min(post, 0.05 * size[2]),
                0.62 * size[2]), tints.WOOD),
        ]  # fmt: skip
    return parts
