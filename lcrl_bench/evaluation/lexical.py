"""The `lexical` floor: words looked up in what is seen, and nothing learned.

A panorama is worth as many pixels as it shows of the class that the command names; of two named
classes, both must be in sight, and their shares are multiplied. Names of rooms are no classes: they
count for nothing, and a command that names no class scores 0 everywhere. Whatever the floor scores,
it is published: a method that does not pass it has learned nothing about words that a dictionary
would not give.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch

from lcrl_bench.benchmarks.grammar import named_classes, tokens, words_of
from lcrl_bench.houses.classes import class_id
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.tensors import TensorReward


class LexicalReward(TensorReward):
    """The share of a panorama that shows what the command names."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        """The product of the shares of all named classes: float32 [command, panorama], 0 .. 1."""
        named = [named_in(command) for command in commands]
        shares = {
            name: _shares(views, class_id(name))
            for name in sorted({n for row in named for n in row})
        }
        shape = len(commands), len(views)
        scores = torch.zeros(shape, device=views.views.device)
        for row, names in enumerate(named):
            if names:
                scores[row] = torch.stack([shares[name] for name in names]).prod(0)
        return scores


def named_in(command: str) -> tuple[str, ...]:
    """The classes that a command names, in id order.

    A name inside a longer one does not count: "go to the coffee table" names no table.
    """
    padded = f" {' '.join(tokens(command))} "
    found = {
        name: f" {words_of(name)} " for name in named_classes() if f" {words_of(name)} " in padded
    }
    return tuple(
        name
        for name, words in found.items()
        if not any(words in longer for longer in found.values() if longer != words)
    )


def _shares(views: Panoramas, label: int) -> torch.Tensor:
    """The share of each panorama's pixels that are of a class: float32 [panorama]."""
    share = (views.views == label).flatten(1).float().mean(1)
    return share[views.panorama_views].mean(1)
