"""How the embeddings of a panorama's four views become one.

Source: Fu et al. (2019), section "Architecture": "the outputs are summed together to form the image
embedding". The maximum is ours: one global maximum over the panorama instead of a sum of four.
"""

from __future__ import annotations

from typing import Literal

import torch

from lcrl_bench.networks.gathering import Bags, gather_bags, sum_bags

ViewsName = Literal["sum", "max"]


def combine_views(name: ViewsName, views: torch.Tensor) -> torch.Tensor:
    """Combine views that lie side by side: float [..., view, size] -> [..., size]."""
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
