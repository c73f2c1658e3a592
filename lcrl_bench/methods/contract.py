"""The contract between a method and the harness.

A method is given what the paper gives it: the commands, demonstrations and dynamics of the training
tasks. It returns a `Reward` (of observations; the harness re-optimises it in each test house) or a
`Policy` (acts as it is). Only methods that declare `oracle = True` get true rewards, and only those
that declare `expert = True` get the optimal action probabilities; every table marks them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import torch

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.methods.learned import Policy, Reward
from lcrl_bench.methods.train_set import TrainSet
from lcrl_bench.panoramas import CLASSES, Panoramas

__all__ = [
    "CLASSES",
    "Log",
    "Method",
    "Panoramas",
    "Policy",
    "Reward",
    "TaskSet",
    "TrainSet",
]

Log = Callable[[dict[str, Any]], None]
"""Takes one row of metrics: `{"step": 3, "steps": 60, "loss": 0.12}`."""


class Method(ABC):
    """A way to learn a reward or a policy from a `TrainSet`.

    Example:
        >>> import torch
        >>> from lcrl_bench.methods import TensorReward
        >>> class Wood(TensorReward):
        ...     def score(self, views, commands):
        ...         return views.class_shares()[:, 3].expand(len(commands), -1)
        >>> class LikesWood(lcrl_bench.Method):
        ...     learns = Wood
        ...     def fit(self, train, *, generator, device, log, checkpoint=None):
        ...         return Wood()
        >>> lcrl_bench.evaluate(Wood(), "mini", progress=False).figure("train", "nav").mean
        8.3333
    """

    learns: ClassVar[type[Reward] | type[Policy]]
    """The class that `fit` returns an instance of; it also loads saved models."""
    oracle: ClassVar[bool] = False
    """Whether it is given true rewards."""
    expert: ClassVar[bool] = False
    """Whether it is given the optimal action probabilities of every state."""
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {}
    """Named settings, preset -> fields of `Config` that differ from the defaults: `"paper"`."""
    Config: ClassVar[type[Any] | None] = None
    """Frozen dataclass of its settings, each with a default; the constructor takes one as its only
    argument, or none for the defaults. None: the method has no settings."""

    @abstractmethod
    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> Reward | Policy:
        """Learn from `train`.

        Args:
            train: The training data; must not be modified.
            generator: A CPU generator, the only source of randomness: equal states give equal
                results on one machine, to the bit.
            device: Where to compute, and where `train` already is.
            log: Called with rows of metrics.
            checkpoint: A folder in which to save the training state now and then, and to resume
                from, with the same bits as an uninterrupted run. Methods that take seconds may
                ignore it.
        """
