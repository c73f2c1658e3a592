"""Training state in one file, so that a killed run resumes to the same bits.

One safetensors file holds the weights, the optimizer's state and the generator's; its header says
which training it is and how far it is. One file, because a kill could tear a pair apart.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save as save_tensors

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.methods.contract import Method, TrainSet
from lcrl_bench.methods.source import method_source, suite_source
from lcrl_bench.storage import canonical_json, sha256_of, write_bytes
from lcrl_bench.version import __version__

STATE_FILE: Final = "state.safetensors"
_GENERATOR: Final = "generator"
_FIX: Final = "Delete it to train afresh."


def save_checkpoint(
    folder: Path,
    network: torch.nn.Module,
    optimizer: torch.optim.Optimizer,
    generator: torch.Generator,
    *,
    done: int,
    identity: str,
) -> None:
    """Write the training state atomically.

    Args:
        folder: Where the file goes; made if need be.
        network: Its weights are saved.
        optimizer: Its state is saved, its hyper-parameters are not.
        generator: Its state is saved.
        done: Passes done, to resume from.
        identity: What `training_identity` returned: no other training resumes from it.
    """
    tensors = {f"network.{name}": value for name, value in network.state_dict().items()}
    for number, state in optimizer.state_dict()["state"].items():
        tensors |= {f"optimizer.{number}.{name}": value for name, value in state.items()}
    tensors[_GENERATOR] = generator.get_state()
    tensors = {name: value.detach().cpu().contiguous() for name, value in tensors.items()}
    write_bytes(
        folder / STATE_FILE, save_tensors(tensors, {"done": str(done), "identity": identity})
    )


def restore_checkpoint(
    folder: Path,
    network: torch.nn.Module,
    optimizer: torch.optim.Optimizer,
    generator: torch.Generator,
    *,
    identity: str,
) -> int:
    """Restore the training state of a checkpoint.

    Args:
        folder: Where the file is; if there is none, nothing happens.
        network: Its weights are restored.
        optimizer: Its state is restored.
        generator: Its state is restored.
        identity: What `training_identity` returned.

    Returns:
        Passes done; 0 without a file.

    Raises:
        InvalidFileError: If the file is damaged, or of another training.
    """
    path = folder / STATE_FILE
    if not path.exists():
        return 0
    try:
        with safe_open(path, framework="pt") as file:
            header = file.metadata() or {}
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if header.get("identity") != identity:
            reason = "a checkpoint of other code, data, settings or seed"
            raise InvalidFileError(path, reason, fix=_FIX)
        generator.set_state(tensors.pop(_GENERATOR))
        network.load_state_dict(_under("network", tensors))
        groups = optimizer.state_dict()["param_groups"]
        state: dict[int, dict[str, torch.Tensor]] = {}
        for name, value in _under("optimizer", tensors).items():
            number, _, field = name.partition(".")
            state.setdefault(int(number), {})[field] = value
        optimizer.load_state_dict({"state": state, "param_groups": groups})
        return int(header["done"])
    except (OSError, SafetensorError, KeyError, ValueError, RuntimeError) as error:
        raise InvalidFileError(path, f"not a usable checkpoint: {error}", fix=_FIX) from error


def training_identity(
    method: type[Method], train: TrainSet, config: dict[str, Any], generator: torch.Generator
) -> str:
    """Digest of everything that determines a training: code, data, settings, seed.

    Args:
        method: The method's class.
        train: The training set.
        config: Settings, as JSON values.
        generator: As it is handed to `fit`, before anything is drawn from it.
    """
    code = [__version__, suite_source(method), method_source(method)]
    parts = [canonical_json([code, config, train.vocabulary]), _bytes(generator.get_state())]
    for house in train.houses:
        parts += [house[0].views.house.encode(), _bytes(house[0].views.views)]
        for tasks in house:
            parts += [canonical_json(tasks.commands), _bytes(tasks.panoramas)]
            parts += [_bytes(tasks.demonstrations), _bytes(tasks.next_state)]
            # An oracle's training depends on the goals too.
            parts += [_bytes(tasks.goal)]
    return sha256_of("".join(sha256_of(part) for part in parts).encode())


def _bytes(tensor: torch.Tensor) -> bytes:
    return tensor.cpu().contiguous().numpy().tobytes()


def _under(prefix: str, tensors: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """The tensors whose names begin with `prefix.`, without it."""
    start = f"{prefix}."
    return {
        name.removeprefix(start): value for name, value in tensors.items() if name.startswith(start)
    }
