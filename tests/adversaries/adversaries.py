"""Rewards and policies that try to score without reading what is seen or what is said.

Each takes one way to find goals that a method must not have. Every one ends at chance or is
refused; the two that can't be stopped are named in `docs/metrics.md`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.paraphrases import paraphrase
from lcrl_bench.houses.classes import class_id, task_objects
from lcrl_bench.methods.contract import Panoramas
from lcrl_bench.methods.tensors import TensorPolicy, TensorReward


def per_panorama(worth: torch.Tensor, commands: Sequence[str]) -> torch.Tensor:
    """The same worth of each panorama, whatever is said."""
    return worth.double().expand(len(commands), -1)


class LastThird(TensorReward):
    """Pays the last third of what it is asked: in the order of cells, the object at its goal."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        count = len(views)
        return per_panorama(torch.arange(count) >= 2 * count // 3, commands)


class HighNumbers(TensorReward):
    """Pays a panorama by its number: the house's own numbers begin with the house as found."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        return per_panorama(torch.arange(len(views)), commands)


class ViewNumbers(TensorReward):
    """Pays a panorama by the numbers of its views: the house as found is rendered first."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        return per_panorama(views.panorama_views.sum(1), commands)


class Memory(TensorReward):
    """Pays what is reached through the memory that tensors share with what they were cut from."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        worth = torch.zeros(len(views))
        for tensor in (views.views, views.panorama_views):
            hidden = tensor.untyped_storage().nbytes() - tensor.numel() * tensor.element_size()
            worth += hidden + tensor.storage_offset() + (tensor._base is not None)
        worth *= torch.arange(len(worth))
        return per_panorama(worth, commands)


class Lookup(TensorReward):
    """Knows a public benchmark by heart: the goals of each house and command, by their names."""

    def __init__(self, benchmark: Benchmark) -> None:
        self.targets = {(task.house, task.command): task.target for task in benchmark.tasks}
        self.found = 0

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        worth = torch.zeros(len(commands), len(views))
        for row, command in enumerate(commands):
            if (views.house, command) in self.targets:
                self.found += 1
                worth[row] = torch.arange(worth.shape[1])
        return worth


class CallCounter(TensorReward):
    """Tells houses apart by when it is asked, and objects' states by number."""

    def __init__(self) -> None:
        self.calls = 0

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        self.calls += 1
        count = len(views)
        return per_panorama((torch.arange(count) * self.calls) % 7, commands)


class Lottery(TensorReward):
    """Draws its answers anew each time."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        return torch.rand(len(commands), len(views))


class Twins(TensorReward):
    """Looks for panoramas that are equal but for a task object: there it was moved from or to."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        objects = torch.tensor([class_id(name) for name in task_objects()])
        small = torch.isin(views.views, objects.to(views.views.dtype))
        seen = small.flatten(1).any(1)[views.panorama_views]
        pixels = views.views.flatten(1).int()[views.panorama_views]
        apart = (pixels[:, None] != pixels[None]).flatten(2).sum(-1)
        near = ((apart > 0) & (apart < 60)).sum(1)
        return per_panorama(near * seen.any(1), commands)


class Company(TensorReward):
    """Goes somewhere only for a command that is asked together with its own paraphrase.

    So it would look as if it listened: other tasks' commands come without theirs.
    """

    def __init__(self, benchmark: Benchmark) -> None:
        self.other_words = {task.command: paraphrase(task) for task in benchmark.tasks}

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        worth = torch.zeros(len(commands), len(views))
        much = (views.views > 2).flatten(1).float().mean(1)[views.panorama_views].sum(1)
        for row, command in enumerate(commands):
            if self.other_words.get(command) in commands:
                worth[row] = much
        return worth


class Vandal(TensorReward):
    """Paints over the views it is handed, so that whoever is asked next sees nothing."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        views.views.fill_(0)
        views.panorama_views.fill_(0)
        return torch.zeros(len(commands), len(views))


class Numbered(TensorPolicy):
    """Acts by the number of the panorama, and picks up and puts down wherever it can."""

    def logits(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        count = len(views)
        logits = torch.zeros(len(commands), count, 2, 4, 4)
        logits[:, torch.arange(count), :, :, torch.arange(count) % 3] = 2.0
        logits[..., 3] = 1.0
        return logits


class Burglar(TensorReward):
    """Reads the goals out of the memory of the harness that is asking it."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        worth = torch.zeros(len(commands), len(views))
        frame = sys._getframe()
        while frame is not None and "sets" not in frame.f_locals:
            frame = frame.f_back
        if frame is None:
            return worth
        sets = frame.f_locals["sets"]
        rows = {command: row for row, command in enumerate(commands)}
        for tasks in sets:
            if tasks.views.observed.views.house != views.house:
                continue
            for place, task in enumerate(tasks.tasks):
                goal = tasks.panoramas[place][tasks.goal[place]]
                worth[rows[task.command], tasks.views.observed.place[goal]] = 1.0
        return worth
