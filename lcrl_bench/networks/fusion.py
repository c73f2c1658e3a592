"""How embeddings combine: four views to a panorama's, and that with the command's.

Source: Fu et al. (2019), section "Architecture": the views' "outputs are summed together to form
the image embedding", which is multiplied with the command's; Mult, Add and Concat are the
appendix's sweep. The maximum over views is ours: one global maximum over the panorama instead of a
sum of four.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import torch

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.networks.gathering import Bags, gather_bags, sum_bags

FusionName = Literal["mult", "add", "concat"]
ViewsName = Literal["sum", "max"]


def _concatenate(image: torch.Tensor, command: torch.Tensor) -> torch.Tensor:
    return torch.cat(torch.broadcast_tensors(image, command), -1)


_FUSIONS: dict[str, Callable[[torch.Tensor, torch.Tensor], torch.Tensor]] = {
    "mult": torch.mul,
    "add": torch.add,
    "concat": _concatenate,
}


def fuse(name: str, image: torch.Tensor, command: torch.Tensor) -> torch.Tensor:
    """Combine two embeddings [..., size] into [..., size], or [..., 2 size] for `concat`.

    Raises:
        UnknownNameError: If there is no such fusion.
    """
    if name not in _FUSIONS:
        raise UnknownNameError("fusion", name, _FUSIONS)
    return _FUSIONS[name](image, command)


def fused_size(name: str, size: int) -> int:
    """Size of what `fuse` returns.

    Raises:
        UnknownNameError: If there is no such fusion.
    """
    if name not in _FUSIONS:
        raise UnknownNameError("fusion", name, _FUSIONS)
    return 2 * size if name == "concat" else size


def combine_views(name: ViewsName, views: torch.Tensor) -> torch.Tensor:
    """Combine stacked views: float [..., view, size] -> [..., size]."""
    return views.sum(-2) if name == "sum" else views.amax(-2)


def gather_panoramas(name: ViewsName, views: torch.Tensor, panoramas: Bags) -> torch.Tensor:
    """Combine the views of every panorama of a house.

    Args:
        name: sum or max.
        views: float [view, size].
        panoramas: [panorama, 4] into views.

    Returns:
        float [panorama, size].
    """
    if name == "sum":
        return sum_bags(views, panoramas)
    return combine_views(name, gather_bags(views, panoramas).unflatten(-1, (-1, views.shape[1])))
