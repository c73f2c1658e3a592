"""Refrigerators, stoves, dishwashers, microwaves and washing machines."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import (
    disc,
    inset,
    spans,
    split,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Tint,
    block,
    box,
    cylinder,
)


def two_door_refrigerator(size: Vector) -> list[Part]:
    """A freezer door above a larger door, with upright handles."""
    x, y, z = spans(size)
    foot = min(0.05, 0.04 * size[2])
    edge = inset(x, 0.003 * size[0])
    low, high = within(z, 0.04, 0.68), within(z, 0.69, 0.997)
    door, grip = within(y, 0.86, 0.95), within(y, 0.95, 1)
    return [
        box("body", x, within(y, 0, 0.86), (foot, z[1]), tints.STEEL),
        box("foot", within(x, 0.05, 0.95), within(y, 0.05, 0.8), (0.0, foot), tints.IRON),
        box("door", edge, door, low, tints.STEEL),
        box("freezer-door", edge, door, high, tints.STEEL),
        box("handle", within(x, 0.06, 0.1), grip, within(z, 0.4, 0.65), tints.IRON),
        box("freezer-handle", within(x, 0.06, 0.1), grip, within(z, 0.72, 0.84), tints.IRON),
    ]


def french_refrigerator(size: Vector) -> list[Part]:
    """Two doors side by side over a freezer drawer, with a water dispenser."""
    x, y, z = spans(size)
    foot = min(0.05, 0.04 * size[2])
    door, grip = within(y, 0.86, 0.95), within(y, 0.95, 1)
    high, low = within(z, 0.38, 0.997), within(z, 0.04, 0.37)
    return [
        box("body", x, within(y, 0, 0.86), (foot, z[1]), tints.IRON),
        box("foot", within(x, 0.05, 0.95), within(y, 0.05, 0.8), (0.0, foot), tints.IRON),
        box("door-left", within(x, 0.004, 0.496), door, high, tints.STEEL),
        box("door-right", within(x, 0.504, 0.996), door, high, tints.STEEL),
        box("drawer", within(x, 0.004, 0.996), door, low, tints.STEEL),
        box("handle-left", within(x, 0.43, 0.465), grip, within(z, 0.48, 0.86), tints.IRON),
        box("handle-right", within(x, 0.535, 0.57), grip, within(z, 0.48, 0.86), tints.IRON),
        box("drawer-handle", within(x, 0.2, 0.8), grip, within(z, 0.31, 0.33), tints.IRON),
        box("dispenser", within(x, 0.12, 0.34), within(y, 0.94, 0.965), within(z, 0.55, 0.75),
            tints.DARK_GLASS),
    ]  # fmt: skip


def rounded_refrigerator(size: Vector) -> list[Part]:
    """One door, a rounded top and a big lever, on feet."""
    x, y, z = spans(size)
    foot = min(0.08, 0.05 * size[2])
    shoulder = 0.92 * size[2]
    door, rim = within(y, 0.8, 0.93), within(x, 0.12, 0.88)
    return [
        box("body", x, within(y, 0, 0.8), (foot, shoulder), tints.PALE_GREEN),
        block("crown", (x, within(y, 0, 0.8)), (rim, within(y, 0.05, 0.75)), (shoulder, z[1]),
              tints.PALE_GREEN),
        box("door", within(x, 0.01, 0.99), door, (foot * 1.1, shoulder), tints.PALE_GREEN),
        block("door-crown", (within(x, 0.01, 0.99), door), (rim, within(y, 0.78, 0.9)),
              (shoulder, 0.99 * z[1]), tints.PALE_GREEN),
        box("lever", within(x, 0.06, 0.24), within(y, 0.93, 1), within(z, 0.58, 0.61), tints.STEEL),
        box("badge", within(x, 0.4, 0.6), within(y, 0.93, 0.95), within(z, 0.8, 0.83),
            tints.STEEL),
        box("foot-left", within(x, 0.06, 0.16), within(y, 0.1, 0.75), (0.0, foot), tints.IRON),
        box("foot-right", within(x, 0.84, 0.94), within(y, 0.1, 0.75), (0.0, foot), tints.IRON),
    ]  # fmt: skip


def _oven(size: Vector, body: Tint, *, knobs: int) -> list[Part]:
    """Body, oven door with window and handle, drawer, and a panel of knobs under the top."""
    x, y, z = spans(size)
    hob = min(0.004, 0.05 * size[2])
    door, grip = within(y, 0.88, 0.94), within(y, 0.94, 1)
    dial = [within(x, (k + 0.5) / knobs - 0.4 / knobs, (k + 0.5) / knobs + 0.4 / knobs)
            for k in range(knobs)]  # fmt: skip
    return [
        box("body", x, within(y, 0, 0.88), (0.0, z[1] - hob), body),
        box("door", within(x, 0.02, 0.98), door, within(z, 0.2, 0.8), body),
        box("window", within(x, 0.15, 0.85), within(y, 0.93, 0.95), within(z, 0.3, 0.64),
            tints.DARK_GLASS),
        box("handle", within(x, 0.1, 0.9), grip, within(z, 0.71, 0.74), tints.STEEL),
        box("drawer", within(x, 0.02, 0.98), door, within(z, 0.02, 0.185), body),
        *[disc(f"knob-{k + 1}", span, within(z, 0.85, 0.93), within(y, 0.88, 0.96),
                 tints.IRON, sides=6) for k, span in enumerate(dial)],
    ]  # fmt: skip


def ring_stove(size: Vector) -> list[Part]:
    """A cooker with four round plates."""
    x, y, z = spans(size)
    hob = min(0.004, 0.05 * size[2])
    rise = (z[1] - hob, z[1])
    plates = [(0.27, 0.28, 0.34), (0.73, 0.28, 0.28), (0.27, 0.68, 0.28), (0.73, 0.68, 0.34)]
    return [
        *_oven(size, tints.PAINT, knobs=5),
        *[cylinder(f"plate-{k + 1}", within(x, u - r / 2, u + r / 2),
                   within(y, v - r / 2, v + r / 2), rise, tints.IRON, sides=8)
          for k, (u, v, r) in enumerate(plates)],
    ]  # fmt: skip


def glass_stove(size: Vector) -> list[Part]:
    """A cooker with a flat glass hob."""
    x, y, z = spans(size)
    hob = min(0.004, 0.05 * size[2])
    glass = box("hob", within(x, 0.03, 0.97), within(y, 0.04, 0.86), (z[1] - hob, z[1]),
                tints.DARK_GLASS)  # fmt: skip
    return [*_oven(size, tints.STEEL, knobs=4), glass]


def panel_dishwasher(size: Vector) -> list[Part]:
    """A control strip above a door with a bar handle, and a recessed plinth."""
    x, y, z = spans(size)
    door, grip = within(y, 0.9, 0.95), within(y, 0.95, 1)
    return [
        box("body", x, within(y, 0, 0.9), within(z, 0.1, 1), tints.PAINT),
        box("plinth", within(x, 0.02, 0.98), within(y, 0.03, 0.8), within(z, 0, 0.1), tints.IRON),
        box("door", within(x, 0.01, 0.99), door, within(z, 0.12, 0.84), tints.PAINT),
        box("strip", within(x, 0.01, 0.99), door, within(z, 0.86, 0.98), tints.IRON),
        box("handle", within(x, 0.15, 0.85), grip, within(z, 0.77, 0.8), tints.STEEL),
        box("display", within(x, 0.4, 0.6), within(y, 0.945, 0.96), within(z, 0.89, 0.95),
            tints.GLASS),
        *[box(f"button-{k + 1}", span, within(y, 0.945, 0.97), within(z, 0.9, 0.94), tints.STEEL)
          for k, span in enumerate(split(within(x, 0.68, 0.92), 3, 0.03 * size[0]))],
    ]  # fmt: skip


def steel_dishwasher(size: Vector) -> list[Part]:
    """A steel front with a grip recess at the top, on feet."""
    x, y, z = spans(size)
    return [
        box("body", x, within(y, 0, 0.9), within(z, 0.06, 1), tints.IRON),
        box("foot-left", within(x, 0.06, 0.14), within(y, 0.1, 0.8), within(z, 0, 0.06),
            tints.IRON),
        box("foot-right", within(x, 0.86, 0.94), within(y, 0.1, 0.8), within(z, 0, 0.06),
            tints.IRON),
        box("door", within(x, 0.01, 0.99), within(y, 0.9, 0.98), within(z, 0.08, 0.88),
            tints.STEEL),
        box("lip", within(x, 0.01, 0.99), within(y, 0.9, 1), within(z, 0.93, 0.99), tints.STEEL),
        box("light", within(x, 0.46, 0.54), within(y, 0.97, 0.99), within(z, 0.82, 0.84),
            tints.RED),
    ]  # fmt: skip


def button_microwave(size: Vector) -> list[Part]:
    """A door with a window and an upright handle beside a panel of buttons."""
    x, y, z = spans(size)
    door, grip = within(y, 0.88, 0.94), within(y, 0.94, 1)
    return [
        box("body", x, within(y, 0, 0.88), within(z, 0.04, 1), tints.STEEL),
        box("feet", within(x, 0.06, 0.94), within(y, 0.1, 0.8), within(z, 0, 0.05), tints.RUBBER),
        box("door", within(x, 0.02, 0.72), door, within(z, 0.08, 0.96), tints.STEEL),
        box("window", within(x, 0.09, 0.6), within(y, 0.93, 0.95), within(z, 0.2, 0.84),
            tints.DARK_GLASS),
        box("handle", within(x, 0.655, 0.69), grip, within(z, 0.18, 0.86), tints.IRON),
        box("panel", within(x, 0.74, 0.98), door, within(z, 0.08, 0.96), tints.IRON),
        box("display", within(x, 0.77, 0.95), within(y, 0.93, 0.955), within(z, 0.76, 0.9),
            tints.GREEN),
        *[box(f"buttons-{k + 1}", span, within(y, 0.93, 0.96), within(z, 0.16, 0.68), tints.STEEL)
          for k, span in enumerate(split(within(x, 0.77, 0.95), 3, 0.02 * size[0]))],
    ]  # fmt: skip


def dial_microwave(size: Vector) -> list[Part]:
    """A door with a window beside two dials."""
    x, y, z = spans(size)
    return [
        box("body", x, within(y, 0, 0.9), within(z, 0.04, 1), tints.PAINT),
        box("feet", within(x, 0.06, 0.94), within(y, 0.1, 0.8), within(z, 0, 0.05), tints.RUBBER),
        box("door", within(x, 0.02, 0.72), within(y, 0.9, 0.95), within(z, 0.08, 0.96),
            tints.PAINT),
        box("window", within(x, 0.08, 0.66), within(y, 0.94, 0.96), within(z, 0.2, 0.84),
            tints.DARK_GLASS),
        disc("dial-upper", within(x, 0.77, 0.95), within(z, 0.55, 0.88), within(y, 0.9, 1),
               tints.STEEL),
        disc("dial-lower", within(x, 0.77, 0.95), within(z, 0.14, 0.47), within(y, 0.9, 1),
               tints.STEEL),
    ]  # fmt: skip


def front_washing_machine(size: Vector) -> list[Part]:
    """A round glass door under a control strip with a dial and a soap drawer."""
    x, y, z = spans(size)
    hatch = within(x, 0.16, 0.84), within(z, 0.14, 0.74)
    return [
        box("body", x, within(y, 0, 0.9), within(z, 0.03, 1), tints.PAINT),
        box("feet", within(x, 0.06, 0.94), within(y, 0.1, 0.8), within(z, 0, 0.03), tints.RUBBER),
        disc("ring", *hatch, within(y, 0.9, 0.96), tints.STEEL, sides=12),
        disc("glass", within(hatch[0], 0.14, 0.86), within(hatch[1], 0.14, 0.86),
               within(y, 0.93, 1), tints.DARK_GLASS, sides=12),
        box("strip", within(x, 0.02, 0.98), within(y, 0.9, 0.925), within(z, 0.83, 0.98),
            tints.STEEL),
        box("drawer", within(x, 0.05, 0.34), within(y, 0.92, 0.94), within(z, 0.85, 0.96),
            tints.PAINT),
        disc("dial", within(x, 0.44, 0.58), within(z, 0.85, 0.96), within(y, 0.92, 0.97),
               tints.IRON, sides=8),
        box("display", within(x, 0.66, 0.9), within(y, 0.92, 0.935), within(z, 0.87, 0.94),
            tints.DARK_GLASS),
    ]  # fmt: skip


def top_washing_machine(size: Vector) -> list[Part]:
    """A flat lid in the top, and controls along the front's upper edge."""
    x, y, z = spans(size)
    lid = min(0.004, 0.05 * size[2])
    return [
        box("body", x, within(y, 0, 0.96), (0.0, z[1] - lid), tints.PAINT),
        box("lid", within(x, 0.02, 0.98), within(y, 0.03, 0.95), (z[1] - lid, z[1]), tints.GLASS),
        box("front", within(x, 0.06, 0.94), within(y, 0.95, 0.975), within(z, 0.08, 0.78),
            tints.PAINT),
        box("strip", within(x, 0.02, 0.98), within(y, 0.95, 0.975), within(z, 0.85, 0.97),
            tints.IRON),
        *[disc(f"dial-{k + 1}", span, within(z, 0.86, 0.96), within(y, 0.97, 1), tints.STEEL,
                 sides=8) for k, span in enumerate(split(within(x, 0.1, 0.9), 3,
                                                         0.1 * size[0]))],
    ]  # fmt: skip
