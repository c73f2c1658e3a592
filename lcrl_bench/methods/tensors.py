"""`TensorReward` and `TensorPolicy`: what is learned is a dictionary of tensors.

Derive what a method learns from one of them, write `score` or `logits`, and leave the constructor
as it is: saving and loading are given.

    class Counting(TensorReward):
        def score(self, views, commands):
            weights = self.to(views.views.device).tensors["weights"]
            ...

    reward = Counting({"weights": weights}, {"temperature": 0.5})
    reward.save(folder)
    Counting.load(folder)

On disk: `tensors.safetensors`, and `config.json` with the settings and the names of the tensors.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Self

import torch
from safetensors import SafetensorError
from safetensors.torch import load as load_tensors
from safetensors.torch import save as save_tensors

from lcrl_bench.errors import InvalidFileError, UsageError
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.storage import canonical_json, read_json, write_bytes, write_json

CONFIG_FILE: Final = "config.json"
TENSORS_FILE: Final = "tensors.safetensors"
_FIX: Final = "Train it again."


class _Tensors:
    """Tensors and settings, and their files."""

    def __init__(
        self,
        tensors: Mapping[str, torch.Tensor] | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> None:
        """Keep what was learned.

        Args:
            tensors: Name -> tensor of any shape and dtype; kept without gradients.
            settings: JSON values that are needed to use them.

        Raises:
            UsageError: If a setting is no JSON value.
        """
        self.tensors = {name: tensor.detach() for name, tensor in (tensors or {}).items()}
        """Name -> tensor, without gradients."""
        try:
            # As they are when they are read back: tuples are lists then.
            self.settings: dict[str, Any] = json.loads(canonical_json(dict(settings or {})))
            """JSON values."""
        except (TypeError, ValueError) as error:
            reason = f"can't be saved as JSON: {error}. Use numbers, strings, lists and mappings."
            raise UsageError(f"The settings of {type(self).__name__} {reason}") from error

    def to(self, device: torch.device) -> Self:
        """Move all tensors to a device, that of the views for example; returns itself."""
        self.tensors = {name: tensor.to(device) for name, tensor in self.tensors.items()}
        return self

    def save(self, folder: Path) -> None:
        """Write `tensors.safetensors`, then `config.json`, into `folder`."""
        # Cloned: safetensors refuses tensors that share memory, and views of larger ones.
        tensors = {name: tensor.cpu().contiguous().clone() for name, tensor in self.tensors.items()}
        write_bytes(folder / TENSORS_FILE, save_tensors(tensors))
        config = {"settings": self.settings, "tensors": sorted(tensors)}
        write_json(folder / CONFIG_FILE, config)

    @classmethod
    def load(cls, folder: Path) -> Self:
        """Read back what `save` wrote, on the CPU.

        Raises:
            InvalidFileError: If a file is missing, damaged, or does not fit the other.
        """
        path = folder / CONFIG_FILE
        try:
            document = read_json(path)
            settings, names = dict(document["settings"]), list(document["tensors"])
        except (KeyError, TypeError, ValueError) as error:
            reason = f"not the settings of saved tensors: {error!r}"
            raise InvalidFileError(path, reason, fix=_FIX) from error
        path = folder / TENSORS_FILE
        try:
            tensors = load_tensors(path.read_bytes())
        except (OSError, SafetensorError) as error:
            raise InvalidFileError(path, f"can't be read: {error}", fix=_FIX) from error
        if sorted(tensors) != names:
            reason = f"holds {sorted(tensors)}, but {CONFIG_FILE} beside it names {names}"
            raise InvalidFileError(path, reason, fix=_FIX)
        return cls(tensors, settings)


class TensorReward(_Tensors, Reward):
    """A reward that is made of tensors; subclasses write `score`."""


class TensorPolicy(_Tensors, Policy):
    """A policy that is made of tensors; subclasses write `logits`."""
