"""Cache of panorama features for the most recent houses, and commands in chunks."""

from __future__ import annotations

from collections import OrderedDict
from typing import Final

import torch

from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.networks.grounding import Grounding
from lcrl_bench.networks.index_store import cached_index
from lcrl_bench.storage import sha256_of

_HOUSES_KEPT: Final = 2
_NUMBERS_AT_ONCE: Final = 1 << 21


class EncodedHouses:
    """Caches the panorama features of a house while the house and the weights stay the same."""

    def __init__(self, network: Grounding) -> None:
        """Wrap a network, which is moved to the device of the views when it encodes."""
        self.network = network
        self._kept: OrderedDict[str, tuple[str, torch.Tensor]] = OrderedDict()

    def encode(self, views: Panoramas) -> torch.Tensor:
        """The features of every panorama, without gradients: float [panorama, feature]."""
        self.network.to(views.views.device)
        content = (views.views, views.panorama_views, *self.network.state_dict().values())
        digest = sha256_of(b"".join(tensor.cpu().numpy().tobytes() for tensor in content))
        digest += str(views.views.device)
        kept = self._kept.pop(views.house, None)
        if kept is None or kept[0] != digest:
            index = cached_index(views.views, views.panorama_views, self.network.config)
            with torch.no_grad():
                kept = (digest, self.network.encode(index))
        self._kept[views.house] = kept
        while len(self._kept) > _HOUSES_KEPT:
            self._kept.popitem(last=False)
        return kept[1]


def command_chunks(panoramas: torch.Tensor, *, numbers: int) -> list[slice]:
    """Split commands into chunks whose activations fit in a few megabytes.

    Args:
        panoramas: int64 [command, cell].
        numbers: Activations per cell, where there are most.
    """
    commands, cells = panoramas.shape
    at_once = max(1, _NUMBERS_AT_ONCE // max(1, cells * numbers))
    return [slice(first, first + at_once) for first in range(0, commands, at_once)]
