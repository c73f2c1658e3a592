"""Common parts of furniture: legs, fronts with handles, panels in frames."""

from __future__ import annotations

from collections.abc import Sequence

from lcrl_bench.houses.house import Vector
from lcrl_bench.scenes.shapes.primitives import Part, Span, Tint, block, box, cylinder


def spans(size: Vector) -> tuple[Span, Span, Span]:
    """The x, y and z spans of a box of `size`: centred in plan, standing on z = 0."""
    width, depth, height = size
    return (-width / 2, width / 2), (-depth / 2, depth / 2), (0.0, height)


def inset(span: Span, by: float) -> Span:
    """`span` shortened at both ends by `by` metres (lengthened if negative)."""
    return span[0] + by, span[1] - by


def within(span: Span, start: float, end: float) -> Span:
    """The part of `span` between two fractions of it."""
    length = span[1] - span[0]
    return span[0] + start * length, span[0] + end * length


def about(center: float, thickness: float) -> Span:
    """The span of `thickness` metres centred on `center`."""
    return center - thickness / 2, center + thickness / 2


def split(span: Span, count: int, gap: float) -> list[Span]:
    """`span` cut into `count` equal spans with `gap` metres between them."""
    pitch = (span[1] - span[0] + gap) / count
    return [(span[0] + k * pitch, span[0] + (k + 1) * pitch - gap) for k in range(count)]


def count_of(length: float, each: float, most: int, *, least: int = 1) -> int:
    """How many pieces of about `each` metres fit into `length`: `least`..`most`."""
    return max(least, min(most, round(length / each)))


def legs(
    x: Span, y: Span, z: Span, thickness: float, tint: Tint, *, taper: float = 1.0, splay: float = 0
) -> list[Part]:
    """Four legs at the corners of a rectangle.

    `taper` is the foot's share of the leg's thickness; `splay` is how far the top is inset, in
    metres.
    """
    foot = thickness * taper
    parts = []
    for k, (i, j) in enumerate(((0, 0), (1, 0), (0, 1), (1, 1))):
        bottom = (_at_end(x, i, 0, foot), _at_end(y, j, 0, foot))
        top = (_at_end(x, i, splay, thickness), _at_end(y, j, splay, thickness))
        parts.append(block(f"leg-{k + 1}", bottom, top, z, tint))
    return parts


def _at_end(span: Span, end: int, inward: float, thickness: float) -> Span:
    if end == 0:
        return span[0] + inward, span[0] + inward + thickness
    return span[1] - inward - thickness, span[1] - inward


def fronts(
    x: Span,
    z: Span,
    y: Span,
    columns: int,
    rows: int | Sequence[float],
    tint: Tint,
    *,
    name: str = "front",
    gap: float = 0.012,
) -> list[Part]:
    """A grid of drawer or door fronts filling x and z, `y` deep.

    Args:
        x: Across.
        z: From bottom to top.
        y: From the carcass to the fronts' outer face.
        columns: Number of columns.
        rows: Number of rows, or their shares of the height from the bottom.
        tint: Their colour.
        name: Prefix of the parts' names, followed by their number.
        gap: Metres between fronts, at most a tenth of a front.
    """
    shares = [1.0] * rows if isinstance(rows, int) else list(rows)
    across = split(x, columns, min(gap, 0.1 * (x[1] - x[0]) / columns))
    parts, bottom = [], z[0]
    for share in shares:
        top = bottom + share / sum(shares) * (z[1] - z[0])
        margin = min(gap / 2, 0.05 * (top - bottom))
        parts += [(column, (bottom + margin, top - margin)) for column in across]
        bottom = top
    return [box(f"{name}-{k + 1}", column, y, row, tint) for k, (column, row) in enumerate(parts)]


def handles(doors: Sequence[Part], y: Span, tint: Tint, *, upright: bool = False) -> list[Part]:
    """A bar handle on every front: horizontal in its upper part, or upright at an inner edge."""
    parts = []
    for k, door in enumerate(doors):
        low, high = door.vertices.min(axis=0), door.vertices.max(axis=0)
        width, height = high[0] - low[0], high[2] - low[2]
        thick = min(0.02, 0.2 * width, 0.2 * height)
        if upright:
            # Two doors open from the middle of the pair.
            share = 0.1 if k % 2 else 0.9
            x = about(low[0] + share * width, thick)
            z = about((low[2] + high[2]) / 2, min(0.3, 0.4 * height))
        else:
            x = about((low[0] + high[0]) / 2, min(0.16, 0.4 * width))
            z = about(low[2] + 0.7 * height, thick)
        parts.append(box(f"handle-{k + 1}", (float(x[0]), float(x[1])), y, z, tint))
    return parts


def knobs(doors: Sequence[Part], y: Span, tint: Tint) -> list[Part]:
    """A round knob in the middle of every front."""
    parts = []
    for k, door in enumerate(doors):
        low, high = door.vertices.min(axis=0), door.vertices.max(axis=0)
        thick = min(0.035, 0.3 * float(high[0] - low[0]), 0.3 * float(high[2] - low[2]))
        x, z = (about(float(low[i] + high[i]) / 2, thick) for i in (0, 2))
        parts.append(cylinder(f"knob-{k + 1}", x, y, z, tint, axis="y", sides=6))
    return parts


def frame(
    x: Span, y: Span, z: Span, thickness: float, tint: Tint, *, name: str = "frame"
) -> list[Part]:
    """An upright picture-frame of four boards, `thickness` metres wide, filling the box."""
    left, right = (x[0], x[0] + thickness), (x[1] - thickness, x[1])
    bottom, top = (z[0], z[0] + thickness), (z[1] - thickness, z[1])
    between = inset(x, thickness)
    return [
        box(f"{name}-left", left, y, z, tint),
        box(f"{name}-right", right, y, z, tint),
        box(f"{name}-bottom", between, y, bottom, tint),
        box(f"{name}-top", between, y, top, tint),
    ]


def disc(name: str, x: Span, z: Span, y: Span, tint: Tint, *, sides: int = 10) -> Part:
    """A disc on the front: the largest that fits the x and z spans."""
    across = min(x[1] - x[0], z[1] - z[0])
    return cylinder(name, about(sum(x) / 2, across), y, about(sum(z) / 2, across), tint, axis="y",
                    sides=sides)  # fmt: skip


def renamed(part: Part, prefix: str) -> Part:
    """`part` with `prefix` added to its name."""
    return Part(prefix + part.name, part.vertices, part.faces, part.convex, part.tint, part.hollow)


def front_planes(size: Vector) -> tuple[float, float, float]:
    """The y of the outer faces of the carcass, the fronts and the handles."""
    front, grip = min(0.02, 0.08 * size[1]), min(0.025, 0.08 * size[1])
    return size[1] / 2 - front - grip, size[1] / 2 - grip, size[1] / 2


def carcass(x: Span, y: Span, z: Span, tint: Tint) -> Part:
    """The body of a cupboard, behind its fronts."""
    return box("carcass", x, y, z, tint)
