"""The image encoder as one would write it first: convolutions of one-hot images, every pixel.

The reference that the suite's encoder is measured against. It is given what helps it: one-hot
images made beforehand, channels last, pools before biases' ReLUs, no more views at once than stay
in little memory.
"""

from __future__ import annotations

import torch
from torch.nn import functional

from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import KERNEL, POOL, SECOND_KERNEL

AT_ONCE = 256
"""Views convolved at once: 50 MB of one-hot images."""


def one_hot_images(views: torch.Tensor, *, classes: int) -> tuple[torch.Tensor, ...]:
    """Views as images of one channel a class.

    Args:
        views: uint8 [view, height, width]: class ids.
        classes: Number of classes.

    Returns:
        float32 [view, class, height, width] each, channels last; at most `AT_ONCE` views.
    """
    return tuple(
        functional.one_hot(part.long(), classes)
        .permute(0, 3, 1, 2)
        .to(torch.float32)
        .contiguous(memory_format=torch.channels_last)
        for part in views.split(AT_ONCE)
    )


def convolve_views(encoder: PanoramaEncoder, images: tuple[torch.Tensor, ...]) -> torch.Tensor:
    """What `PanoramaEncoder.embed_views` returns: float [view, size].

    Args:
        encoder: Whose weights.
        images: What `one_hot_images` returned.
    """
    return torch.cat([_convolve(encoder, image) for image in images])


def _convolve(encoder: PanoramaEncoder, image: torch.Tensor) -> torch.Tensor:
    first, second = KERNEL // 2, SECOND_KERNEL // 2
    x = functional.conv2d(image, encoder.first_weight, encoder.first_bias, padding=first)
    x = functional.relu(functional.max_pool2d(x, POOL))
    x = functional.conv2d(x, encoder.second_weight, encoder.second_bias, padding=second)
    # Several times faster on a CPU than `max_pool2d` or `max`, which find the place as well.
    return functional.relu(x.amax((2, 3)))
