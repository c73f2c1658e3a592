"""Boxes, cylinders, lathes, extrusions and lofts: the primitives of all shapes.

A primitive is a template that fills the unit box, built once by trimesh and cached, and then
placed: stretched along x, y and z to fill the given spans. While a shape is being built, its
frame has x and y centred on the object and z = 0 at its underside.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from shapely.geometry import Polygon

from lcrl_bench.houses.house import Point, Vector

Span = tuple[float, float]
"""(from, to) in metres, ascending."""
Tint = tuple[float, float, float]
"""RGB, each 0..1."""

_AXES = {"x": (2, 0, 1), "y": (1, 2, 0), "z": (0, 1, 2)}
# The corners of a box are numbered x + 2 y + 4 z.
_BOX_FACES = np.array(
    [
        (0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
        (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5),
    ],
    np.int32,
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Part:
    """One mesh of an object, in the object's own frame."""

    name: str
    """Unique in its object: `"seat"`, `"leg-1"`."""
    vertices: NDArray[np.float64]
    """[vertex, 3] metres."""
    faces: NDArray[np.int32]
    """[triangle, 3] vertex indices, counter-clockwise seen from outside; watertight."""
    convex: bool
    """Whether it can be used as is for collisions."""
    tint: Tint
    """Default colour."""
    hollow: str = ""
    """Name in `hollows` of the template it was placed from; empty if it is convex."""


class Template(NamedTuple):
    """A mesh that fills the unit box."""

    vertices: NDArray[np.float64]
    """[vertex, 3], 0..1."""
    faces: NDArray[np.int32]
    """[triangle, 3] vertex indices."""


def normalised(mesh: trimesh.Trimesh) -> Template:
    """The template of `mesh`: moved and stretched to fill the unit box, faces outward."""
    vertices = np.asarray(mesh.vertices, np.float64)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    faces = np.asarray(mesh.faces, np.int32)
    if mesh.volume < 0:
        faces = faces[:, ::-1]
    return Template((vertices - low) / (high - low), np.ascontiguousarray(faces))


def turned(template: Template, axis: str) -> Template:
    """`template` with its z axis rotated onto `axis` ("x", "y" or "z")."""
    return Template(template.vertices[:, _AXES[axis]], template.faces)


def place(
    template: Template, name: str, x: Span, y: Span, z: Span, tint: Tint, *, hollow: str = ""
) -> Part:
    """`template` stretched to fill the box of three spans; convex unless it is a `hollow`."""
    low, high = np.array([x[0], y[0], z[0]]), np.array([x[1], y[1], z[1]])
    vertices = low + template.vertices * (high - low)
    return Part(name, vertices, template.faces, not hollow, tint, hollow)


def box(name: str, x: Span, y: Span, z: Span, tint: Tint) -> Part:
    """A box: 12 triangles."""
    return block(name, (x, y), (x, y), z, tint)


def block(
    name: str, bottom: tuple[Span, Span], top: tuple[Span, Span], z: Span, tint: Tint
) -> Part:
    """The hull of two level rectangles, each an x span and a y span: a tapered or leaning box."""
    corners = [
        (xs[i], ys[j], height)
        for (xs, ys), height in ((bottom, z[0]), (top, z[1]))
        for j in (0, 1)
        for i in (0, 1)
    ]
    return Part(name, np.array(corners, np.float64), _BOX_FACES, True, tint)


def cylinder(
    name: str, x: Span, y: Span, z: Span, tint: Tint, *, axis: str = "z", sides: int = 8
) -> Part:
    """A vertical or horizontal cylinder that touches all sides of its box."""
    return place(_lathe(((1.0, 0.0), (1.0, 1.0)), axis, sides), name, x, y, z, tint)


def lathe(
    name: str,
    x: Span,
    y: Span,
    z: Span,
    tint: Tint,
    *,
    profile: tuple[Point, ...],
    axis: str = "z",
    sides: int = 8,
) -> Part:
    """A convex solid of revolution; `profile` lists (radius, height) upwards, closed by caps."""
    return place(_lathe(profile, axis, sides), name, x, y, z, tint)


@lru_cache(maxsize=512)
def _lathe(profile: tuple[Point, ...], axis: str, sides: int) -> Template:
    # A loft has no vertices in the middle of its caps: fewer triangles than a revolved line.
    turn = 0.5 if sides == 4 else 0.0
    rings = [ring(sides, 1.0, (radius, radius), height, turn=turn) for radius, height in profile]
    return turned(loft(np.stack(rings)), axis)


def extrusion(
    name: str,
    x: Span,
    y: Span,
    z: Span,
    tint: Tint,
    *,
    outline: tuple[Point, ...],
    axis: str = "z",
) -> Part:
    """A convex outline extruded along `axis`.

    The outline's two coordinates are x and y for axis z, x and z for y, y and z for x.
    """
    return place(extruded(outline, axis), name, x, y, z, tint)


