"""The paper's image encoder, computed once per distinct patch of the house.

    5x5 convolution, 16 filters, padded -> ReLU -> 2x2 max pool
    -> 3x3 convolution, 32 filters, padded -> ReLU -> global max pool over the view
    -> sum over the views to the north, east, south and west

Biases and ReLUs are applied after the maximum that follows them: both are monotone, so the result
is the same, computed for fewer elements.

Source: Fu et al. (2019), section "Architecture" and appendix "Experiment Hyperparameters".
"""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.mdp.kernels.dispatch import use_kernel
from lcrl_bench.networks.gathering import (
    Bags,
    gather_bags,
    max_bags,
    sum_bags,
    take_entries,
)
from lcrl_bench.networks.initialisation import uniform
from lcrl_bench.networks.kernels import largest_cells as compiled
from lcrl_bench.networks.patches import KERNEL, SECOND_KERNEL, PatchIndex

_AT_ONCE = 2048
"""Second cells gathered at a time: as many as stay in a core's cache until the product."""


class PanoramaEncoder(nn.Module):
    """Embeds panoramas of class ids; weights have the layout of `torch.nn.Conv2d`."""

    def __init__(
        self, classes: int, *, filters: int = 16, size: int = 32, generator: torch.Generator
    ) -> None:
        """Draw initial weights.

        Args:
            classes: Number of classes in a view.
            filters: Filters of the first convolution.
            size: Filters of the second convolution, and size of an embedding.
            generator: A CPU generator, for the initial weights.
        """
        super().__init__()
        self.classes, self.size = classes, size
        fan_in = classes * KERNEL**2
        shape = (filters, classes, KERNEL, KERNEL)
        self.first_weight = uniform(shape, fan_in=fan_in, generator=generator)
        self.first_bias = uniform((filters,), fan_in=fan_in, generator=generator)
        fan_in = filters * SECOND_KERNEL**2
        shape = (size, filters, SECOND_KERNEL, SECOND_KERNEL)
        self.second_weight = uniform(shape, fan_in=fan_in, generator=generator)
        self.second_bias = uniform((size,), fan_in=fan_in, generator=generator)

    def forward(self, index: PatchIndex) -> torch.Tensor:
        """Embed every panorama of a house: float [panorama, size]."""
        return sum_bags(self.embed_views(index), index.panoramas)

    def embed_views(self, index: PatchIndex, *, mirrored: bool = False) -> torch.Tensor:
        """Embed every view of a house: float [view, size].

        Args:
            index: The house's index.
            mirrored: Whether to embed the mirror images of the views instead.
        """
        largest = self.largest_cells(index, self.second_weight, mirrored=mirrored)
        return functional.relu(largest + self.second_bias)

    def largest_cells(
        self, index: PatchIndex, second_weight: torch.Tensor, *, mirrored: bool = False
    ) -> torch.Tensor:
        """The largest output of a second convolution in every view, without its bias.

        A compiled kernel computes it where one is available for these sizes (`mdp.kernels`).

        Args:
            index: The house's index.
            second_weight: float [output, filters, 3, 3].
            mirrored: Whether to look at the mirror images of the views instead. A mirror image
                under a kernel is the image under the mirrored kernel, so they need no index of
                their own.

        Returns:
            float [view, output].

        Raises:
            UsageError: If `LCRL_BENCH_KERNEL` is invalid.
            EnvironmentMissingError: If it is `numba`, and numba is not installed.
        """
        table = self.table(mirrored=mirrored)
        second_weight = second_weight.flip(-1) if mirrored else second_weight
        weights = (table, self.first_bias, second_weight)
        if use_kernel(table.device) and compiled.covers(*weights):
            return compiled.largest_cells(*weights, index)
        return self._largest_cells(table, index, second_weight)

    def _largest_cells(
        self, table: torch.Tensor, index: PatchIndex, second_weight: torch.Tensor
    ) -> torch.Tensor:
        """`largest_cells` by torch.

        Only the second cells that win a global maximum receive a gradient. So the winners are found
        without gradients, and only they are computed again with gradients.
        """
        patches = self._patches(table, index)
        with torch.no_grad():
            cells = self._every_second_cell(patches, index, second_weight)
            members = cells.index_select(0, index.views.view(-1)).view(*index.views.shape, -1)
            groups = members.amax(0)
            if not patches.requires_grad:
                return groups.amax(1)
            winners = _winners(members, groups, index.views)
        return self._winning_cells(patches, index, winners, second_weight)

    def table(self, *, mirrored: bool = False) -> torch.Tensor:
        """What each class adds to a row: float [class * 5 + column, line * filters + filter].

        A convolution of a one-hot image is a sum of weights looked up by class. An entry holds one
        column of the kernel, with all its five lines. The last class is padding.

        Args:
            mirrored: Whether left and right of the kernel change places.
        """
        weight = self.first_weight.flip(-1) if mirrored else self.first_weight
        width = KERNEL * len(weight)
        by_class = weight.permute(1, 3, 2, 0).reshape(-1, width)
        return torch.cat([by_class, by_class.new_zeros(KERNEL, width)])

    def _patches(self, table: torch.Tensor, index: PatchIndex) -> torch.Tensor:
        """First convolution, without its bias: float [patch, filters]."""
        rows = sum_bags(table, index.rows)
        return sum_bags(rows.view(-1, len(self.first_bias)), index.patches)

    def _every_second_cell(
        self, patches: torch.Tensor, index: PatchIndex, second_weight: torch.Tensor
    ) -> torch.Tensor:
        """Second convolution, without its bias: float [second, output]; no gradient flows."""
        members = patches.index_select(0, index.pooled.view(-1)).view(*index.pooled.shape, -1)
        pooled = self.activate(members.amax(0))
        kernel = second_weight.permute(2, 3, 1, 0).reshape(-1, len(second_weight))
        cells = pooled.new_empty(len(index.second), len(second_weight))
        for part, windows in zip(cells.split(_AT_ONCE), index.second.split(_AT_ONCE), strict=True):
            gathered = pooled.index_select(0, windows.view(-1)).view(len(windows), -1)
            torch.mm(gathered, kernel, out=part)
        return cells

    def activate(self, pooled: torch.Tensor) -> torch.Tensor:
        """Bias and ReLU of the first layer, and a last row of zeros for padding."""
        return torch.cat(
            [functional.relu(pooled + self.first_bias), pooled.new_zeros(1, pooled.shape[1])]
        )

    def _winning_cells(
        self,
        patches: torch.Tensor,
        index: PatchIndex,
        winners: torch.Tensor,
        second_weight: torch.Tensor,
    ) -> torch.Tensor:
        """The second convolution at the winners, with gradients.

        Args:
            patches: What `_patches` returned.
            index: The house's index.
            winners: int64 [view, output]: the second cell at which each output is largest.
            second_weight: float [output, filters, 3, 3].

        Returns:
            float [view, output].
        """
        cells, cell_of = torch.unique(winners, return_inverse=True)
        used, windows = Bags.compact(index.second[cells])
        # Padding has the largest number: if used at all, it comes last, as its zeros do.
        members = index.pooled[:, used[used < index.pooled.shape[1]]]
        pooled = self.activate(max_bags(patches, Bags.of(members, size=len(patches))))[: len(used)]
        gathered = gather_bags(pooled, windows)
        outputs = len(second_weight)
        values = gathered @ second_weight.permute(2, 3, 1, 0).reshape(-1, outputs)
        features = torch.arange(outputs, device=cell_of.device)
        return take_entries(values, cell_of * outputs + features)


def _winners(members: torch.Tensor, groups: torch.Tensor, cells: torch.Tensor) -> torch.Tensor:
    """The second cell that is largest in each view, feature by feature.

    Searching whole lists would be several times slower: torch's maximum is fast, its argmax is not.
    So the group is found first, then its member.

    Args:
        members: float [member, view, group, feature].
        groups: float [view, group, feature]: the maximum of each group.
        cells: int64 [member, view, group]: the second cells.

    Returns:
        int64 [view, feature].
    """
    group = groups.max(1).indices
    # Flat positions: `gather` with a repeated index takes five times as long.
    line = torch.arange(len(group), device=group.device)[:, None] * groups.shape[1] + group
    entry = line * groups.shape[2] + torch.arange(groups.shape[2], device=group.device)
    choice = members.view(len(members), -1).index_select(1, entry.view(-1))
    member = choice.max(0).indices.view(group.shape)
    return cells.view(len(cells), -1)[member, line]
