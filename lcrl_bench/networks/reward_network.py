"""The paper's reward network: r = FC(e_image * e_command), a scalar.

Source: Fu et al. (2019), section "Architecture" and appendices.
"""

from __future__ import annotations

import torch
from torch.nn import functional

from lcrl_bench.networks.grounding import Grounding, HouseIndex, NetworkConfig
from lcrl_bench.networks.initialisation import linear

RewardNetworkConfig = NetworkConfig
"""Its architecture."""


class RewardNetwork(Grounding):
    """Scores (panorama, command) pairs."""

    def __init__(
        self, config: RewardNetworkConfig, *, words: int, generator: torch.Generator
    ) -> None:
        """Draw initial weights; arguments as `Grounding`."""
        super().__init__(config, words=words, generator=generator)
        self.hidden = linear(self.fused_size, config.hidden, generator=generator)
        self.output = linear(config.hidden, 1, generator=generator)

    def score(
        self, features: torch.Tensor, panoramas: torch.Tensor, commands: torch.Tensor
    ) -> torch.Tensor:
        """Score the panoramas of each command's cells.

        Args:
            features: What `encode` returned.
            panoramas: int64 [command, cell], rows of `features`.
            commands: What `embed_commands` returned.

        Returns:
            float [command, cell].
        """
        fused = self.ground(features, panoramas, commands)
        return self.output(functional.relu(self.hidden(fused))).squeeze(-1)

    def forward(
        self,
        index: HouseIndex,
        panoramas: torch.Tensor,
        tokens: torch.Tensor,
        lengths: torch.Tensor,
    ) -> torch.Tensor:
        """Encode a house and commands, and score panoramas: float [command, cell]."""
        return self.score(self.encode(index), panoramas, self.embed_commands(tokens, lengths))
