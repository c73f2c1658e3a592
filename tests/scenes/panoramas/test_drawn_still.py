"""An object is drawn over the static meshes exactly where the driver would draw it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.camera import FAR, NEAR
from lcrl_bench.scenes.panoramas.drawn_still import DrawnStill

SHAPE = (2, 3)
CUP, WALL = 5, 1


def colors(shown: int, meshes: list[int]) -> NDArray[np.uint8]:
    """[pixel, 3], as OpenGL draws a class and the number of a mesh, 0 where nothing is drawn."""
    return np.array([[shown if m else 0, m % 256, m // 256] for m in meshes], np.uint8)


def still(nearness: list[float], meshes: list[int]) -> DrawnStill:
    """Two panoramas of six pixels, both the same."""
    one, seen = np.array(nearness, np.float32), colors(WALL, meshes)
    return DrawnStill.of(np.stack([seen, seen]), np.stack([one, one]))


def test_the_nearer_mesh_is_seen_and_of_equally_near_ones_the_last():
    behind = still([0.5, 0.5, 0.5, 0.5, 0.5, 0], [300, 300, 300, 300, 300, 0])
    drawn = colors(CUP, [7, 7, 301, 299, 0, 7]).reshape(*SHAPE, 3)
    nearness = np.array([0.6, 0.4, 0.5, 0.5, 0, 0.1], np.float32).reshape(SHAPE)
    found = behind.in_front(6, drawn, nearness)
    assert found.pixels.tolist() == [6, 8, 11]
    assert found.classes.tolist() == [CUP] * 3
    assert np.argsort(found.depths).tolist() == [0, 1, 2], "smaller if nearer"


def test_depths_are_metres_from_the_near_plane_or_a_little_more():
    metres = np.array([0.0, 0.1, 1.0, 5.0, 50.0, FAR - NEAR])
    nearness = NEAR * (FAR - NEAR - metres) / ((metres + NEAR) * (FAR - NEAR))
    found = still(nearness.tolist(), [1] * 6).depths[0]
    assert (found >= metres * (1 - 1e-6)).all()
    np.testing.assert_allclose(found, metres, rtol=0.01, atol=1e-6)
    assert still([0.0] * 6, [0] * 6).depths.max() > FAR - NEAR
