"""Views and panoramas to try image encoders on, and their layers as PyTorch offers them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import torch
from torch.nn import functional


def sample_views(
    seed: int, *, count: int = 5, height: int = 24, width: int = 32, classes: int = 61
) -> torch.Tensor:
    """Floor, wall and rectangles in most views, noise in the last: uint8 [view, height, width]."""
    rng = np.random.default_rng(seed)
    views = np.ones((count, height, width), np.uint8)
    for view in views:
        view[rng.integers(height // 3, height) :] = 2
        for _ in range(rng.integers(0, 6)):
            x, y = rng.integers(width), rng.integers(height)
            view[y : y + rng.integers(1, 12), x : x + rng.integers(1, 14)] = rng.integers(classes)
    views[-1] = rng.integers(classes, size=(height, width))
    return torch.from_numpy(views)


def sample_panoramas(seed: int, *, count: int = 7, views: int = 5) -> torch.Tensor:
    """Panoramas of some views: int64 [panorama, 4]."""
    return torch.randint(views, (count, 4), generator=torch.Generator().manual_seed(seed))


def dense_maps(
    views: torch.Tensor,
    first: tuple[torch.Tensor, torch.Tensor],
    second: tuple[torch.Tensor, torch.Tensor],
    *,
    classes: int = 61,
) -> torch.Tensor:
    """Two convolutions of one-hot images, without the last ReLU: float [view, size, y, x].

    Args:
        views: uint8 [view, height, width].
        first: Weight and bias of the 5x5 convolution.
        second: Weight and bias of the 3x3 convolution.
        classes: Number of classes.
    """
    image = functional.one_hot(views.long(), classes).permute(0, 3, 1, 2).to(first[0].dtype)
    pooled = functional.max_pool2d(functional.relu(functional.conv2d(image, *first, padding=2)), 2)
    return functional.conv2d(pooled, *second, padding=1)


def assert_same_gradients(
    found: torch.Tensor,
    expected: torch.Tensor,
    parameters: Mapping[str, torch.Tensor],
    *,
    tolerance: float = 1e-5,
) -> None:
    """Two computations of one number send the same gradients to the parameters."""
    weights = torch.linspace(-1, 1, expected.numel(), dtype=expected.dtype).view_as(expected)
    names, tensors = list(parameters), list(parameters.values())
    one = torch.autograd.grad((weights * found).sum(), tensors, allow_unused=True)
    other = torch.autograd.grad((weights * expected).sum(), tensors, allow_unused=True)
    for name, a, b in zip(names, one, other, strict=True):
        assert (a is None) == (b is None), name
        if a is not None and b is not None:
            error = float((a - b).abs().max() / b.abs().max().clamp_min(1e-12))
            assert error < tolerance, f"{name}: {error}"
