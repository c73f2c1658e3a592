"""`NetworkReward`: a reward network and its vocabulary as the harness meets them, on disk too."""

from __future__ import annotations

import dataclasses
import json
from collections import OrderedDict
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import torch
from safetensors import SafetensorError
from safetensors.torch import load as load_tensors
from safetensors.torch import save as save_tensors

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.methods.contract import HouseViews, Reward
from lcrl_bench.networks.grounding import build_index
from lcrl_bench.networks.reward_network import RewardNetwork, RewardNetworkConfig
from lcrl_bench.networks.vocabulary import Vocabulary
from lcrl_bench.storage import read_json, sha256_of, write_bytes, write_json

WEIGHTS_FILE: Final = "reward.safetensors"
CONFIG_FILE: Final = "config.json"
_HOUSES_KEPT: Final = 2
_COMMANDS_AT_ONCE: Final = 64


class NetworkReward(Reward):
    """A reward network that scores the panoramas of any house."""

    def __init__(self, network: RewardNetwork, vocabulary: Vocabulary) -> None:
        """Wrap a network.

        Args:
            network: Moved to the device of the views when it scores.
            vocabulary: The one it was trained with.
        """
        self.network = network
        self.vocabulary = vocabulary
        self._embeddings: OrderedDict[str, tuple[str, torch.Tensor]] = OrderedDict()

    def score(
        self, views: HouseViews, panoramas: torch.Tensor, commands: Sequence[str]
    ) -> torch.Tensor:
        """Score the panoramas of each command: float [command, cell], without gradients."""
        with torch.no_grad():
            embeddings = self._encode(views)
            tokens, lengths = (
                tensor.to(embeddings.device) for tensor in self.vocabulary.encode(commands)
            )
            embedded = self.network.embed_commands(tokens, lengths)
            parts = [
                self.network.score(embeddings, panoramas[rows], embedded[rows])
                for rows in _chunks(len(commands))
            ]
            return torch.cat(parts) if parts else embeddings.new_zeros(panoramas.shape)

    def save(self, folder: Path) -> None:
        """Write `reward.safetensors`, then `config.json`, into `folder`."""
        tensors = {name: value.contiguous() for name, value in self.network.state_dict().items()}
        config = {
            "network": dataclasses.asdict(self.network.config),
            "vocabulary": list(self.vocabulary.words),
        }
        write_bytes(folder / WEIGHTS_FILE, save_tensors(tensors))
        write_json(folder / CONFIG_FILE, config)

    @classmethod
    def load(cls, folder: Path) -> NetworkReward:
        """Read back what `save` wrote.

        Raises:
            InvalidFileError: If a file is missing, damaged, or does not fit the other.
        """
        path = folder / CONFIG_FILE
        try:
            document = read_json(path)
            config = RewardNetworkConfig(**document["network"])
            vocabulary = Vocabulary(tuple(document["vocabulary"]))
        except (KeyError, TypeError) as error:
            raise InvalidFileError(path, f"not a reward: {error}", fix="Train it again.") from error
        network = RewardNetwork(config, words=len(vocabulary), generator=torch.Generator())
        path = folder / WEIGHTS_FILE
        try:
            network.load_state_dict(load_tensors(path.read_bytes()))
        except (OSError, SafetensorError, RuntimeError) as error:
            reason = f"can't be read as the weights of this reward: {error}"
            raise InvalidFileError(path, reason, fix="Train it again.") from error
        return cls(network.requires_grad_(False), vocabulary)

    def _encode(self, views: HouseViews) -> torch.Tensor:
        """The panorama embeddings of a house, kept while house and weights stay the same."""
        self.network.to(views.views.device)
        content = (views.views, views.panorama_views, *self.network.state_dict().values())
        digest = sha256_of(b"".join(tensor.cpu().numpy().tobytes() for tensor in content))
        digest += str(views.views.device)
        kept = self._embeddings.pop(views.house, None)
        if kept is None or kept[0] != digest:
            index = build_index(views.views, views.panorama_views, self.network.config)
            kept = (digest, self.network.encode(index))
        self._embeddings[views.house] = kept
        while len(self._embeddings) > _HOUSES_KEPT:
            self._embeddings.popitem(last=False)
        return kept[1]


def config_document(config: Any) -> dict[str, Any]:  # noqa: ANN401 - any dataclass
    """A configuration as JSON values, so that it compares equal after a round trip."""
    return json.loads(json.dumps(dataclasses.asdict(config)))


def _chunks(count: int) -> list[slice]:
    """Rows in parts small enough that their activations fit in a few megabytes."""
    return [slice(first, first + _COMMANDS_AT_ONCE) for first in range(0, count, _COMMANDS_AT_ONCE)]
