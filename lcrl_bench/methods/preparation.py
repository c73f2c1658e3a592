"""A prepared training house: distinct patches and word indices, computed once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import torch

from lcrl_bench.methods.contract import TaskSet
from lcrl_bench.networks.grounding import HouseIndex, NetworkConfig
from lcrl_bench.networks.index_store import cached_index
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class PreparedHouse:
    """A training house: its tasks by kind, and what is the same in every step."""

    index: HouseIndex
    mirror: bool
    """Whether training uses the house's mirror image too."""
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

    def draw_mirrored(self, generator: torch.Generator) -> bool:
        """Whether a step sees the mirror image: half of the time, if training uses it.

        Args:
            generator: A CPU generator; not touched if training doesn't use it.
        """
        return self.mirror and not bool(torch.rand((), generator=generator) < 0.5)


def prepare_house(
    house: Sequence[TaskSet],
    vocabulary: Vocabulary,
    config: NetworkConfig,
    device: torch.device,
    *,
    mirror: bool = False,
) -> PreparedHouse:
    """Compute once what every training step needs of a house.

    Args:
        house: Its task sets, as in `TrainSet.houses`.
        vocabulary: Gives words their indices.
        config: Sizes of the network.
        device: Where to compute.
        mirror: Whether training uses the mirror image too.
    """
    commands = [command for tasks in house for command in tasks.commands]
    tokens, lengths = vocabulary.encode(commands)
    seen = house[0].views
    there = seen.to(device)
    index = cached_index(seen.views, seen.panorama_views, config).to(device)
    return PreparedHouse(
        index=index,
        mirror=mirror,
        tokens=tokens.to(device),
        lengths=lengths.to(device),
        tasks=tuple(replace(tasks.to(device), views=there) for tasks in house),
    )