@lru_cache(maxsize=256)
def extruded(outline: tuple[Point, ...], axis: str) -> Template:
    """The template of a polygon extruded along `axis`; see `extrusion` for its coordinates."""
    corners = [(v, u) for u, v in outline] if axis == "y" else list(outline)
    mesh = trimesh.creation.extrude_polygon(Polygon(corners), 1.0)
    return turned(normalised(mesh), axis)


def ball(name: str, x: Span, y: Span, z: Span, tint: Tint, *, fineness: int = 1) -> Part:
    """An ellipsoid of 8, 20 or 80 triangles: `fineness` 0, 1 or 2."""
    return place(_ball(fineness), name, x, y, z, tint)


@lru_cache(maxsize=4)
def _ball(fineness: int) -> Template:
    if fineness == 0:
        corners = np.concatenate([np.eye(3), -np.eye(3)])
        return normalised(trimesh.Trimesh(corners).convex_hull)
    return normalised(trimesh.creation.icosphere(subdivisions=fineness - 1))


def bar(name: str, start: Vector, end: Vector, thickness: float, tint: Tint) -> Part:
    """A square bar from `start` to `end` in any direction."""
    along = np.subtract(end, start)
    length = float(np.linalg.norm(along))
    along = along / length
    # A horizontal bar keeps its upper side horizontal.
    aside = np.cross(along, (0.0, 0.0, 1.0))
    if np.linalg.norm(aside) < 1e-6:
        aside = np.array([1.0, 0.0, 0.0])
    aside = aside / np.linalg.norm(aside)
    axes = np.stack([aside, along, np.cross(aside, along)])
    half = thickness / 2
    unit = block(
        name, ((-half, half), (0, length)), ((-half, half), (0, length)), (-half, half), tint
    )
    return replace(unit, vertices=unit.vertices @ axes + np.array(start))


def leaf(name: str, start: Vector, end: Vector, width: float, thickness: float, tint: Tint) -> Part:
    """A pointed blade from `start` to `end`: an octahedron of 8 triangles."""
    middle = (np.array(start) + np.array(end)) / 2
    along = np.subtract(end, start)
    along = along / np.linalg.norm(along)
    aside = np.cross(along, (0.0, 0.0, 1.0))
    if np.linalg.norm(aside) < 1e-6:
        aside = np.array([1.0, 0.0, 0.0])
    aside = aside / np.linalg.norm(aside)
    over = np.cross(aside, along)
    sides = [aside * width, over * thickness, -aside * width, -over * thickness]
    vertices = np.array([start, end, *(middle + side / 2 for side in sides)], np.float64)
    faces = [[0, 2 + k, 2 + (k + 1) % 4] for k in range(4)]
    faces += [[1, 2 + (k + 1) % 4, 2 + k] for k in range(4)]
    part = Part(name, vertices, np.array(faces, np.int32), True, tint)
    a, b, c = vertices[faces[0]]
    outward = np.dot(np.cross(b - a, c - a), a + b + c - 3 * middle) > 0
    return part if outward else replace(part, faces=np.ascontiguousarray(part.faces[:, ::-1]))


def loft(rings: NDArray[np.float64], *, closed: bool = False) -> Template:
    """A skin over rings of equal size, each a counter-clockwise loop seen from above.

    Args:
        rings: [ring, point, 3], from the lower outside upwards and, for a hollow, down inside.
        closed: Whether the last ring joins the first (a ring-shaped solid); otherwise the first
            and the last ring are filled.
    """
    count, points = rings.shape[:2]
    index = np.arange(count * points).reshape(count, points)
    lower = index if closed else index[:-1]
    upper = np.roll(index, -1, axis=0) if closed else index[1:]
    a, b = lower, np.roll(lower, -1, axis=1)
    c, d = np.roll(upper, -1, axis=1), upper
    faces = [np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
    if not closed:
        fan = np.arange(1, points - 1)
        faces.append(np.stack([np.zeros_like(fan), fan + 1, fan], axis=-1))
        faces.append(np.stack([np.zeros_like(fan), fan, fan + 1], axis=-1) + index[-1, 0])
    mesh = trimesh.Trimesh(rings.reshape(-1, 3), np.concatenate(faces), process=False)
    return normalised(mesh)


def ring(
    points: int, roundness: float, half: Point, z: float, *, turn: float = 0.5
) -> NDArray[np.float64]:
    """[point, 3]: a superellipse loop; `roundness` 1 is an ellipse, near 0 a rectangle.

    `turn`: offset of the first point from the x axis, in steps between points.
    """
    angle = (np.arange(points) + turn) * 2 * np.pi / points
    cos, sin = np.cos(angle), np.sin(angle)
    x = np.sign(cos) * np.abs(cos) ** roundness * half[0]
    y = np.sign(sin) * np.abs(sin) ** roundness * half[1]
    return np.stack([x, y, np.full(points, z)], axis=1)
