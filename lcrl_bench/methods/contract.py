"""The contract between a method and the harness.

A method sees what the paper lets it see: the commands, demonstrations and dynamics of the training
tasks. It returns a `Reward` (scored on observations, re-optimised by the harness in the house it is
tested in) or a `Policy` (acted on directly). True rewards are handed only to a method that declares
`oracle = True`, exact optimal action probabilities only to one that declares `expert = True`; every
table shows it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Self

import torch

from lcrl_bench.mdp.task_batch import TaskBatch


@dataclass(frozen=True)
class HouseViews:
    """Everything there is to see in a house, each distinct view once.

    A panorama is four views; `panorama_views` names them, so a network encodes each view once.
    """

    house: str
    """The house's id in training; a digest of the views when a learned reward or policy is
    asked, for a cache of what depends on the views alone."""
    views: torch.Tensor
    """uint8 [view, height, width]: class ids, each distinct view once."""
    panorama_views: torch.Tensor
    """int64 [panorama, 4]: the views to the north, east, south and west."""


@dataclass(frozen=True)
class TaskSet:
    """Tasks of one house and one kind, as a method sees them."""

    batch: TaskBatch
    """Dynamics; `batch.goal` is all False unless the method is an oracle."""
    panoramas: torch.Tensor
    """int64 [task, cell]: the panorama seen in each cell."""
    commands: tuple[str, ...]
    """One sentence a task: `"move the cup to the bed"`."""
    demonstrations: torch.Tensor
    """int64 [task, demonstration, horizon + 1]: states visited by the expert."""
    held: torch.Tensor
    """bool [task, cell]: whether the object is in the agent's hand."""
    expert: torch.Tensor | None = None
    """float [task, state, action]: the optimal action probabilities, uniform over equally short
    ways; only for a method that declares `expert = True`."""


@dataclass(frozen=True)
class TrainHouse:
    """A training house: what is seen in it, and its tasks by kind (NAV, PICK)."""

    views: HouseViews
    tasks: tuple[TaskSet, ...]


@dataclass(frozen=True)
class TrainSet:
    """All a method may learn from."""

    houses: tuple[TrainHouse, ...]
    vocabulary: tuple[str, ...]
    """The words of the training commands, in a fixed order."""


class Reward(ABC):
    """A learned reward: scores (panorama, command) pairs."""

    @abstractmethod
    def score(self, views: HouseViews, commands: Sequence[str]) -> torch.Tensor:
        """Score every panorama for every command.

        A score is a function of one panorama and one command: not of their numbers, their order,
        or what else is scored beside them (see `observed_house`).

        Args:
            views: Panoramas, each once.
            commands: Sentences, each once; any text, also an empty one.

        Returns:
            float [command, panorama], finite.
        """

    @abstractmethod
    def save(self, folder: Path) -> None:
        """Write what `load` needs into `folder` (safetensors and JSON; no pickle).

        `config.json` is written last: a folder that has it is complete.
        """

    @classmethod
    @abstractmethod
    def load(cls, folder: Path) -> Self:
        """Read back what `save` wrote; it scores on the device of the views it is given."""


class Policy(ABC):
    """A learned policy: action logits for (panorama, heading, held, command)."""

    @abstractmethod
    def logits(self, views: HouseViews, commands: Sequence[str]) -> torch.Tensor:
        """Score the four actions in every situation; arguments as `Reward.score`.

        Returns:
            float [command, panorama, held, heading, action], finite; `held` is 0 or 1: whether the
            object is in the agent's hand.
        """

    @abstractmethod
    def save(self, folder: Path) -> None:
        """Write what `load` needs into `folder`; see `Reward.save`."""

    @classmethod
    @abstractmethod
    def load(cls, folder: Path) -> Self:
        """Read back what `save` wrote; it acts on the device of the views it is given."""


Log = Callable[[dict[str, Any]], None]
"""Takes one row of metrics: `{"step": 3, "steps": 60, "loss": 0.12}`."""


class Method(ABC):
    """A way to learn a reward or a policy from a `TrainSet`."""

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
