"""Tests whether a model's outputs depend only on panoramas and commands.

The harness passes panoramas to a method in an uninformative order (`methods.learned`). Three tests
check that a method doesn't use anything else:

    again     the house with its cells, panoramas and views renumbered: equal bits
    order     the same questions in another order, under another name of the house: equal up
              to rounding
    company   a random half of panoramas and commands alone: equal up to rounding

The first detects methods that count calls or use randomness, the second those that use positions,
the third those that compare inputs with each other, such as panoramas that differ by one cup.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import torch

from lcrl_bench.mdp.planning import TIE_TOLERANCE
from lcrl_bench.methods.learned import Answers, Policy, Reward, ask
from lcrl_bench.panoramas import ObservedHouse, Panoramas

ROUNDING: Final = TIE_TOLERANCE
"""Largest change by rounding, as a share of the command's largest output: planning treats smaller
differences as ties, so they can't carry information."""


def dependence_of(
    learned: Reward | Policy,
    house: ObservedHouse,
    commands: Sequence[str],
    *,
    generator: torch.Generator,
) -> str:
    """What a model's outputs depend on besides panoramas and commands.

    Args:
        learned: The model.
        house: A house to test it in.
        commands: Commands to test it with.
        generator: A CPU generator, for the orders and the half.

    Returns:
        `"how often it is asked"`, `"the order of what is asked"` or `"what else is asked"`; empty
        if none.
    """
    distinct = sorted(set(commands))
    first = ask(learned, house, distinct)
    panoramas = len(house.views)
    order = torch.randperm(panoramas, generator=generator).to(house.place.device)
    shuffled = _renamed(house.views, order, generator)
    renumbered = ObservedHouse.of(shuffled)
    again = ask(learned, renumbered, distinct)
    if not torch.equal(again.values[:, renumbered.place], first.values[:, order]):
        return "how often it is asked"
    spoken = [distinct[k] for k in torch.randperm(len(distinct), generator=generator).tolist()]
    if _differs(_rows(first, spoken)[:, order], _answers(learned, shuffled, spoken)):
        return "the order of what is asked"
    half, said = order[: (panoramas + 1) // 2], spoken[: (len(spoken) + 1) // 2]
    alone = _answers(learned, _renamed(house.views, half, generator), said)
    return "what else is asked" if _differs(_rows(first, said)[:, half], alone) else ""


def _differs(expected: torch.Tensor, found: torch.Tensor) -> bool:
    """Whether outputs [command, panorama, ...] differ by more than rounding."""
    largest = expected.flatten(1).abs().amax(1)
    return bool(((expected - found).flatten(1).abs().amax(1) > ROUNDING * largest).any())


def _rows(answers: Answers, commands: Sequence[str]) -> torch.Tensor:
    return answers.values[[answers.rows[command] for command in commands]]


def _answers(learned: Reward | Policy, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
    """The outputs for commands and panoramas in the given order, which `ask` would sort."""
    with torch.no_grad():
        if isinstance(learned, Reward):
            return learned.score(views, commands)
        return learned.logits(views, commands)


def _renamed(views: Panoramas, chosen: torch.Tensor, generator: torch.Generator) -> Panoramas:
    """Some panoramas of a house, with their views in a new order, under another name."""
    sides = views.panorama_views[chosen]
    kept, numbers = torch.unique(sides, return_inverse=True)
    order = torch.randperm(len(kept), generator=generator).to(kept.device)
    rank = torch.empty_like(order)
    rank[order] = torch.arange(len(kept), device=kept.device)
    name = f"{int(torch.randint(1 << 62, (), generator=generator)):064x}"
    return replace(views, house=name, views=views.views[kept[order]], panorama_views=rank[numbers])
