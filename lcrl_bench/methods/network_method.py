"""`NetworkMethod`: what all methods share that train the paper's network house by house.

Such a method is its objective: what one step descends on the tasks of a house. What it learns, a
`NetworkReward` or a `NetworkPolicy`, says which network is trained. Initial weights, preparation,
schedule and checkpoints are here.
"""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

import torch

from lcrl_bench.methods.checkpoint import training_identity
from lcrl_bench.methods.contract import Log, Method, Policy, Reward, TrainSet
from lcrl_bench.methods.network_policy import NetworkPolicy
from lcrl_bench.methods.network_reward import NetworkReward, config_document
from lcrl_bench.methods.preparation import PreparedHouse, prepare_house
from lcrl_bench.methods.training import TrainingConfig, train_house_by_house
from lcrl_bench.networks.grounding import Grounding, NetworkConfig
from lcrl_bench.networks.standardisation import settle, standardise
from lcrl_bench.networks.vocabulary import Vocabulary

SomeConfig = TypeVar("SomeConfig", bound=TrainingConfig)
SomeNetwork = TypeVar("SomeNetwork", bound=Grounding)


class NetworkMethod(Method, Generic[SomeConfig, SomeNetwork]):
    """A method that trains a network; subclasses define `learns`, `Config` and `objective`."""

    learns: ClassVar[type[NetworkReward] | type[NetworkPolicy]]
    """What the network becomes after training; `learns.Network` is trained."""
    Config: ClassVar[type[TrainingConfig]]

    def __init__(self, config: SomeConfig | None = None) -> None:
        """Keep the settings; None for the defaults."""
        self.config: SomeConfig = config or self.Config()  # type: ignore[assignment]

    def make_network(
        self, config: NetworkConfig, *, words: int, generator: torch.Generator
    ) -> SomeNetwork:
        """The network before training."""
        make: Any = self.learns.Network
        return make(config, words=words, generator=generator)

    def wrap(self, network: SomeNetwork, vocabulary: Vocabulary) -> NetworkReward | NetworkPolicy:
        """The network after training, as the harness meets it."""
        make: Any = self.learns
        return make(network, vocabulary)

    @abstractmethod
    def objective(
        self,
        network: SomeNetwork,
        features: torch.Tensor,
        commands: torch.Tensor,
        house: PreparedHouse,
    ) -> tuple[torch.Tensor, float]:
        """What a step descends on all tasks of a house, and the loss to report.

        Args:
            network: In training.
            features: float [panorama, feature]: what it sees in the house.
            commands: float [command, size]: the commands of the house, embedded.
            house: Its tasks.
        """

    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> Reward | Policy:
        """Learn from `train`; see `Method.fit`."""
        identity = training_identity(type(self), train, config_document(self.config), generator)
        vocabulary = Vocabulary.of(train.vocabulary)
        sizes = network_config(self.config, train)
        network = self.make_network(sizes, words=len(vocabulary), generator=generator)
        if self.config.standardise:
            standardise(network, (house.views.views for house in train.houses))
        network.to(device)

        def step(house: PreparedHouse) -> tuple[torch.Tensor, float]:
            features = network.encode(house.look(generator))
            features = drop_features(features, sizes.size, self.config.dropout, generator)
            commands = network.embed_commands(house.tokens, house.lengths)
            return self.objective(network, features, commands, house)

        train_house_by_house(
            network,
            [
                prepare_house(house, vocabulary, sizes, device, mirror=self.config.mirror)
                for house in train.houses
            ],
            step,
            self.config,
            generator=generator,
            log=log,
            identity=identity,
            checkpoint=checkpoint,
        )
        settle(network)
        return self.wrap(network.requires_grad_(False), vocabulary)


def network_config(config: TrainingConfig, train: TrainSet) -> NetworkConfig:
    """Sizes of the network that `config` asks for, for the views of `train`."""
    height, width = train.houses[0].views.views.shape[1:]
    return NetworkConfig(
        filters=config.filters,
        size=config.size,
        hidden=config.hidden,
        fusion=config.fusion,
        image=config.image,
        views=config.views,
        height=height,
        width=width,
    )


def drop_features(
    features: torch.Tensor, size: int, rate: float, generator: torch.Generator
) -> torch.Tensor:
    """Leave some features out of every panorama alike, for one step.

    The same features are missing wherever the agent looks, so that the states of a house are still
    compared by one and the same reward.

    Args:
        features: float [panorama, feature], a multiple of `size` features.
        size: Length of an embedding.
        rate: Share that is left out; what is kept is scaled by 1 / (1 - rate).
        generator: A CPU generator; not touched if the rate is 0.
    """
    if not rate:
        return features
    kept = (torch.rand(size, generator=generator) >= rate).to(features) / (1.0 - rate)
    return (features.unflatten(-1, (-1, size)) * kept).flatten(-2)
