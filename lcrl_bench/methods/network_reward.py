"""`NetworkReward`: a reward network and its vocabulary, ready for the harness and for disk."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar, Final, Self

import torch

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.methods.contract import Panoramas, Reward
from lcrl_bench.methods.encoded_houses import EncodedHouses, command_chunks
from lcrl_bench.methods.logit_rewards import LogitReward, is_logit_reward, reward_of_logit
from lcrl_bench.methods.network_files import CONFIG_FILE, load_network, save_network
from lcrl_bench.networks.reward_network import RewardNetwork
from lcrl_bench.networks.vocabulary import Vocabulary

_KIND: Final = "reward"


class NetworkReward(Reward):
    """A reward network that scores the panoramas of any house."""

    Network: ClassVar = RewardNetwork
    """What is trained."""

    def __init__(
        self, network: RewardNetwork, vocabulary: Vocabulary, *, transform: LogitReward = "logit"
    ) -> None:
        """Wrap a network.

        Args:
            network: Moved to the device of the views when it scores.
            vocabulary: The one it was trained with.
            transform: How the reward is computed from the network's output; `logit` is the output
                itself.
        """
        self.transform: LogitReward = transform
        self.network = network
        self.vocabulary = vocabulary
        self._houses = EncodedHouses(network)

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        """Score every panorama for every command: float [command, panorama], without gradients."""
        with torch.no_grad():
            features = self._houses.encode(views)
            tokens, lengths = (
                tensor.to(features.device) for tensor in self.vocabulary.encode(commands)
            )
            embedded = self.network.embed_commands(tokens, lengths)
            every = torch.arange(len(features), device=features.device).expand(len(commands), -1)
            parts = [
                self.network.score(features, every[rows], embedded[rows])
                for rows in command_chunks(every, numbers=features.shape[1])
            ]
            scores = torch.cat(parts) if parts else features.new_zeros(every.shape)
            return reward_of_logit(self.transform, scores)

    def save(self, folder: Path) -> None:
        """Write `reward.safetensors`, then `config.json`, into `folder`."""
        save_network(folder, self.network, self.vocabulary, kind=_KIND, transform=self.transform)

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read back what `save` wrote.

        Raises:
            InvalidFileError: If a file is missing, damaged, or does not fit the other.
        """
        network, vocabulary, others = load_network(folder, RewardNetwork, kind=_KIND)
        transform = others.get("transform", "logit")
        if not is_logit_reward(transform):
            reason = f"'{transform}' is not a reward computed from a logit"
            raise InvalidFileError(folder / CONFIG_FILE, reason, fix="Train it again.")
        return cls(network, vocabulary, transform=transform)


def config_document(config: Any) -> dict[str, Any]:  # noqa: ANN401 - any dataclass
    """A configuration as JSON values, so that it compares equal after a round trip."""
    return json.loads(json.dumps(dataclasses.asdict(config)))
