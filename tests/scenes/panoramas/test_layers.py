"""Layers put together show what a depth buffer shows."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from lcrl_bench.scenes.panoramas.layers import Composition, Layer

PANORAMAS, PIXELS = 5, 12
STILL = 1


def layer(pixels: list[int], depths: list[float], shown: int) -> Layer:
    return Layer(
        np.array(pixels, np.int64),
        np.array(depths, np.float32),
        np.full(len(pixels), shown, np.uint8),
    )


def composition(layers: dict[str, Layer]) -> Composition:
    return Composition(np.full((PANORAMAS, PIXELS), STILL, np.uint8), layers)


def in_full(made: Composition, hidden: str, placed: Layer | None = None) -> NDArray[np.uint8]:
    """The class ids of every pixel, flat, after a change."""
    changed, views = made.change(hidden, placed)
    whole = made.found.copy()
    whole[changed] = views
    return whole.reshape(-1)


def drawn(still: NDArray, layers: list[Layer]) -> NDArray[np.uint8]:
    """A depth buffer: layers in order, each where it is nearer than what was drawn before."""
    depths, shown = still.copy(), np.full(len(still), STILL, np.uint8)
    for each in layers:
        for pixel, depth, number in zip(each.pixels, each.depths, each.classes, strict=True):
            if depth < depths[pixel]:
                depths[pixel], shown[pixel] = depth, number
    return shown


def random_layer(rng: np.random.Generator, still: NDArray, shown: int) -> Layer:
    """Pixels nearer than the still house, at one of few depths, so that some are equal."""
    depths = rng.integers(1, 4, len(still)).astype(np.float32)
    pixels = np.flatnonzero((rng.random(len(still)) < 0.5) & (depths < still))
    return Layer(pixels, depths[pixels], np.full(len(pixels), shown, np.uint8))


@pytest.mark.parametrize("seed", range(20))
def test_every_arrangement_shows_what_a_depth_buffer_shows(seed: int):
    rng = np.random.default_rng(seed)
    still = rng.integers(2, 6, PANORAMAS * PIXELS).astype(np.float32)
    layers = {f"thing-{k}": random_layer(rng, still, k + 2) for k in range(4)}
    made = composition(layers)
    np.testing.assert_array_equal(made.found.reshape(-1), drawn(still, list(layers.values())))
    for number, name in enumerate(layers):
        others = [each for other, each in layers.items() if other != name]
        np.testing.assert_array_equal(in_full(made, name), drawn(still, others))
        placed = random_layer(rng, still, number + 2)
        arranged = list({**layers, name: placed}.values())
        np.testing.assert_array_equal(in_full(made, name, placed), drawn(still, arranged))


def test_of_equal_depths_the_first_object_is_seen():
    made = composition({"cup": layer([3], [1], 2), "book": layer([3], [1], 4)})
    assert made.found.reshape(-1)[3] == 2
    assert in_full(made, "cup")[3] == 4
    assert in_full(made, "cup", layer([3], [1], 2))[3] == 2
    assert in_full(made, "book", layer([3], [1], 4))[3] == 2


def test_only_panoramas_that_show_the_object_change():
    made = composition({"cup": layer([3, 4, 2 * PIXELS], [1, 1, 1], 2)})
    changed, views = made.change("cup")
    assert changed.tolist() == [0, 2]
    assert (views == STILL).all()
    changed, _ = made.change("cup", layer([PIXELS], [1], 2))
    assert changed.tolist() == [0, 1, 2]


@pytest.mark.parametrize("hidden", [None, "nowhere"])
def test_hiding_nothing_changes_nothing(hidden: str | None):
    changed, views = composition({"cup": layer([3], [1], 2)}).change(hidden)
    assert (changed.shape, views.shape) == ((0,), (0, PIXELS))


def test_a_house_without_objects_has_no_layers():
    made = composition({})
    assert (made.found == STILL).all()
    assert in_full(made, "cup", layer([0], [1], 2)).tolist() == [2] + [STILL] * 59
