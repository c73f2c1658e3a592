"""Class channels at unit variance: what lets a small thing weigh as much as a wall.

A one-hot image has a channel a class, 1 where the class is. A cup fills one pixel in ten thousand,
a wall one in three: with weights of one size, which Adam and weight decay keep them to, the cup is
lost among the 25 pixels of a window. Standardised, channel c is divided by its standard deviation,

    s_c = 1 / sqrt(p_c (1 - p_c)),    p_c the share of training pixels that are of class c,

which is the same as a first convolution w s in place of w: the same network in other coordinates.
So it is a matter of training alone. What is learned is written back as plain weights.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import torch
from torch import nn
from torch.nn.utils import parametrize

from lcrl_bench.networks.grounding import Grounding

RAREST: Final = 1e-5
"""Smaller shares count as this one: a class that is hardly ever seen is not blown up."""
_WEIGHT: Final = "first_weight"


def class_shares(houses: Iterable[torch.Tensor], *, classes: int) -> torch.Tensor:
    """What share of the pixels is of each class: float32 [class], summing to 1.

    Args:
        houses: uint8 [view, height, width], one a house; all houses weigh the same.
        classes: Number of classes.
    """
    shares = [
        torch.bincount(views.flatten().long(), minlength=classes) / views.numel()
        for views in houses
    ]
    return torch.stack(shares).mean(0)


class _Scaled(nn.Module):
    """Weights of a convolution, each class channel at its scale."""

    def __init__(self, scale: torch.Tensor) -> None:
        super().__init__()
        # Not persistent: it follows from the training houses, and a checkpoint belongs to those.
        self.register_buffer("scale", scale, persistent=False)

    def forward(self, weight: torch.Tensor) -> torch.Tensor:
        return weight * self.get_buffer("scale")[:, None, None]


def standardise(network: Grounding, houses: Iterable[torch.Tensor]) -> None:
    """Train the network's first convolution on channels of unit variance from now on.

    Args:
        network: Its initial weights are taken for those of standardised channels.
        houses: uint8 [view, height, width], the training views, one a house.
    """
    p = class_shares(houses, classes=network.config.classes).clamp(RAREST, 0.5)
    scale = (p * (1.0 - p)).rsqrt()
    parametrize.register_parametrization(network.convolutions, _WEIGHT, _Scaled(scale))


def fold_scale(network: Grounding) -> None:
    """Write the weights back as those of plain one-hot channels, if they were standardised."""
    if parametrize.is_parametrized(network.convolutions, _WEIGHT):
        parametrize.remove_parametrizations(network.convolutions, _WEIGHT)
