"""The networks of the paper: panorama encoder, command encoder, fusion. No training loops."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.networks.command_encoder import CommandEncoder as CommandEncoder
    from lcrl_bench.networks.connected_encoder import ConnectedEncoder as ConnectedEncoder
    from lcrl_bench.networks.film_encoder import FilmEncoder as FilmEncoder
    from lcrl_bench.networks.grounding import Grounding as Grounding
    from lcrl_bench.networks.grounding import HouseIndex as HouseIndex
    from lcrl_bench.networks.grounding import NetworkConfig as NetworkConfig
    from lcrl_bench.networks.grounding import build_index as build_index
    from lcrl_bench.networks.panorama_encoder import PanoramaEncoder as PanoramaEncoder
    from lcrl_bench.networks.patches import PatchIndex as PatchIndex
    from lcrl_bench.networks.patches import build_patch_index as build_patch_index
    from lcrl_bench.networks.policy_network import PolicyNetwork as PolicyNetwork
    from lcrl_bench.networks.positions import PositionIndex as PositionIndex
    from lcrl_bench.networks.positions import build_position_index as build_position_index
    from lcrl_bench.networks.reward_network import RewardNetwork as RewardNetwork
    from lcrl_bench.networks.standardisation import class_shares as class_shares
    from lcrl_bench.networks.standardisation import fold_scale as fold_scale
    from lcrl_bench.networks.standardisation import standardise as standardise
    from lcrl_bench.networks.vocabulary import UNKNOWN as UNKNOWN
    from lcrl_bench.networks.vocabulary import Vocabulary as Vocabulary
    from lcrl_bench.networks.vocabulary import tokenise as tokenise
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "CommandEncoder": ".command_encoder",
            "ConnectedEncoder": ".connected_encoder",
            "FilmEncoder": ".film_encoder",
            "Grounding": ".grounding",
            "HouseIndex": ".grounding",
            "NetworkConfig": ".grounding",
            "build_index": ".grounding",
            "PanoramaEncoder": ".panorama_encoder",
            "PatchIndex": ".patches",
            "build_patch_index": ".patches",
            "PolicyNetwork": ".policy_network",
            "PositionIndex": ".positions",
            "build_position_index": ".positions",
            "RewardNetwork": ".reward_network",
            "class_shares": ".standardisation",
            "fold_scale": ".standardisation",
            "standardise": ".standardisation",
            "UNKNOWN": ".vocabulary",
            "Vocabulary": ".vocabulary",
            "tokenise": ".vocabulary",
        },
    )
