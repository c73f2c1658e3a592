"""A trained network and its vocabulary on disk: `config.json` and a file of weights."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Final, TypeVar

import torch
from safetensors import SafetensorError
from safetensors.torch import load as load_tensors
from safetensors.torch import save as save_tensors

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.networks.grounding import Grounding, NetworkConfig
from lcrl_bench.networks.vocabulary import Vocabulary
from lcrl_bench.storage import read_json, write_bytes, write_json

CONFIG_FILE: Final = "config.json"
_FIX: Final = "Train it again."

SomeNetwork = TypeVar("SomeNetwork", bound=Grounding)


def save_network(
    folder: Path, network: Grounding, vocabulary: Vocabulary, *, kind: str, **others: str
) -> None:
    """Write `<kind>.safetensors`, then `config.json`, into `folder`.

    Args:
        folder: Where to.
        network: Its weights and sizes are saved.
        vocabulary: The one it was trained with.
        kind: `"reward"` or `"policy"`.
        others: Further settings.
    """
    tensors = {name: value.contiguous() for name, value in network.state_dict().items()}
    config = {
        "network": dataclasses.asdict(network.config),
        "vocabulary": list(vocabulary.words),
        **others,
    }
    write_bytes(folder / _weights_file(kind), save_tensors(tensors))
    write_json(folder / CONFIG_FILE, config)


def load_network(
    folder: Path, make: Callable[..., SomeNetwork], *, kind: str
) -> tuple[SomeNetwork, Vocabulary, dict[str, str]]:
    """Read back what `save_network` wrote; the network needs no gradients.

    Args:
        folder: Where from.
        make: The network's class.
        kind: As it was saved.

    Returns:
        The network, its vocabulary, and the further settings.

    Raises:
        InvalidFileError: If a file is missing, damaged, or does not fit the other.
    """
    path = folder / CONFIG_FILE
    try:
        document = read_json(path)
        config = NetworkConfig(**document["network"])
        vocabulary = Vocabulary(tuple(document["vocabulary"]))
        others = {key: document[key] for key in document.keys() - {"network", "vocabulary"}}
        network = make(config, words=len(vocabulary), generator=torch.Generator())
    except (KeyError, TypeError) as error:
        raise InvalidFileError(path, f"not a {kind}: {error}", fix=_FIX) from error
    path = folder / _weights_file(kind)
    try:
        network.load_state_dict(load_tensors(path.read_bytes()))
    except (OSError, SafetensorError, RuntimeError) as error:
        reason = f"can't be read as the weights of this {kind}: {error}"
        raise InvalidFileError(path, reason, fix=_FIX) from error
    return network.requires_grad_(False), vocabulary, others


def _weights_file(kind: str) -> str:
    return f"{kind}.safetensors"
