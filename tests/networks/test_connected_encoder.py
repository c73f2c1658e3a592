"""The fully connected encoder over unique patches against plain dense layers."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch.nn import functional
from view_samples import assert_same_gradients, dense_maps, sample_panoramas, sample_views

from lcrl_bench.networks.connected_encoder import ConnectedEncoder
from lcrl_bench.networks.grounding import NetworkConfig, build_index
from lcrl_bench.networks.positions import build_position_index

laws = settings(derandomize=True, deadline=None, max_examples=8)


def make(seed: int, *, height: int = 24, width: int = 32) -> ConnectedEncoder:
    generator = torch.Generator().manual_seed(seed)
    return ConnectedEncoder(61, height=height, width=width, generator=generator)


def dense(encoder: ConnectedEncoder, views: torch.Tensor) -> torch.Tensor:
    """The layers as PyTorch offers them: float [view, size]."""
    c = encoder.convolutions
    maps = dense_maps(views, (c.first_weight, c.first_bias), (c.second_weight, c.second_bias))
    cells = functional.max_pool2d(functional.relu(maps), 2).flatten(1)
    return functional.linear(cells, encoder.weight, encoder.bias)


@laws
@given(st.integers(0, 10_000), st.sampled_from([(24, 32), (8, 12), (64, 64)]))
def test_unique_patches_give_what_dense_layers_give(seed, sides):
    height, width = sides
    views = sample_views(seed, count=4, height=height, width=width)
    encoder = make(seed, height=height, width=width).double()
    index = build_position_index(views, sample_panoramas(seed, views=4), classes=61)
    expected, found = dense(encoder, views), encoder(index)
    torch.testing.assert_close(found, expected, rtol=1e-9, atol=1e-10)
    assert_same_gradients(found, expected, dict(encoder.named_parameters()))


def test_single_precision_is_as_good_as_the_dense_layers():
    views = sample_views(3)
    encoder = make(3)
    index = build_position_index(views, sample_panoramas(3), classes=61)
    expected, found = dense(encoder, views), encoder(index)
    torch.testing.assert_close(found, expected, rtol=1e-5, atol=1e-5)
    parameters = dict(encoder.named_parameters())
    assert_same_gradients(found, expected, parameters, tolerance=1e-4)


def test_it_knows_left_from_right():
    views = torch.ones((2, 24, 32), dtype=torch.uint8)
    views[0, 8:16, 4:8] = 20
    views[1, 8:16, 20:24] = 20
    index = build_position_index(views, torch.tensor([[0, 0, 0, 0]]), classes=61)
    left, right = make(4)(index)
    assert float((left - right).detach().abs().max()) > 1e-4


def test_the_same_bits_come_out_twice():
    views, panoramas = sample_views(5, count=30), sample_panoramas(5, views=30)
    encoder = make(5)
    index = build_position_index(views, panoramas, classes=61)
    runs = []
    for _ in range(2):
        output = encoder(index)
        gradients = torch.autograd.grad(output.square().sum(), list(encoder.parameters()))
        runs.append((output, *gradients))
    assert all(torch.equal(a, b) for a, b in zip(*runs, strict=True))


def test_repeated_patches_are_found_once():
    views, panoramas = sample_views(6, count=20), sample_panoramas(6)
    twice = build_position_index(torch.cat([views, views]), panoramas, classes=61)
    once = build_position_index(views, panoramas, classes=61)
    assert twice.groups.index.shape == once.groups.index.shape
    assert len(twice.places.index) == 2 * len(once.places.index)


def test_sides_that_two_pools_do_not_divide_are_refused():
    views = torch.zeros((1, 22, 32), dtype=torch.uint8)
    with pytest.raises(ValueError, match="multiples of 4, found 22 x 32"):
        build_position_index(views, torch.zeros(1, 4, dtype=torch.int64), classes=61)


def test_a_class_that_does_not_exist_is_refused():
    views = torch.full((1, 24, 32), 61, dtype=torch.uint8)
    with pytest.raises(ValueError, match="views hold class 61, but there are 61 classes"):
        build_position_index(views, torch.zeros(1, 4, dtype=torch.int64), classes=61)


def test_views_of_another_size_than_the_network_are_refused():
    views = sample_views(0, height=64, width=64)
    with pytest.raises(ValueError, match="views of 24 x 32, found views of 64 x 64"):
        build_index(views, sample_panoramas(0), NetworkConfig(image="fc"))
