"""Scenes, standing points and renderers for the tests of panoramas."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from lcrl_bench.houses.house import House, Vector
from lcrl_bench.scenes.panoramas import describe_gl
from lcrl_bench.scenes.surface import Surface
from lcrl_bench.scenes.walkable import build_grid

ORIGIN = np.zeros((1, 2))
BACKENDS = ("rays", "gl")


def need_gl(backend: str = "gl") -> None:
    """Skip a test where the backend can't start."""
    if backend == "gl" and describe_gl().backend is None:
        pytest.skip(f"no OpenGL here: {describe_gl().error}")


def box(
    name: str, label: str, center: Vector, size: Vector, *, thing: str | None = None
) -> Surface:
    """A box as a surface."""
    mesh = trimesh.creation.box(extents=size)
    vertices = np.array(mesh.vertices) + center
    return Surface(name, label, vertices, np.array(mesh.faces, np.int32), "room", thing)


def standing_points(house: House, most: int = 40) -> NDArray[np.float64]:
    """Tiles spread over the grid of a house."""
    points = build_grid(house).points
    return points[:: max(1, len(points) // most)][:most]


def agreement(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> NDArray[np.float64]:
    """[panorama]: the share of equal pixels."""
    return (one == other).mean(axis=(1, 2, 3))
