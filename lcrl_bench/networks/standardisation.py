"""Standardises class channels to unit variance, so that small objects weigh as much as walls.

A one-hot image has one channel per class. A cup fills one pixel in ten thousand, a wall one in
three: with weights of similar size, as Adam and weight decay keep them, the cup is lost among the
25 pixels of a window. Standardised, channel c is divided by its standard deviation,

    s_c = 1 / sqrt(p_c (1 - p_c)),    p_c the share of training pixels of class c,

which is the same as replacing the weights w of the first convolution by w s: the same network,
reparametrised. So it affects training alone; afterwards, the scale is folded into plain weights.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import torch
from torch import nn
from torch.nn.utils import parametrize

from lcrl_bench.networks.grounding import Grounding

RAREST: Final = 1e-5
"""Lower bound on shares, so that classes that are hardly ever seen are not scaled up further."""
_WEIGHT: Final = "first_weight"


def class_shares(houses: Iterable[torch.Tensor], *, classes: int) -> torch.Tensor:
    """Each class's share of pixels: float32 [class], summing to 1.

    Args:
        houses: uint8 [view, height, width], one per house; all houses weigh the same.
        classes: Number of classes.
    """
    shares = [
        torch.bincount(views.flatten().long(), minlength=classes) / views.numel()
        for views in houses
    ]
    return torch.stack(shares).mean(0)


class _Scaled(nn.Module):
    """Scales the weights of a convolution by class channel."""

    def __init__(self, scale: torch.Tensor) -> None:
        super().__init__()
        # Not persistent: it follows from the training houses, which a checkpoint belongs to.
        self.register_buffer("scale", scale, persistent=False)

    def forward(self, weight: torch.Tensor) -> torch.Tensor:
        return weight * self.get_buffer("scale")[:, None, None]


def standardise(network: Grounding, houses: Iterable[torch.Tensor]) -> None:
    """Reparametrise the first convolution for channels of unit variance, for training.

    Args:
        network: Its weights become those of standardised channels.
        houses: uint8 [view, height, width], the training views, one per house.
    """
    p = class_shares(houses, classes=network.config.classes).clamp(RAREST, 0.5)
    scale = (p * (1.0 - p)).rsqrt()
    parametrize.register_parametrization(network.convolutions, _WEIGHT, _Scaled(scale))


def fold_scale(network: Grounding) -> None:
    """Fold the scale of standardised channels, if any, into plain weights."""
    if parametrize.is_parametrized(network.convolutions, _WEIGHT):
        parametrize.remove_parametrizations(network.convolutions, _WEIGHT)
