"""The pixels a box may cover: all that a ray hits, and few others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.camera import NEAR, ray_directions
from lcrl_bench.scenes.panoramas.footprint import covered_pixels
from lcrl_bench.semantics import DEFAULT_SEMANTICS, Semantics

UPWARD = replace(DEFAULT_SEMANTICS, view_width=16, view_height=40, pitch=0.3)


def hit_depths(
    box: NDArray[np.float64], eyes: NDArray[np.float64], semantics: Semantics
) -> NDArray[np.float64]:
    """[eye, pixel]: depth at which each ray from the near plane enters the box; infinite if not."""
    rays = ray_directions(semantics).reshape(1, -1, 3)
    starts = eyes[:, None] + NEAR * rays
    with np.errstate(divide="ignore"):
        sides = np.sort((box[:, None, None] - starts) / rays, axis=0)
    enters, leaves = sides[0].max(axis=-1), sides[1].min(axis=-1)
    return np.where((enters <= leaves) & (leaves >= 0), enters.clip(0), np.inf)


def covered(box: NDArray, eyes: NDArray, depths: NDArray, semantics: Semantics) -> NDArray:
    pixels = covered_pixels(box, eyes, depths.astype(np.float32), semantics)
    assert (np.diff(pixels) > 0).all(), "in order, each once"
    found = np.zeros(depths.shape, bool)
    found.reshape(-1)[pixels] = True
    return found


@pytest.mark.parametrize("semantics", [DEFAULT_SEMANTICS, UPWARD], ids=["default", "upward"])
@pytest.mark.parametrize("seed", range(5))
def test_every_pixel_that_shows_the_box_is_among_them(seed: int, semantics: Semantics):
    rng = np.random.default_rng(seed)
    eyes = rng.uniform(-3, 3, (40, 3))
    for _ in range(10):
        low = rng.uniform(-3, 3, 3)
        box = np.stack([low, low + rng.uniform(0.01, 1.5, 3)])
        hits = hit_depths(box, eyes, semantics)
        walls = rng.uniform(0, 8, hits.shape)
        found = covered(box, eyes, walls, semantics)
        assert found[hits < walls].all()


def test_few_other_pixels_are_among_them():
    box, eyes = np.array([[-0.2, 2.0, -0.2], [0.2, 2.4, 0.2]]), np.zeros((1, 3))
    hits = hit_depths(box, eyes, DEFAULT_SEMANTICS)
    found = covered(box, eyes, np.full(hits.shape, 100.0), DEFAULT_SEMANTICS)
    assert 0 < np.isfinite(hits).sum() <= found.sum() < 150
    behind = covered(box, eyes, np.full(hits.shape, 1.0), DEFAULT_SEMANTICS)
    assert not behind.any(), "a wall in front hides the box"
