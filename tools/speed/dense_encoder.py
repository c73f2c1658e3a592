"""The image encoder in its simplest form: dense convolutions of one-hot images.

The reference that the suite's encoder is measured against. It is written to be as fast as it can
be: one-hot images made beforehand, channels last, pooling before ReLU, few enough views at once to
keep memory small.
"""

from __future__ import annotations

import torch
from torch.nn import functional

from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import KERNEL, POOL, SECOND_KERNEL

AT_ONCE = 256
"""Views convolved at once: 50 MB of one-hot images."""


def one_hot_images(views: torch.Tensor, *, classes: int) -> tuple[torch.Tensor, ...]:
    """One-hot images of views, one channel per class.

    Args:
        views: uint8 [view, height, width]: class ids.
        classes: Number of classes.

    Returns:
        Chunks of at most `AT_ONCE` views: float32 [view, class, height, width], channels last.
    """
    return tuple(
        functional.one_hot(part.long(), classes)
        .permute(0, 3, 1, 2)
        .to(torch.float32)
        .contiguous(memory_format=torch.channels_last)
        for part in views.split(AT_ONCE)
    )


def convolve_views(encoder: PanoramaEncoder, images: tuple[torch.Tensor, ...]) -> torch.Tensor:
    """The result of `PanoramaEncoder.embed_views`, by dense convolutions: float [view, size].

    Args:
        encoder: Provides the weights.
        images: From `one_hot_images`.
    """
    return torch.cat([_convolve(encoder, image) for image in images])


def _convolve(encoder: PanoramaEncoder, image: torch.Tensor) -> torch.Tensor:
    first, second = KERNEL // 2, SECOND_KERNEL // 2
    x = functional.conv2d(image, encoder.first_weight, encoder.first_bias, padding=first)
    x = functional.relu(functional.max_pool2d(x, POOL))
    x = functional.conv2d(x, encoder.second_weight, encoder.second_bias, padding=second)
    # Several times faster on a CPU than `max_pool2d` or `max`, which also track the argmax.
    return functional.relu(x.amax((2, 3)))
