"""The `lexical` baseline: words looked up in the panorama, without learning.

A panorama scores the share of its pixels that are of the class the command names; if it names two
classes, their shares are multiplied, so both must be visible. Room names are not classes and are
ignored; a command that names no class scores 0 everywhere. The baseline is always published: a
method that doesn't beat it has learned nothing about words that a dictionary would not give.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch

from lcrl_bench.benchmarks.grammar import named_classes, tokens, words_of
from lcrl_bench.houses.classes import class_id
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.tensors import TensorReward


class LexicalReward(TensorReward):
    """The share of a panorama that shows the classes the command names."""

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
    """The classes that a command names, by id.

    Names inside longer ones don't count: "go to the coffee table" doesn't name a table.
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
    """The share of each panorama's pixels of a class: float32 [panorama]."""
    share = (views.views == label).flatten(1).float().mean(1)
    return share[views.panorama_views].mean(1)
