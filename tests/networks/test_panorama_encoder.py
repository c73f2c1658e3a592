"""The encoder over unique patches against a plain dense convolution of one-hot images."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch.nn import functional

from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import build_patch_index

laws = settings(derandomize=True, deadline=None, max_examples=15)


def cluttered_views(seed: int, *, count: int, classes: int) -> torch.Tensor:
    """Floor, wall and rectangles: semantic views repeat their patches, as noise would not."""
    rng = np.random.default_rng(seed)
    views = np.ones((count, 24, 32), np.uint8)
    for view in views:
        view[rng.integers(8, 16) :] = 2
        for _ in range(rng.integers(0, 6)):
            x, y = rng.integers(0, 28), rng.integers(0, 20)
            view[y : y + rng.integers(1, 12), x : x + rng.integers(1, 14)] = rng.integers(classes)
    return torch.from_numpy(views)


def noisy_views(seed: int, *, count: int, classes: int) -> torch.Tensor:
    """Nothing repeats: the worst case."""
    rng = np.random.default_rng(seed)
    return torch.from_numpy(rng.integers(classes, size=(count, 24, 32)).astype(np.uint8))


def dense(encoder: PanoramaEncoder, views: torch.Tensor, panoramas: torch.Tensor) -> torch.Tensor:
    """The paper's layers as PyTorch offers them, on one-hot images."""
    image = functional.one_hot(views.long(), encoder.classes).permute(0, 3, 1, 2)
    image = image.to(encoder.first_weight.dtype)
    first = functional.conv2d(image, encoder.first_weight, encoder.first_bias, padding=2)
    pooled = functional.max_pool2d(functional.relu(first), 2)
    second = functional.conv2d(pooled, encoder.second_weight, encoder.second_bias, padding=1)
    return functional.relu(second).amax((2, 3))[panoramas].sum(1)


def gradients(encoder: PanoramaEncoder, output: torch.Tensor) -> dict[str, torch.Tensor]:
    weights = torch.linspace(-1, 1, output.numel(), dtype=output.dtype).view_as(output)
    names, parameters = zip(*encoder.named_parameters(), strict=True)
    return dict(zip(names, torch.autograd.grad((weights * output).sum(), parameters), strict=True))


def make(seed: int, classes: int = 61) -> PanoramaEncoder:
    return PanoramaEncoder(classes, generator=torch.Generator().manual_seed(seed))


@laws
@given(st.integers(0, 10_000), st.sampled_from([cluttered_views, noisy_views]))
def test_unique_patches_give_what_a_dense_convolution_gives(seed, scenery):
    views = scenery(seed, count=5, classes=61)
    panoramas = torch.randint(5, (7, 4), generator=torch.Generator().manual_seed(seed))
    encoder = make(seed)
    index = build_patch_index(views, panoramas, classes=61)
    expected = dense(encoder, views, panoramas)
    with torch.no_grad():
        torch.testing.assert_close(encoder(index), expected, rtol=1e-5, atol=1e-5)
    found = encoder(index)
    torch.testing.assert_close(found, expected, rtol=1e-5, atol=1e-5)
    reference = gradients(encoder, expected)
    for name, gradient in gradients(encoder, found).items():
        error = (gradient - reference[name]).abs().max() / reference[name].abs().max()
        assert float(error) < 1e-4, name


