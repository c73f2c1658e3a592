"""FC: a fully connected layer instead of the global max pool.

    5x5 convolution, padded -> ReLU -> 2x2 max pool -> 3x3 convolution, padded -> ReLU
    -> 2x2 max pool -> one weight for every place and feature -> sum over the views

Unlike under a global max pool, every cell of every view matters and receives a gradient. The
layers up to the second pool are computed once per distinct patch of the house; the last one is a
dense product.

Source: Fu et al. (2019), the appendix's sweep: "a single fully connected layer (labeled FC)"; the
second pool is ours, as in networks of the time, and makes the layer four times smaller.
"""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.networks.gathering import gather_bags, max_bags, sum_bags
from lcrl_bench.networks.initialisation import uniform
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.positions import SIDE_MULTIPLE, PositionIndex


class ConnectedEncoder(nn.Module):
    """Embeds views of a fixed size; weights have the layout of PyTorch's own layers."""

    def __init__(
        self,
        classes: int,
        *,
        filters: int = 16,
        size: int = 32,
        height: int = 24,
        width: int = 32,
        generator: torch.Generator,
    ) -> None:
        """Draw initial weights.

        Args:
            classes: Number of classes in a view.
            filters: Filters of the first convolution.
            size: Filters of the second convolution, and size of an embedding.
            height: Rows of a view.
            width: Columns of a view.
            generator: A CPU generator, for the initial weights.
        """
        super().__init__()
        self.columns = width // SIDE_MULTIPLE
        self.places = (height // SIDE_MULTIPLE) * self.columns
        self.convolutions = PanoramaEncoder(
            classes, filters=filters, size=size, generator=generator
        )
        fan_in = size * self.places
        self.weight = uniform((size, fan_in), fan_in=fan_in, generator=generator)
        self.bias = uniform((size,), fan_in=fan_in, generator=generator)

    def forward(self, index: PositionIndex, *, mirrored: bool = False) -> torch.Tensor:
        """Embed every view of a house: float [view, size].

        Args:
            index: The house's index.
            mirrored: Whether to embed the mirror images of the views instead.
        """
        convolutions, size = self.convolutions, self.convolutions.size
        filters = len(convolutions.first_bias)
        rows = sum_bags(convolutions.table(mirrored=mirrored), index.rows)
        patches = sum_bags(rows.view(-1, filters), index.patches)
        pooled = convolutions.activate(max_bags(patches, index.pooled))
        # Multiply before gathering: there are fewer pooled cells than second cells.
        second_weight = convolutions.second_weight
        second_weight = second_weight.flip(-1) if mirrored else second_weight
        kernel = second_weight.permute(1, 2, 3, 0).reshape(filters, -1)
        second = sum_bags((pooled @ kernel).view(-1, size), index.second)
        groups = functional.relu(max_bags(second, index.groups) + convolutions.second_bias)
        cells = gather_bags(groups, index.places)
        # PyTorch flattens an image feature by feature; here it is place by place.
        weight = self.weight.view(size, size, -1, self.columns)
        weight = weight.flip(-1) if mirrored else weight
        weight = weight.flatten(2).transpose(1, 2).reshape(size, -1)
        return functional.linear(cells, weight, self.bias)
