"""FiLM over extremes of feature maps against feature maps modulated one by one."""

from __future__ import annotations

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch.nn import functional
from view_samples import assert_same_gradients, dense_maps, sample_panoramas, sample_views

from lcrl_bench.networks.film_encoder import FilmEncoder
from lcrl_bench.networks.fusion import combine_views
from lcrl_bench.networks.patches import build_patch_index

laws = settings(derandomize=True, deadline=None, max_examples=8)


def make(seed: int) -> FilmEncoder:
    """With gammas of both signs, as training may bring about."""
    encoder = FilmEncoder(61, generator=torch.Generator().manual_seed(seed))
    with torch.no_grad():
        encoder.gamma.weight.mul_(6.0)
    return encoder.double()


def dense(
    encoder: FilmEncoder, views: torch.Tensor, panoramas: torch.Tensor, commands: torch.Tensor
) -> torch.Tensor:
    """Every cell of every map of every panorama's views: float [command, panorama, view, size]."""
    c = encoder.convolutions
    maps = dense_maps(views, (c.first_weight, c.first_bias), (c.second_weight, c.second_bias))
    gamma = 1 + encoder.gamma(commands)[:, None, :, None, None]
    beta = encoder.beta(commands)[:, None, :, None, None]
    return functional.relu(gamma * maps + beta).amax((3, 4))[:, panoramas]


@laws
@given(st.integers(0, 10_000))
def test_modulated_extremes_are_the_maxima_of_the_modulated_maps(seed):
    views, panoramas = sample_views(seed), sample_panoramas(seed)
    encoder = make(seed)
    commands = torch.randn(3, 32, generator=torch.Generator().manual_seed(seed)).double()
    commands.requires_grad_(True)
    gamma = 1 + encoder.gamma(commands)
    assert float(gamma.detach().min()) < 0 < float(gamma.detach().max())
    expected = dense(encoder, views, panoramas, commands)
    extremes = encoder(build_patch_index(views, panoramas, classes=61))
    found = encoder.modulate(extremes.expand(3, -1, -1), commands)
    torch.testing.assert_close(found, expected, rtol=1e-9, atol=1e-10)
    parameters = dict(encoder.named_parameters()) | {"commands": commands}
    assert_same_gradients(found, expected, parameters)


def test_without_modulation_it_is_the_pooling_encoder():
    views, panoramas = sample_views(1), sample_panoramas(1)
    encoder = make(1)
    with torch.no_grad():
        for layer in (encoder.gamma, encoder.beta):
            layer.weight.zero_()
            layer.bias.zero_()
    index = build_patch_index(views, panoramas, classes=61)
    modulated = encoder.modulate(encoder(index)[None], torch.ones(1, 32).double())
    plain = encoder.convolutions(index)
    torch.testing.assert_close(combine_views("sum", modulated)[0], plain)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_negative_gamma_looks_for_the_smallest_cell(sign):
    views, panoramas = sample_views(2), sample_panoramas(2)
    encoder = make(2)
    with torch.no_grad():
        encoder.gamma.weight.zero_()
        encoder.gamma.bias.fill_(sign - 1.0)
        encoder.beta.weight.zero_()
        encoder.beta.bias.fill_(100.0)
    c = encoder.convolutions
    maps = dense_maps(views, (c.first_weight, c.first_bias), (c.second_weight, c.second_bias))
    best = maps.amax((2, 3)) if sign > 0 else -maps.amin((2, 3))
    extremes = encoder(build_patch_index(views, panoramas, classes=61))
    found = encoder.modulate(extremes[None], torch.ones(1, 32).double())
    torch.testing.assert_close(found[0], best[panoramas] + 100.0)