def test_double_precision_agrees_to_rounding():
    views = cluttered_views(1, count=4, classes=61)
    panoramas = torch.tensor([[0, 1, 2, 3], [3, 3, 0, 0]])
    encoder = make(1).double()
    index = build_patch_index(views, panoramas, classes=61)
    expected, found = dense(encoder, views, panoramas), encoder(index)
    torch.testing.assert_close(found, expected, rtol=1e-13, atol=1e-13)
    reference = gradients(encoder, expected)
    for name, gradient in gradients(encoder, found).items():
        torch.testing.assert_close(gradient, reference[name], rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("label", [0, 60])
def test_a_blank_view_is_one_flat_area_with_a_border(label):
    views = torch.full((2, 24, 32), label, dtype=torch.uint8)
    panoramas = torch.tensor([[0, 0, 1, 1]])
    encoder = make(3)
    index = build_patch_index(views, panoramas, classes=61)
    # Along each axis a pooled cell is first, last or inside; a second cell is first, next to it,
    # last, next to that, or inside.
    assert index.pooled.shape[1] == 3 * 3
    assert len(index.second) == 5 * 5
    torch.testing.assert_close(encoder(index), dense(encoder, views, panoramas))


def test_gradients_reach_an_unused_class_as_zero():
    views = cluttered_views(2, count=3, classes=30)
    encoder = make(2)
    panoramas = torch.tensor([[0, 1, 2, 0]])
    found = gradients(encoder, encoder(build_patch_index(views, panoramas, classes=61)))
    assert float(found["first_weight"][:, 30:].abs().max()) == 0.0
    assert float(found["first_weight"][:, :30].abs().max()) > 0.0


def test_the_same_bits_come_out_twice_and_on_any_number_of_threads():
    views = cluttered_views(4, count=40, classes=61)
    panoramas = torch.randint(40, (60, 4), generator=torch.Generator().manual_seed(4))
    encoder = make(4)
    index = build_patch_index(views, panoramas, classes=61)
    before = torch.get_num_threads()
    try:
        results = []
        for threads in (1, 1, 2, 2):
            torch.set_num_threads(threads)
            output = encoder(index)
            results.append((output, gradients(encoder, output)))
    finally:
        torch.set_num_threads(before)
    # Matrix products may split their sums by thread; a run fixes its threads.
    for first, second in ((results[0], results[1]), (results[2], results[3])):
        assert torch.equal(first[0], second[0])
        assert all(torch.equal(first[1][name], second[1][name]) for name in first[1])


def test_repeated_patches_are_found_once():
    views = cluttered_views(5, count=100, classes=61)
    panoramas = torch.zeros(1, 4, dtype=torch.int64)
    index = build_patch_index(torch.cat([views, views]), panoramas, classes=61)
    alone = build_patch_index(views, panoramas, classes=61)
    assert len(index.patches.index) == len(alone.patches.index) < 100 * 24 * 32 / 4
    assert len(index.second) == len(alone.second) < 100 * 12 * 16


def test_initial_weights_have_the_scale_of_a_one_hot_convolution():
    encoder, reference = make(0), torch.nn.Conv2d(61, 16, 5)
    bound = 1 / math.sqrt(61 * 25)
    assert float(encoder.first_weight.detach().abs().max()) == pytest.approx(bound, rel=1e-3)
    assert float(reference.weight.detach().abs().max()) == pytest.approx(bound, rel=1e-3)


def test_equal_generators_give_equal_weights_and_leave_the_global_one_alone():
    before = torch.get_rng_state()
    first, second, other = make(7), make(7), make(8)
    assert torch.equal(torch.get_rng_state(), before)
    assert torch.equal(first.first_weight, second.first_weight)
    assert not torch.equal(first.first_weight, other.first_weight)


def test_a_class_that_does_not_exist_is_refused():
    views = torch.full((1, 24, 32), 61, dtype=torch.uint8)
    with pytest.raises(ValueError, match="views hold class 61, but there are 61 classes"):
        build_patch_index(views, torch.zeros(1, 4, dtype=torch.int64), classes=61)


def test_a_view_of_odd_height_is_refused():
    views = torch.zeros((1, 23, 32), dtype=torch.uint8)
    with pytest.raises(ValueError, match="even sides, found 23 x 32"):
        build_patch_index(views, torch.zeros(1, 4, dtype=torch.int64), classes=61)


@pytest.mark.gpu
@pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device")
def test_a_gpu_gives_what_the_cpu_gives_and_the_same_bits_twice():
    views = cluttered_views(6, count=60, classes=61)
    panoramas = torch.randint(60, (80, 4), generator=torch.Generator().manual_seed(6))
    encoder = make(6)
    index = build_patch_index(views, panoramas, classes=61)
    expected = encoder(index)
    reference = gradients(encoder, expected)
    encoder.cuda()
    runs = []
    for _ in range(2):
        output = encoder(index.to("cuda"))
        weights = torch.linspace(-1, 1, output.numel()).view_as(expected).cuda()
        runs.append(
            (output, torch.autograd.grad((weights * output).sum(), list(encoder.parameters())))
        )
    assert torch.equal(runs[0][0], runs[1][0])
    assert all(torch.equal(a, b) for a, b in zip(runs[0][1], runs[1][1], strict=True))
    torch.testing.assert_close(runs[0][0].cpu(), expected, rtol=1e-4, atol=1e-4)
    for found, name in zip(runs[0][1], reference, strict=True):
        error = (found.cpu() - reference[name]).abs().max() / reference[name].abs().max()
        assert float(error) < 1e-3, name
