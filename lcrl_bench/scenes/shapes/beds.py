"""Beds and pillows."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import trimesh

from lcrl_bench.houses.house import Vector
from lcrl_bench.houses.receptacles import face_shares
from lcrl_bench.scenes.shapes import tints
from lcrl_bench.scenes.shapes.pieces import inset, legs, spans, within
from lcrl_bench.scenes.shapes.primitives import (
    Part,
    Span,
    Template,
    Tint,
    box,
    cylinder,
    extrusion,
    lathe,
    normalised,
    place,
    ring,
)

# A square with its corners cut.
_CLIPPED = (
    (0.08, 0.0), (0.92, 0.0), (1.0, 0.08), (1.0, 0.92),
    (0.92, 1.0), (0.08, 1.0), (0.0, 0.92), (0.0, 0.08),
)  # fmt: skip


def _bedding(x: Span, y: Span, bottom: float, top: float, tint: Tint) -> list[Part]:
    """A mattress with a duvet over all but the head end; both end at height `top`."""
    # The duvet lies 4 mm over the mattress, less than what counts as a step.
    cover = min(0.004, 0.1 * (top - bottom))
    length = y[1] - y[0]
    start = y[0] + 0.28 * length
    hang = min(0.03, 0.02 * (x[1] - x[0]), 0.02 * length)
    return [
        box("mattress", inset(x, hang), (y[0], y[1] - hang), (bottom, top - cover), tints.LINEN),
        box("duvet", x, (start, y[1]), (bottom + 0.35 * (top - bottom), top), tint),
        box("fold", inset(x, 0.3 * hang), (start - 0.08 * length, start),
            (bottom + 0.45 * (top - bottom), top - 0.3 * cover), tints.PAINT),
    ]  # fmt: skip


def platform_bed(size: Vector) -> list[Part]:
    """A wooden frame on feet with a headboard."""
    x, y, z = spans(size)
    top = face_shares("bed")[0] * size[2]
    head, foot = min(0.08, 0.05 * size[1]), 0.28 * top
    rail = 0.6 * top
    return [
        box("headboard", x, (y[0], y[0] + head), (0.1 * top, z[1]), tints.WOOD),
        box("frame", inset(x, 0.005 * size[0]), (y[0] + head, y[1]), (foot, rail), tints.WOOD),
        *_bedding(inset(x, 0.015 * size[0]), (y[0] + head, y[1] - 0.01 * size[1]), rail, top,
                  tints.FABRIC),
        *legs(inset(x, 0.04 * size[0]), inset(y, 0.01 * size[1]), (0.0, foot),
              min(0.08, 0.1 * size[0], 0.05 * size[1]), tints.WOOD, taper=0.7),
    ]  # fmt: skip


def posted_bed(size: Vector) -> list[Part]:
    """A frame between posts, with a slatted headboard and a low footboard."""
    x, y, z = spans(size)
    top = face_shares("bed")[0] * size[2]
    post = min(0.08, 0.06 * size[0], 0.045 * size[1])
    inner, rail = inset(x, 0.3 * post), 0.6 * top
    rear, front = (y[0], y[0] + post), (y[1] - post, y[1])
    ends = (("left", (x[0], x[0] + post)), ("right", (x[1] - post, x[1])))
    between = inset(x, post)
    low = min(top + 0.1 * (z[1] - top), 0.97 * z[1])
    return [
        *[box(f"head-post-{side}", span, rear, (0.0, z[1]), tints.DARK_WOOD)
          for side, span in ends],
        *[box(f"foot-post-{side}", span, front, (0.0, low), tints.DARK_WOOD)
          for side, span in ends],
        box("headboard", between, inset(rear, 0.25 * post), (rail, top + 0.55 * (z[1] - top)),
            tints.WOOD),
        box("head-rail", between, inset(rear, 0.15 * post), within((top, z[1]), 0.7, 0.92),
            tints.DARK_WOOD),
        box("footboard", between, inset(front, 0.25 * post), (0.35 * top, 0.98 * top), tints.WOOD),
        box("frame", inner, (y[0] + post, y[1] - post), (0.35 * top, rail), tints.DARK_WOOD),
        *_bedding(inset(x, 0.5 * post), (y[0] + post, y[1] - post), rail, top, tints.WARM_FABRIC),
    ]  # fmt: skip


def box_bed(size: Vector) -> list[Part]:
    """An upholstered box with a padded headboard of three panels."""
    x, y, z = spans(size)
    top = face_shares("bed")[0] * size[2]
    head, rail = min(0.1, 0.05 * size[1]), 0.55 * top
    panels = [within(x, k / 3 + 0.004, (k + 1) / 3 - 0.004) for k in range(3)]
    return [
        box("box", x, (y[0] + 0.02 * size[1], y[1]), (0.12 * top, rail), tints.PALE_FABRIC),
        box("plinth", inset(x, 0.05 * size[0]), inset(y, 0.05 * size[1]), (0.0, 0.12 * top),
            tints.IRON),
        box("headboard", inset(x, 0.01 * size[0]), (y[0], y[0] + 0.6 * head), (0.12 * top,
            z[1] - 0.01 * size[2]), tints.PALE_FABRIC),
        *[box(f"pad-{k + 1}", span, (y[0] + 0.01 * head, y[0] + head), (rail, z[1]),
              tints.PALE_FABRIC) for k, span in enumerate(panels)],
        *_bedding(inset(x, 0.01 * size[0]), (y[0] + head, y[1] - 0.01 * size[1]), rail, top,
                  tints.BLUE),
    ]  # fmt: skip


@lru_cache(maxsize=4)
def _cushion(roundness: float) -> Template:
    """A plump cushion: the hull of superellipses that shrink towards its two faces."""
    levels = [(0.55, 0.0), (0.88, 0.22), (1.0, 0.5), (0.88, 0.78), (0.55, 1.0)]
    points = np.concatenate([ring(8, roundness, (half, half), z) for half, z in levels])
    return normalised(trimesh.Trimesh(points).convex_hull)


def square_pillow(size: Vector) -> list[Part]:
    """A plump rectangular pillow with a piped seam."""
    x, y, z = spans(size)
    return [
        place(_cushion(0.35), "pillow", within(x, 0.01, 0.99), within(y, 0.01, 0.99), z,
              tints.LINEN),
        extrusion("seam", x, y, within(z, 0.46, 0.54), tints.PALE_FABRIC, outline=_CLIPPED),
    ]  # fmt: skip


def round_pillow(size: Vector) -> list[Part]:
    """A round or oval cushion with a button in the middle of its upper face."""
    x, y, z = spans(size)
    return [
        place(_cushion(0.9), "pillow", x, y, within(z, 0, 0.98), tints.FABRIC),
        cylinder("button", within(x, 0.45, 0.55), within(y, 0.45, 0.55), within(z, 0.9, 1),
                 tints.PALE_FABRIC, sides=6),
    ]  # fmt: skip


def bolster(size: Vector) -> list[Part]:
    """A roll with a button at each end, lying across."""
    x, y, z = spans(size)
    return [
        lathe("roll", within(x, 0.015, 0.985), y, z, tints.WARM_FABRIC, axis="x", sides=10,
              profile=((0.75, 0.0), (1.0, 0.08), (1.0, 0.92), (0.75, 1.0))),
        cylinder("button-left", within(x, 0, 0.02), within(y, 0.42, 0.58), within(z, 0.42, 0.58),
                 tints.PALE_FABRIC, axis="x", sides=6),
        cylinder("button-right", within(x, 0.98, 1), within(y, 0.42, 0.58), within(z, 0.42, 0.58),
                 tints.PALE_FABRIC, axis="x", sides=6),
    ]  # fmt: skip
