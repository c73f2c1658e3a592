"""A training house, prepared: repeated patches, numbered words, visits of the demonstrations."""

from __future__ import annotations

from dataclasses import dataclass

import torch

from lcrl_bench.mdp.dynamics import fold_cells
from lcrl_bench.mdp.task_batch import HEADINGS, TaskBatch
from lcrl_bench.mdp.visitation import empirical_occupancy, occupancy, occupancy_mass
from lcrl_bench.methods.contract import TrainHouse
from lcrl_bench.networks.grounding import HouseIndex, NetworkConfig, build_index
from lcrl_bench.networks.vocabulary import Vocabulary


@dataclass(frozen=True)
class PreparedTasks:
    """The tasks of one kind in a house, and what stays the same at every step."""

    batch: TaskBatch
    panoramas: torch.Tensor
    """int64 [task, cell]."""
    held: torch.Tensor
    """bool [task, cell]: whether the object is in the agent's hand."""
    rows: slice
    """Which of the house's commands are these tasks'."""
    rho_demonstrations: torch.Tensor
    """float [task, cell]: discounted visits of the demonstrations; `mass` in all."""
    last_cells: torch.Tensor
    """int64 [task, demonstration]: the cell each demonstration ends in."""
    expert: torch.Tensor | None
    """float [task, state, action]; see `TaskSet.expert`."""
    expert_visits: torch.Tensor | None
    """float [task, state]: its occupancy, a distribution."""

    @property
    def mass(self) -> float:
        """Total of an occupancy: dividing by it makes tasks weigh the same for any horizon."""
        return occupancy_mass(self.batch.horizon, self.batch.discount)


@dataclass(frozen=True)
class PreparedHouse:
    """A training house."""

    index: HouseIndex
    mirrored: HouseIndex | None
    """The same of the house's mirror image, where training looks at it."""
    tokens: torch.Tensor
    """int64 [command, word]: the commands of all kinds."""
    lengths: torch.Tensor
    """int64 [command]."""
    tasks: tuple[PreparedTasks, ...]
    """One a kind."""

    @property
    def count(self) -> int:
        """Number of tasks, of all kinds."""
        return len(self.lengths)

    def look(self, generator: torch.Generator) -> HouseIndex:
        """What a step sees: the house or, where it was prepared, its mirror image as often.

        Args:
            generator: A CPU generator; not touched if there is no mirror image.
        """
        if self.mirrored is None or torch.rand((), generator=generator) < 0.5:
            return self.index
        return self.mirrored


def prepare_house(
    house: TrainHouse,
    vocabulary: Vocabulary,
    config: NetworkConfig,
    device: torch.device,
    *,
    mirror: bool = False,
) -> PreparedHouse:
    """Compute once what every step of a training needs of a house, and of its mirror image."""
    commands = [command for tasks in house.tasks for command in tasks.commands]
    tokens, lengths = vocabulary.encode(commands)
    prepared, first = [], 0
    for tasks in house.tasks:
        batch = tasks.batch.to(device)
        demonstrations = tasks.demonstrations.to(device)
        expert = None if tasks.expert is None else tasks.expert.to(device)
        rho = empirical_occupancy(batch, demonstrations, discount=batch.discount)
        prepared.append(
            PreparedTasks(
                batch=batch,
                panoramas=tasks.panoramas.to(device),
                held=tasks.held.to(device),
                rows=slice(first, first + batch.tasks),
                rho_demonstrations=fold_cells(rho),
                last_cells=demonstrations[:, :, -1] // HEADINGS,
                expert=expert,
                expert_visits=None if expert is None else _visits(batch, expert),
            )
        )
        first += batch.tasks
    views, panorama_views = house.views.views, house.views.panorama_views
    index = build_index(views, panorama_views, config).to(device)
    mirrored = None
    if mirror:
        # East and west change places, and so do the columns of every view.
        swapped = panorama_views[:, [0, 3, 2, 1]]
        mirrored = build_index(views.flip(-1), swapped, config).to(device)
    return PreparedHouse(index, mirrored, tokens.to(device), lengths.to(device), tuple(prepared))


def _visits(batch: TaskBatch, policy: torch.Tensor) -> torch.Tensor:
    """Where a stationary policy goes: float [task, state], one in all."""
    timed = policy[:, None].expand(-1, batch.horizon, -1, -1)
    rho = occupancy(batch, timed, discount=batch.discount)
    return rho / occupancy_mass(batch.horizon, batch.discount)
