"""Grounds a command in a panorama: what the reward and the policy network share.

    e = fuse(image encoder(panorama), command encoder(command))

Every panorama of a house is encoded once, whatever the number of commands and object states that
use it (the paper's "Observation Caching"), and every command once per house.

Source: Fu et al. (2019), section "Architecture" and appendices.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, cast, get_args

import torch
from torch import nn

from lcrl_bench.errors import UnknownNameError
from lcrl_bench.networks.command_encoder import CommandEncoder
from lcrl_bench.networks.connected_encoder import ConnectedEncoder
from lcrl_bench.networks.film_encoder import FilmEncoder
from lcrl_bench.networks.fusion import (
    FusionName,
    ViewsName,
    combine_views,
    fuse,
    fused_size,
    gather_panoramas,
)
from lcrl_bench.networks.gathering import gather_rows
from lcrl_bench.networks.panorama_encoder import PanoramaEncoder
from lcrl_bench.networks.patches import PatchIndex, build_patch_index
from lcrl_bench.networks.positions import PositionIndex, build_position_index

ImageName = Literal["pooling", "film", "fc"]
HouseIndex = PatchIndex | PositionIndex
"""The distinct patches of a house's views, in the form that an image encoder needs."""


@dataclass(frozen=True)
class NetworkConfig:
    """Architecture of a network; the defaults are the paper's."""

    classes: int = 61
    """Number of semantic classes in a view."""
    filters: int = 16
    """Filters of the first convolution (5x5)."""
    size: int = 32
    """Filters of the second convolution (3x3), and size of word vectors and embeddings."""
    hidden: int = 32
    """Units of the fully connected layer before the output."""
    fusion: FusionName = "mult"
    """How embeddings combine: mult, add or concat."""
    image: ImageName = "pooling"
    """How a view is embedded: pooling, film or fc."""
    views: ViewsName = "sum"
    """How the embeddings of a panorama's four views combine: sum (the paper's) or max."""
    height: int = 24
    """Rows of a view; only fc depends on the size of views."""
    width: int = 32
    """Columns of a view."""


class Grounding(nn.Module):
    """Fused embeddings of (panorama, command) pairs: base of the reward and the policy network."""

    def __init__(self, config: NetworkConfig, *, words: int, generator: torch.Generator) -> None:
        """Draw initial weights.

        Args:
            config: Architecture.
            words: Size of the vocabulary, unknown word included.
            generator: A CPU generator; equal states give equal weights.

        Raises:
            UnknownNameError: If the image encoder or the combination of views is unknown.
        """
        super().__init__()
        if config.views not in get_args(ViewsName):
            raise UnknownNameError("combination of views", config.views, get_args(ViewsName))
        self.config = config
        self.image = _image_encoder(config, generator)
        self.command = CommandEncoder(words, size=config.size, generator=generator)

    @property
    def convolutions(self) -> PanoramaEncoder:
        """The convolutions of the image encoder, whatever its kind."""
        return self.image if isinstance(self.image, PanoramaEncoder) else self.image.convolutions

    @property
    def fused_size(self) -> int:
        """Size of a fused embedding."""
        return fused_size(self.config.fusion, self.config.size)

    def encode(self, index: HouseIndex, *, mirrored: bool = False) -> torch.Tensor:
        """Features of all panoramas of a house: float [panorama, feature].

        Args:
            index: What `build_index` returned.
            mirrored: Whether to encode the house's mirror image instead. East and west then change
                places too, which makes no difference: views are summed, or their maximum is taken.
        """
        if isinstance(self.image, FilmEncoder):
            return self.image(index, mirrored=mirrored)
        if isinstance(self.image, PanoramaEncoder):
            views = self.image.embed_views(cast(PatchIndex, index), mirrored=mirrored)
        else:
            views = self.image(index, mirrored=mirrored)
        return gather_panoramas(self.config.views, views, index.panoramas)

    def embed_commands(self, tokens: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
        """Embed commands: float [command, size].

        Args:
            tokens: int64 [command, word], as `Vocabulary.encode` gives.
            lengths: int64 [command].
        """
        return self.command(tokens, lengths)

    def ground(
        self, features: torch.Tensor, panoramas: torch.Tensor, commands: torch.Tensor
    ) -> torch.Tensor:
        """Fuse each command with the panoramas of its cells.

        Args:
            features: What `encode` returned.
            panoramas: int64 [command, cell], rows of `features`.
            commands: What `embed_commands` returned.

        Returns:
            float [command, cell, fused_size].
        """
        image = gather_rows(features, panoramas)
        if isinstance(self.image, FilmEncoder):
            image = combine_views(self.config.views, self.image.modulate(image, commands))
        return fuse(self.config.fusion, image, commands[:, None])


def build_index(
    views: torch.Tensor, panorama_views: torch.Tensor, config: NetworkConfig
) -> HouseIndex:
    """Index the distinct patches of a house's views, as the image encoder of `config` needs them.

    Args:
        views: uint8 [view, height, width]: class ids; sides even, for fc multiples of four.
        panorama_views: int64 [panorama, 4], indices into `views`.
        config: The network's architecture.

    Returns:
        An index on the device of `views`.

    Raises:
        ValueError: If a class id is not below `config.classes`, or the views' size does not fit.
    """
    if config.image == "fc":
        if views.shape[1:] != (config.height, config.width):
            found = f"{views.shape[1]} x {views.shape[2]}"
            wanted = f"{config.height} x {config.width}"
            raise ValueError(f"the network is for views of {wanted}, found views of {found}")
        return build_position_index(views, panorama_views, classes=config.classes)
    return build_patch_index(views, panorama_views, classes=config.classes)


def _image_encoder(
    config: NetworkConfig, generator: torch.Generator
) -> PanoramaEncoder | FilmEncoder | ConnectedEncoder:
    sizes = {"filters": config.filters, "size": config.size}
    if config.image == "pooling":
        return PanoramaEncoder(config.classes, **sizes, generator=generator)
    if config.image == "film":
        return FilmEncoder(config.classes, **sizes, generator=generator)
    if config.image == "fc":
        sizes |= {"height": config.height, "width": config.width}
        return ConnectedEncoder(config.classes, **sizes, generator=generator)
    raise UnknownNameError("image encoder", config.image, get_args(ImageName))
