"""The paper's reward network: r = FC(e_image * e_command), one number.

Every panorama of a house is encoded once, whatever the number of commands and object states that
look at it (the paper's "Observation Caching").

Source: Fu et al. (2019), section "Architecture" and appendices.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.networks.command_encoder import CommandEncoder
from lcrl_bench.networks.fusion import FusionName, fuse, fused_size
from lcrl_bench.networks.gathering import gather_rows
from lcrl_bench.networks.initialisation import linear
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import PatchIndex


@dataclass(frozen=True)
class RewardNetworkConfig:
    """Sizes of the network; the defaults are the paper's."""

    classes: int = 61
    """Number of semantic classes in a view."""
    filters: int = 16
    """Filters of the first convolution (5x5)."""
    size: int = 32
    """Filters of the second convolution (3x3), word vectors, LSTM state: every embedding."""
    hidden: int = 32
    """Units of the fully connected layer before the output."""
    fusion: FusionName = "mult"
    """How embeddings combine: mult, add or concat."""


class RewardNetwork(nn.Module):
    """Scores (panorama, command) pairs."""

    def __init__(
        self, config: RewardNetworkConfig, *, words: int, generator: torch.Generator
    ) -> None:
        """Draw initial weights.

        Args:
            config: Sizes.
            words: Number of word numbers, the unknown word's included.
            generator: A CPU generator; equal states give equal weights.
        """
        super().__init__()
        self.config = config
        self.image = PanoramaEncoder(
            config.classes, filters=config.filters, size=config.size, generator=generator
        )
        self.command = CommandEncoder(words, size=config.size, generator=generator)
        fused = fused_size(config.fusion, config.size)
        self.hidden = linear(fused, config.hidden, generator=generator)
        self.output = linear(config.hidden, 1, generator=generator)

    def encode(self, index: PatchIndex) -> torch.Tensor:
        """Embed every panorama of a house, once: float [panorama, size]."""
        return self.image(index)

    def score(
        self,
        embeddings: torch.Tensor,
        panoramas: torch.Tensor,
        tokens: torch.Tensor,
        lengths: torch.Tensor,
    ) -> torch.Tensor:
        """Score the panoramas of each command.

        Args:
            embeddings: What `encode` returned.
            panoramas: int64 [command, cell], rows of `embeddings`.
            tokens: int64 [command, word].
            lengths: int64 [command].

        Returns:
            float [command, cell].
        """
        image = gather_rows(embeddings, panoramas)
        command = self.command(tokens, lengths)[:, None]
        fused = fuse(self.config.fusion, image, command)
        return self.output(functional.relu(self.hidden(fused))).squeeze(-1)

    def forward(
        self,
        index: PatchIndex,
        panoramas: torch.Tensor,
        tokens: torch.Tensor,
        lengths: torch.Tensor,
    ) -> torch.Tensor:
        """Encode a house and score the panoramas of each command: float [command, cell]."""
        return self.score(self.encode(index), panoramas, tokens, lengths)
