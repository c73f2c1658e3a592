"""`NetworkPolicy`: a policy network and its vocabulary, ready for the harness and for disk."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar, Final, Self

import torch

from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.methods.contract import Panoramas, Policy
from lcrl_bench.methods.encoded_houses import EncodedHouses, command_chunks
from lcrl_bench.methods.network_files import load_network, save_network
from lcrl_bench.networks.policy_network import PolicyNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

_KIND: Final = "policy"


class NetworkPolicy(Policy):
    """A policy network that acts in any house."""

    Network: ClassVar = PolicyNetwork
    """What is trained."""

    def __init__(self, network: PolicyNetwork, vocabulary: Vocabulary) -> None:
        """Wrap a network.

        Args:
            network: Moved to the device of the views when it is asked.
            vocabulary: The one it was trained with.
        """
        self.network = network
        self.vocabulary = vocabulary
        self._houses = EncodedHouses(network)

    def logits(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        """Score the actions in every situation, without gradients; see `Policy.logits`."""
        with torch.no_grad():
            features = self._houses.encode(views)
            tokens, lengths = (
                tensor.to(features.device) for tensor in self.vocabulary.encode(commands)
            )
            embedded = self.network.embed_commands(tokens, lengths)
            count = len(features)
            # Every panorama twice: with an empty hand, and with the object in it.
            every = torch.arange(2 * count, device=features.device).expand(len(commands), -1)
            held, every = every >= count, every % count
            numbers = max(features.shape[1], HEADINGS * self.network.config.hidden)
            parts = [
                self.network.logits(features, every[rows], held[rows], embedded[rows])
                for rows in command_chunks(every, numbers=numbers)
            ]
            empty = features.new_zeros(*every.shape, HEADINGS, ACTIONS)
            scores = torch.cat(parts) if parts else empty
            return scores.unflatten(1, (2, count)).transpose(1, 2)

    def save(self, folder: Path) -> None:
        """Write `policy.safetensors`, then `config.json`, into `folder`."""
        save_network(folder, self.network, self.vocabulary, kind=_KIND)

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read back what `save` wrote.

        Raises:
            InvalidFileError: If a file is missing, damaged, or does not fit the other.
        """
        network, vocabulary, _ = load_network(folder, PolicyNetwork, kind=_KIND)
        return cls(network, vocabulary)
