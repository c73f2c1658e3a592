"""A prepared training house: distinct patches and word indices, computed once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import torch

from lcrl_bench.methods.contract import TaskSet
from lcrl_bench.networks.grounding import HouseIndex, NetworkConfig, build_index
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class PreparedHouse:
    """A training house: its tasks by kind, and what is the same in every step."""

    index: HouseIndex
    mirrored: HouseIndex | None
    """The same for the house's mirror image, if training uses it."""
    tokens: torch.Tensor
    """int64 [command, word]: the commands of all kinds."""
    lengths: torch.Tensor
    """int64 [command]."""
    tasks: tuple[TaskSet, ...]
    """One per kind."""

    @property
    def count(self) -> int:
        """Number of tasks, of all kinds."""
        return len(self.lengths)

    def with_commands(self, commands: torch.Tensor) -> Iterator[tuple[TaskSet, torch.Tensor]]:
        """Each task set with its rows of an array over the house's commands.

        Args:
            commands: [command, ...]: one row per command of the house, in order.
        """
        first = 0
        for tasks in self.tasks:
            yield tasks, commands[first : first + len(tasks)]
            first += len(tasks)

    def look(self, generator: torch.Generator) -> HouseIndex:
        """What a step sees: the house, or its mirror image half of the time if there is one.

        Args:
            generator: A CPU generator; unused if there is no mirror image.
        """
        if self.mirrored is None or torch.rand((), generator=generator) < 0.5:
            return self.index
        return self.mirrored


def prepare_house(
    house: Sequence[TaskSet],
    vocabulary: Vocabulary,
    config: NetworkConfig,
    device: torch.device,
    *,
    mirror: bool = False,
) -> PreparedHouse:
    """Compute once what every training step needs of a house and its mirror image.

    Args:
        house: Its task sets, as in `TrainSet.houses`.
        vocabulary: Gives words their indices.
        config: Sizes of the network.
        device: Where to compute.
        mirror: Whether to include the mirror image.
    """
    commands = [command for tasks in house for command in tasks.commands]
    tokens, lengths = vocabulary.encode(commands)
    seen = house[0].views
    there = seen.to(device)
    index = build_index(seen.views, seen.panorama_views, config).to(device)
    mirrored = None
    if mirror:
        # East and west change places, and so do the columns of every view.
        swapped = seen.panorama_views[:, [0, 3, 2, 1]]
        mirrored = build_index(seen.views.flip(-1), swapped, config).to(device)
    return PreparedHouse(
        index=index,
        mirrored=mirrored,
        tokens=tokens.to(device),
        lengths=lengths.to(device),
        tasks=tuple(replace(tasks.to(device), views=there) for tasks in house),
    )
