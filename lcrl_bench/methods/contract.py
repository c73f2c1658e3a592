"""The contract between a method and the harness.

A method sees what the paper lets it see: the commands, demonstrations and dynamics of the training
tasks. It returns a `Reward` (scored on observations, re-optimised by the harness in the house it is
tested in) or a `Policy` (acted on directly). True rewards are handed only to a method that declares
`oracle = True`, exact optimal action probabilities only to one that declares `expert = True`; every
table shows it.
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
    """What `fit` returns: the class that reads a saved model back."""
    oracle: ClassVar[bool] = False
    """Whether it is handed true rewards."""
    expert: ClassVar[bool] = False
    """Whether it is handed the optimal action probabilities in every state."""
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
            train: All there is to learn from; left as it is.
            generator: A CPU generator, where all randomness comes from: equal states give equal
                results on one machine, to the bit.
            device: Where to compute; `train` is there already.
            log: Told the progress.
            checkpoint: A folder to save the state of the training in from time to time, and to go
                on from if it holds one, to the bits of a run that was not interrupted. A method
                that is done in seconds may ignore it.
        """
