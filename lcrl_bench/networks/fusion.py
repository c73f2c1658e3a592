"""How a panorama's and a command's vectors become one: multiplied, added or laid side by side.

Source: Fu et al. (2019), section "Architecture" (multiplied) and the appendix's sweep (Mult, Add,
Concat).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import torch

from lcrl_bench.errors import UnknownNameError

FusionName = Literal["mult", "add", "concat"]


def _concatenate(image: torch.Tensor, command: torch.Tensor) -> torch.Tensor:
    return torch.cat(torch.broadcast_tensors(image, command), -1)


_FUSIONS: dict[str, Callable[[torch.Tensor, torch.Tensor], torch.Tensor]] = {
    "mult": torch.mul,
    "add": torch.add,
    "concat": _concatenate,
}


def fuse(name: str, image: torch.Tensor, command: torch.Tensor) -> torch.Tensor:
    """Combine embeddings: float [..., size] twice -> [..., size], or [..., 2 size] for `concat`.

    Raises:
        UnknownNameError: If there is no such fusion.
    """
    if name not in _FUSIONS:
        raise UnknownNameError("fusion", name, _FUSIONS)
    return _FUSIONS[name](image, command)


def fused_size(name: str, size: int) -> int:
    """Length of what `fuse` returns.

    Raises:
        UnknownNameError: If there is no such fusion.
    """
    if name not in _FUSIONS:
        raise UnknownNameError("fusion", name, _FUSIONS)
    return 2 * size if name == "concat" else size
