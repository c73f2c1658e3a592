"""Standardised class channels: the same network in other coordinates."""

from __future__ import annotations

import pytest
import torch
from torch.nn import functional
from torch.testing import assert_close
from view_samples import sample_panoramas, sample_views

from lcrl_bench.networks.grounding import Grounding, NetworkConfig, build_index
from lcrl_bench.networks.standardisation import RAREST, class_shares, fold_scale, standardise

CLASSES = 61


def network(image: str = "pooling") -> Grounding:
    config = NetworkConfig(image=image)  # type: ignore[arg-type]
    return Grounding(config, words=3, generator=torch.Generator().manual_seed(0))


def test_shares_count_pixels_and_weigh_houses_alike():
    small = torch.full((1, 2, 2), 7, dtype=torch.uint8)
    large = torch.zeros((9, 2, 2), dtype=torch.uint8)
    large[:, 0, 0] = 7
    shares = class_shares([small, large], classes=CLASSES)
    assert_close(shares[7], torch.tensor((1.0 + 0.25) / 2))
    assert_close(shares.sum(), torch.tensor(1.0))


def test_standardised_channels_have_unit_variance():
    views = sample_views(3, count=6)
    trained, scale = network(), None
    plain = trained.convolutions.first_weight.detach().clone()
    standardise(trained, [views])
    scale = (trained.convolutions.first_weight / plain)[0, :, 0, 0].detach()
    channels = functional.one_hot(views.long(), CLASSES).flatten(0, 2).float() * scale
    share = class_shares([views], classes=CLASSES)
    seen = (share > RAREST) & (share < 0.5)
    assert int(seen.sum()) > 10
    deviation = channels.std(0, unbiased=False)[seen]
    assert_close(deviation, torch.ones_like(deviation), rtol=1e-4, atol=0)


def test_a_class_that_is_never_seen_is_scaled_as_the_rarest():
    trained = network()
    plain = trained.convolutions.first_weight.detach().clone()
    standardise(trained, [torch.zeros((1, 24, 32), dtype=torch.uint8)])
    ratio = (trained.convolutions.first_weight / plain)[:, 9].detach()
    assert_close(ratio, torch.full_like(ratio, RAREST**-0.5), rtol=1e-4, atol=0)


@pytest.mark.parametrize("image", ["pooling", "film", "fc"])
def test_a_settled_network_sees_the_same_with_plain_weights(image):
    views, panoramas = sample_views(1), sample_panoramas(1)
    trained = network(image)
    names = set(trained.state_dict())
    before = trained.encode(build_index(views, panoramas, trained.config))
    standardise(trained, [views])
    during = trained.encode(build_index(views, panoramas, trained.config))
    fold_scale(trained)
    after = trained.encode(build_index(views, panoramas, trained.config))
    assert not torch.allclose(before, during)
    assert torch.equal(during, after)
    assert set(trained.state_dict()) == names


def test_settling_what_was_never_standardised_changes_nothing():
    trained = network()
    before = trained.convolutions.first_weight.detach().clone()
    fold_scale(trained)
    assert torch.equal(trained.convolutions.first_weight, before)


def test_a_step_moves_the_weight_of_a_rare_class_further():
    views, panoramas = sample_views(2, count=6), sample_panoramas(2, views=6)
    moved = []
    for scaled in (False, True):
        trained = network()
        if scaled:
            standardise(trained, [views])
        before = trained.convolutions.first_weight.detach().clone()
        optimizer = torch.optim.Adam(trained.convolutions.parameters(), lr=1e-3)
        trained.encode(build_index(views, panoramas, trained.config)).sum().backward()
        optimizer.step()
        change = (trained.convolutions.first_weight.detach() - before).abs()
        moved.append(change.amax((0, 2, 3)))
    share = class_shares([views], classes=CLASSES)
    seen = moved[0] > 0
    rare, common = share[seen].argmin(), share[seen].argmax()
    assert_close(moved[0][seen][rare], moved[0][seen][common], rtol=1e-3, atol=0)
    assert moved[1][seen][rare] > 2 * moved[1][seen][common]
