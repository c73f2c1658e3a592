"""What a learned reward or policy is shown when it is asked, and how its answers become tables.

A state of a task is a tile, a heading and an object state; a learned reward may know of it only
what is seen there, a learned policy also the heading and whether the object is held. Numbers,
orders and shapes can spell the rest: in a house's own numbering a panorama's index tells where the
object is, so a reward that pays for high indices would find every goal of PICK. So each distinct
panorama is shown once, whatever tile or task it belongs to, in the order of a digest of its pixels;
each distinct command once, in alphabetical order; and the house under a digest of its views. The
answers are gathered to the cells of the tasks here, where the method can't see it.

Source: Fu et al. (2019), section "Multi-Task IRL": rewards are functions of an observation and a
command.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import ACTIONS, HEADINGS
from lcrl_bench.methods.contract import HouseViews, Policy, Reward
from lcrl_bench.storage import sha256_of


@dataclass(frozen=True, eq=False)
class ObservedHouse:
    """The distinct panoramas of a house, without anything that tells where they are seen."""

    views: HouseViews
    """Distinct views and panoramas, both in the order of their digests."""
    place: torch.Tensor
    """int64 [panorama of the house]: its number in `views`; -1 for one that is not shown."""

    @classmethod
    def of(cls, house: HouseViews, chosen: torch.Tensor | None = None) -> ObservedHouse:
        """Forget the numbering of a house.

        Args:
            house: The house.
            chosen: int64 [chosen]: panoramas to show; None for all. Nothing is kept of the views
                that are part of no other.
        """
        device = house.views.device
        sides = house.panorama_views if chosen is None else house.panorama_views[chosen]
        pixels = house.views.cpu().numpy()
        names = {k: sha256_of(pixels[k].tobytes()) for k in torch.unique(sides).tolist()}
        # Views that are equal count as one, whoever numbered them.
        views = {names[k]: k for k in names}
        order = {name: number for number, name in enumerate(sorted(views))}
        rows = sides.tolist()
        seen = [sha256_of("".join(names[k] for k in row).encode()) for row in rows]
        first = {name: row for name, row in zip(seen, rows, strict=True)}
        number = {name: k for k, name in enumerate(sorted(first))}
        shown = HouseViews(
            house=sha256_of("".join(number).encode()),
            views=house.views[torch.tensor([views[name] for name in order], device=device)],
            panorama_views=torch.tensor(
                [[order[names[k]] for k in first[name]] for name in number], device=device
            ),
        )
        place = torch.full((len(house.panorama_views),), -1, device=device)
        numbers = torch.tensor([number[name] for name in seen], device=device)
        place[slice(None) if chosen is None else chosen] = numbers
        return cls(shown, place)

    def show(self) -> HouseViews:
        """The views to hand to a method: copies, so that nothing it does to them stays."""
        views = self.views
        return HouseViews(views.house, views.views.clone(), views.panorama_views.clone())


@dataclass(frozen=True, eq=False)
class Answers:
    """What a learned reward or policy says of every panorama of a house under some commands."""

    values: torch.Tensor
    """float [command, panorama] of a reward, [command, panorama, held, heading, action] of a
    policy."""
    rows: dict[str, int]
    """Command -> its row in `values`."""
    place: torch.Tensor
    """int64 [panorama of the house]; see `ObservedHouse.place`."""

    @property
    def of_reward(self) -> bool:
        """Whether a reward was asked; else a policy was."""
        return self.values.ndim == 2

    def reward(self, panoramas: torch.Tensor, commands: Sequence[str]) -> torch.Tensor:
        """The reward of each cell: float64 [task, cell].

        Args:
            panoramas: int64 [task, cell], in the house's own numbering.
            commands: One of those asked per task.
        """
        return self.values[self._row(commands), self.place[panoramas]].double()

    def policy(
        self, panoramas: torch.Tensor, held: torch.Tensor, commands: Sequence[str]
    ) -> torch.Tensor:
        """The action probabilities in each state: float64 [task, state, action].

        Args:
            panoramas: int64 [task, cell], in the house's own numbering.
            held: bool [task, cell]: whether the object is in the agent's hand.
            commands: One of those asked per task.
        """
        logits = self.values[self._row(commands), self.place[panoramas], held.long()]
        return logits.double().softmax(-1).flatten(1, 2)

    def _row(self, commands: Sequence[str]) -> torch.Tensor:
        rows = [self.rows[command] for command in commands]
        return torch.tensor(rows, device=self.place.device)[:, None]


def ask(learned: Reward | Policy, house: ObservedHouse, commands: Sequence[str]) -> Answers:
    """Ask a learned reward or policy about every panorama of a house, once for all its tasks.

    Args:
        learned: What `Method.fit` returned.
        house: What it is shown.
        commands: Sentences, in any order, as often as they come.

    Raises:
        UsageError: If the answer is not a finite number for each.
    """
    distinct = sorted(set(commands))
    sizes = {"command": len(distinct), "panorama": len(house.views.panorama_views)}
    with torch.no_grad():
        if isinstance(learned, Reward):
            values = learned.score(house.show(), distinct)
        else:
            values = learned.logits(house.show(), distinct)
            sizes |= {"held": 2, "heading": HEADINGS, "action": ACTIONS}
    name, shape = type(learned).__name__, list(sizes.values())
    found = list(values.shape) if isinstance(values, torch.Tensor) else type(values).__name__
    if found != shape:
        raise UsageError(f"{name} answered {found}; wanted is [{', '.join(sizes)}] = {shape}.")
    if not bool(torch.isfinite(values).all()):
        command = next(c for c, row in zip(distinct, values, strict=True) if not _finite(row))
        raise UsageError(f"{name} answered {command!r} with a number that is not finite.")
    values = values.detach().to(house.place.device)
    return Answers(values, {command: row for row, command in enumerate(distinct)}, house.place)


def _finite(values: torch.Tensor) -> bool:
    return bool(torch.isfinite(values).all())
