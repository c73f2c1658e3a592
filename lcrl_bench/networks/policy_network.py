"""The paper's policy network: pi = FC(e_image * e_command * e_heading * e_held), four logits.

"Identical to the reward architecture, except with two additional inputs: the orientation indicator
and an indicator on whether the object is held. Each indicator is transformed by an embedding
lookup, and all embeddings are element-wise multiplied along with the language and image
embeddings." Where image and command are added or concatenated, the indicators multiply the
result.

Views are always those to the north, east, south and west, whatever the agent's heading, and their
sum has no directions: the policy knows its heading, but not what lies ahead. So does the paper's.

Source: Fu et al. (2019), section "Architecture" (figure of the network) and appendices.
"""

from __future__ import annotations

import torch
from torch import nn
from torch.nn import functional

from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.networks.grounding import Grounding, HouseIndex, NetworkConfig
from lcrl_bench.networks.initialisation import linear


class PolicyNetwork(Grounding):
    """Scores actions given (panorama, heading, held, command)."""

    def __init__(self, config: NetworkConfig, *, words: int, generator: torch.Generator) -> None:
        """Draw initial weights; arguments as `Grounding`."""
        super().__init__(config, words=words, generator=generator)
        self.heading = _indicator(HEADINGS, self.fused_size, generator)
        self.held = _indicator(2, self.fused_size, generator)
        self.hidden = linear(self.fused_size, config.hidden, generator=generator)
        self.output = linear(config.hidden, ACTIONS, generator=generator)

    def logits(
        self,
        features: torch.Tensor,
        panoramas: torch.Tensor,
        held: torch.Tensor,
        commands: torch.Tensor,
    ) -> torch.Tensor:
        """Score the actions in all states.

        Args:
            features: What `encode` returned.
            panoramas: int64 [command, cell], rows of `features`.
            held: bool [command, cell]: whether the object is in the agent's hand.
            commands: What `embed_commands` returned.

        Returns:
            float [command, cell, heading, action].
        """
        fused = self.ground(features, panoramas, commands)
        fused = fused * torch.where(held[..., None], self.held[1], self.held[0])
        # W (e * h) = (W * h) e: all headings in one matrix product, without storing e * h.
        weight = (self.hidden.weight * self.heading[:, None]).flatten(0, 1)
        hidden = functional.linear(fused, weight).unflatten(-1, (HEADINGS, -1))
        return self.output(functional.relu(hidden + self.hidden.bias))

    def forward(
        self,
        index: HouseIndex,
        panoramas: torch.Tensor,
        held: torch.Tensor,
        tokens: torch.Tensor,
        lengths: torch.Tensor,
    ) -> torch.Tensor:
        """Encode a house and commands, and score actions: [command, cell, heading, action]."""
        commands = self.embed_commands(tokens, lengths)
        return self.logits(self.encode(index), panoramas, held, commands)


def _indicator(values: int, size: int, generator: torch.Generator) -> nn.Parameter:
    """A table of vectors around one: float [values, size].

    With PyTorch's default, standard normal, half of the products of two indicators would be within
    0.4 of zero, which all but switches those features off. (In short trials
    both learned equally well.)
    """
    return nn.Parameter(torch.empty(values, size).normal_(1.0, 0.5, generator=generator))
