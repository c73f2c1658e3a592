"""FiLM: the command scales and shifts the feature maps before their global maximum.

    c = second convolution(pooled)                        one feature map per filter
    e = sum over views of max over cells of relu(gamma(L) * c + beta(L))
    gamma(L) = 1 + linear(L),  beta(L) = linear(L)

A linear function of c is largest at the largest c if gamma >= 0, and at the smallest if gamma < 0.
So the two extremes of each feature map are all that a command needs: they are found once per house,
and modulating them is exact.

Source: Perez et al., "FiLM: Visual Reasoning with a General Conditioning Layer" (AAAI 2018), which
Fu et al. (2019) name in the appendix's sweep without saying which layer is modulated. Our choice:
the last convolution's output (before its ReLU, as there), gamma around one (as there), no batch
normalisation and no residual blocks, so that the encoder is otherwise the one it is compared with.
"""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.networks.gathering import gather_bags
from lcrl_bench.networks.initialisation import linear
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import PatchIndex

_VIEWS, _EXTREMES = 4, 2


class FilmEncoder(nn.Module):
    """Finds the extremes of feature maps, and modulates them by commands."""

    def __init__(
        self, classes: int, *, filters: int = 16, size: int = 32, generator: torch.Generator
    ) -> None:
        """Draw initial weights.

        Args:
            classes: Number of classes in a view.
            filters: Filters of the first convolution.
            size: Filters of the second convolution, and size of a command's embedding.
            generator: A CPU generator, for the initial weights.
        """
        super().__init__()
        self.size = size
        self.convolutions = PanoramaEncoder(
            classes, filters=filters, size=size, generator=generator
        )
        self.gamma = linear(size, size, generator=generator)
        self.beta = linear(size, size, generator=generator)

    def forward(self, index: PatchIndex, *, mirrored: bool = False) -> torch.Tensor:
        """The extremes of every feature map: float [panorama, view * extreme * size].

        Args:
            index: The house's index.
            mirrored: Whether to look at the mirror images of the views instead.
        """
        weight, bias = self.convolutions.second_weight, self.convolutions.second_bias
        # The smallest c is minus the largest of -c.
        pair = torch.cat([weight, -weight])
        found = self.convolutions.largest_cells(index, pair, mirrored=mirrored)
        largest, smallest = found[:, : self.size] + bias, bias - found[:, self.size :]
        return gather_bags(torch.cat([largest, smallest], 1), index.panoramas)

    def modulate(self, extremes: torch.Tensor, commands: torch.Tensor) -> torch.Tensor:
        """Scale and shift the feature maps of each view by commands, and take their maxima.

        Args:
            extremes: float [command, cell, view * extreme * size]: what `forward` returned.
            commands: float [command, size].

        Returns:
            float [command, cell, view, size].
        """
        largest, smallest = extremes.unflatten(-1, (_VIEWS, _EXTREMES, self.size)).unbind(-2)
        gamma = 1.0 + self.gamma(commands)[:, None, None]
        beta = self.beta(commands)[:, None, None]
        return functional.relu(gamma * torch.where(gamma >= 0, largest, smallest) + beta)
