"""`NetworkMethod`: what all methods share that train the paper's network house by house.

Such a method is its objective: what one step descends on the tasks of a house. What it learns, a
`NetworkReward` or a `NetworkPolicy`, says which network is trained. Initial weights, preparation,
schedule and checkpoints are here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

import torch

from lcrl_bench.methods.checkpoint import training_identity
from lcrl_bench.methods.contract import Log, Method, Policy, Reward, TrainSet
from lcrl_bench.methods.network_policy import NetworkPolicy
from lcrl_bench.methods.network_reward import NetworkReward, config_document
from lcrl_bench.methods.preparation import PreparedHouse, prepare_house
from lcrl_bench.methods.training import Opponent, Row, TrainingConfig, train_house_by_house
from lcrl_bench.networks.grounding import Grounding, NetworkConfig
from lcrl_bench.networks.standardisation import fold_scale, standardise
from lcrl_bench.networks.vocabulary import Vocabulary
from lcrl_bench.streamed import of_each

SomeConfig = TypeVar("SomeConfig", bound=TrainingConfig)
SomeNetwork = TypeVar("SomeNetwork", bound=Grounding)

HouseObjective = Callable[[int, torch.Tensor, torch.Tensor], tuple[torch.Tensor, Row]]
"""Takes the number of a house, and features and commands as `NetworkMethod.objective`; returns what
a step descends on all tasks of the house, and what it logs."""


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
        """The trained network, as the harness uses it."""
        make: Any = self.learns
        return make(network, vocabulary)

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
        raise NotImplementedError(f"{type(self).__name__} defines neither objective nor lessons.")

    def lessons(
        self, network: SomeNetwork, houses: Sequence[PreparedHouse], generator: torch.Generator
    ) -> tuple[HouseObjective, Opponent | None]:
        """What a step descends, and what trains against the network: `objective`, and nothing.

        A method with an opponent defines this one instead of `objective`.

        Args:
            network: Before training.
            houses: The training houses.
            generator: A CPU generator.
        """

        def objective(
            number: int, features: torch.Tensor, commands: torch.Tensor
        ) -> tuple[torch.Tensor, Row]:
            descended, loss = self.objective(network, features, commands, houses[number])
            return descended, {"loss": loss}

        return objective, None

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
            standardise(network, (house[0].views.views for house in train.houses))
        network.to(device)
        houses = of_each(
            lambda house: prepare_house(
                house, vocabulary, sizes, device, mirror=self.config.mirror
            ),
            train.houses,
        )
        objective, opponent = self.lessons(network, houses, generator)

        def step(number: int) -> tuple[torch.Tensor, Row]:
            house = houses[number]
            mirrored = house.draw_mirrored(generator)
            features = network.encode(house.index, mirrored=mirrored)
            features = drop_features(features, sizes.size, self.config.dropout, generator)
            commands = network.embed_commands(house.tokens, house.lengths)
            return objective(number, features, commands)

        train_house_by_house(
            network,
            step,
            self.config,
            houses=len(houses),
            generator=generator,
            log=log,
            identity=identity,
            checkpoint=checkpoint,
            opponent=opponent,
        )
        fold_scale(network)
        return self.wrap(network.requires_grad_(False), vocabulary)


def network_config(config: TrainingConfig, train: TrainSet) -> NetworkConfig:
    """Sizes of the network that `config` asks for, for the views of `train`."""
    height, width = train.tasks[0].views.views.shape[1:]
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
    """Drop the same features from every panorama, for one step.

    Because the same ones are missing everywhere, all states of a house are still compared by one
    and the same reward.

    Args:
        features: float [panorama, feature], a multiple of `size` features.
        size: Length of an embedding.
        rate: Fraction dropped, in [0, 1); the others are scaled by 1 / (1 - rate).
        generator: A CPU generator; not touched if the rate is 0.
    """
    if not rate:
        return features
    kept = (torch.rand(size, generator=generator) >= rate).to(features) / (1.0 - rate)
    return (features.unflatten(-1, (-1, size)) * kept).flatten(-2)
