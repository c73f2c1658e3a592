"""Kitchen cabinets and counters."""

from __future__ import annotations

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import (
    carcass,
    count_of,
    frame,
    front_planes,
    fronts,
    handles,
    inset,
    renamed,
    spans,
    within,
)
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Tint,
    box,
)


def _kitchen_unit(
    size: Vector, tint: Tint, top: Tint, *, each: float, rows: tuple[float, ...], upright: bool
) -> list[Part]:
    """A worktop over a row of units with a recessed plinth; `rows` are counted from the bottom."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, plinth = min(0.04, 0.1 * size[2]), min(0.1, 0.15 * size[2])
    # Counters can be metres deep (an island): the fronts stay at +y.
    columns = count_of(size[0], each, 4)
    units = fronts(inset(x, 0.01 * size[0]), (plinth, z[1] - board), (body, face), columns, rows,
                   tint, name="front")  # fmt: skip
    lower, upper = units[:columns], units[columns:]
    grips = handles(lower, (face, grip), tints.STEEL, upright=upright)
    if upper:
        grips += [renamed(part, "upper-") for part in handles(upper, (face, grip), tints.STEEL)]
    return [
        box("top", x, y, (z[1] - board, z[1]), top),
        carcass(inset(x, 0.005 * size[0]), (y[0], body), (plinth, z[1] - board), tint),
        box("plinth", inset(x, 0.01 * size[0]), (y[0], body - min(0.06, 0.1 * size[1])),
            (0.0, plinth), tints.IRON),
        *units,
        *grips,
    ]  # fmt: skip


def door_base_cabinet(size: Vector) -> list[Part]:
    """A kitchen base unit: doors under a row of drawers."""
    return _kitchen_unit(size, tints.PAINT, tints.WOOD, each=0.5, rows=(3, 1), upright=True)


def drawer_base_cabinet(size: Vector) -> list[Part]:
    """A kitchen base unit of wide drawers."""
    return _kitchen_unit(size, tints.FABRIC, tints.STONE, each=0.9, rows=(1.3, 1, 0.7),
                         upright=False)  # fmt: skip


def plain_base_cabinet(size: Vector) -> list[Part]:
    """A kitchen base unit with full-height doors."""
    return _kitchen_unit(size, tints.LIGHT_WOOD, tints.PAINT, each=0.5, rows=(1,), upright=True)


def door_countertop(size: Vector) -> list[Part]:
    """A counter: a stone worktop over cupboards with drawers."""
    return _kitchen_unit(size, tints.PAINT, tints.STONE, each=0.6, rows=(3, 1), upright=True)


def drawer_countertop(size: Vector) -> list[Part]:
    """A counter: a wooden worktop over drawers."""
    return _kitchen_unit(size, tints.PALE_GREEN, tints.WOOD, each=0.8, rows=(1.3, 1, 0.7),
                         upright=False)  # fmt: skip


def waterfall_countertop(size: Vector) -> list[Part]:
    """An island: a thick worktop that runs down both ends, with doors between."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board, end = min(0.06, 0.12 * size[2]), min(0.06, 0.1 * size[0])
    inner, plinth = inset(x, end), min(0.1, 0.15 * size[2])
    doors = fronts(inner, (plinth, z[1] - board), (body, face), count_of(size[0], 0.6, 4), 1,
                   tints.DARK_WOOD, name="door")  # fmt: skip
    return [
        box("top", x, y, (z[1] - board, z[1]), tints.CERAMIC),
        box("end-left", (x[0], x[0] + end), y, (0.0, z[1] - board), tints.CERAMIC),
        box("end-right", (x[1] - end, x[1]), y, (0.0, z[1] - board), tints.CERAMIC),
        carcass(inner, (y[0] + 0.05 * size[1], body), (plinth, z[1] - board), tints.DARK_WOOD),
        box("plinth", inner, (y[0] + 0.06 * size[1], body - min(0.06, 0.1 * size[1])),
            (0.0, plinth), tints.IRON),
        *doors,
        *handles(doors, (face, grip), tints.BRASS, upright=True),
    ]  # fmt: skip


def door_wall_cabinet(size: Vector) -> list[Part]:
    """A wall unit with doors."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    doors = fronts(inset(x, 0.005 * size[0]), inset(z, 0.005 * size[2]), (body, face),
                   count_of(size[0], 0.45, 4), 1, tints.PAINT, name="door")  # fmt: skip
    return [
        carcass(x, (y[0], body), z, tints.PAINT),
        *doors,
        *handles(doors, (face, grip), tints.STEEL, upright=True),
    ]


def glazed_wall_cabinet(size: Vector) -> list[Part]:
    """A wall unit with two glass doors in frames."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    bar = min(0.05, 0.1 * size[0], 0.15 * size[2])
    left, right = within(x, 0, 0.495), within(x, 0.505, 1)
    rise = inset(z, 0.01 * size[2])
    parts = [carcass(x, (y[0], body), z, tints.WOOD)]
    for side, span in (("left", left), ("right", right)):
        parts += frame(span, (body, face), rise, bar, tints.WOOD, name=f"door-{side}")
        parts.append(box(f"pane-{side}", inset(span, bar), (body, body + 0.4 * (face - body)),
                         inset(rise, bar), tints.GLASS))  # fmt: skip
    grips = [(left[1] - 0.7 * bar, left[1] - 0.3 * bar), (right[0] + 0.3 * bar,
                                                          right[0] + 0.7 * bar)]  # fmt: skip
    parts += [box(f"handle-{k + 1}", span, (face, grip), within(z, 0.15, 0.35), tints.IRON)
              for k, span in enumerate(grips)]  # fmt: skip
    return parts


def open_wall_cabinet(size: Vector) -> list[Part]:
    """A wall unit with a door beside open shelves."""
    x, y, z = spans(size)
    body, face, grip = front_planes(size)
    board = min(0.025, 0.05 * size[0], 0.05 * size[2])
    closed, opened = within(x, 0, 0.5), within(x, 0.5, 1)
    door = fronts(closed, z, (body, face), 1, 1, tints.LIGHT_WOOD, name="door")
    inner = (opened[0] + 0.01 * size[0], opened[1] - board)
    levels = [(low, low + board) for low in (0.0, 0.5 * (size[2] - board), size[2] - board)]
    return [
        box("case", closed, (y[0], body), z, tints.LIGHT_WOOD),
        *door,
        *handles(door, (face, grip), tints.STEEL, upright=True),
        box("back", inner, (y[0], y[0] + 0.06 * size[1]), inset(z, board), tints.LIGHT_WOOD),
        box("side", (opened[1] - board, opened[1]), (y[0], face), z, tints.LIGHT_WOOD),
        *[box(f"board-{k + 1}", inner, (y[0], body), level, tints.LIGHT_WOOD)
          for k, level in enumerate(levels)],
    ]  # fmt: skip
