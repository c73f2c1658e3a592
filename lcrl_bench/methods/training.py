"""Training a network house by house: settings, what stays the same at every step, the loop.

A step takes all training tasks of one house, so that every view of the house is encoded once for
all of them (the paper's "Observation Caching"); a pass takes every house once, in random order.

Source: Fu et al. (2019), Algorithm 1 and section "Multi-Task IRL": "we run stochastic gradient
descent on the objective by sampling over the set of environments on each iteration".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.methods.checkpoint import restore_checkpoint, save_checkpoint
from lcrl_bench.methods.contract import Log
from lcrl_bench.methods.preparation import PreparedHouse

PAPER_TRAINING: Final[Mapping[str, Any]] = {
    "learning_rate": 5e-4,
    "decay": "constant",
    "passes": 60,
    "image": "pooling",
    "fusion": "mult",
    "views": "sum",
    "size": 32,
    "hidden": 32,
    "weight_decay": 0.0,
    "dropout": 0.0,
    "standardise": False,
}
"""What the paper states (appendix "Experiment Hyperparameters"). It does not say for how long it
trained: sixty passes."""


@dataclass(frozen=True)
class TrainingConfig:
    """Settings of every method that trains the paper's network house by house."""

    passes: int = 60
    """Passes over the training houses; one step of Adam per house."""
    least_steps: int = 1_000
    """Passes are added until there are this many steps: few houses make short passes."""
    learning_rate: float = 4e-3
    """Adam's initial learning rate. (Paper: 5e-4.)"""
    decay: Literal["cosine", "constant"] = "cosine"
    """Schedule of the learning rate: half a cosine down to zero, or constant (paper)."""
    weight_decay: float = 0.0
    """AdamW's decoupled weight decay, relative to the learning rate."""
    dropout: float = 0.0
    """Fraction of the image features left out of each step, in [0, 1)."""
    standardise: bool = True
    """Whether each class channel is scaled to unit variance over the training views, so that small
    things weigh as much as walls. (Paper: not said.)"""
    mirror: bool = True
    """Whether each step sees the house's mirror image with probability 1/2. Only for rewards: a
    reward of a place and a command knows no left and right, a policy does."""
    clip: float = 0.0
    """Maximum norm of a gradient; 0 for no limit."""
    image: Literal["pooling", "film", "fc"] = "pooling"
    """How a view's features become a vector: global max pool (paper's choice), FiLM, or FC."""
    fusion: Literal["mult", "add", "concat"] = "mult"
    """How image and command embeddings combine; the paper multiplies."""
    views: Literal["sum", "max"] = "sum"
    """How the four views' embeddings combine; the paper sums."""
    filters: int = 16
    """Filters of the first convolution."""
    size: int = 64
    """Length of every embedding. (Paper: 32.)"""
    hidden: int = 64
    """Units of the fully connected layer before the output. (Paper: 32.)"""
    checkpoint_passes: int = 5
    """Passes between checkpoints."""

    def __post_init__(self) -> None:
        """Refuse what can't be trained with.

        Raises:
            UsageError: If a number is out of range.
        """
        if self.least_steps < 0:
            raise UsageError("least_steps must not be negative.")
        if min(self.passes, self.checkpoint_passes, self.filters, self.size, self.hidden) < 1:
            raise UsageError("passes, checkpoint_passes, filters, size and hidden start at 1.")
        if not 0 <= self.dropout < 1:
            raise UsageError("dropout must lie in [0, 1).")
        if not (self.learning_rate > 0 and self.clip >= 0 and self.weight_decay >= 0):
            raise UsageError("learning_rate must be positive, clip and weight_decay not negative.")

    def passes_over(self, houses: int) -> int:
        """Number of passes over that many houses."""
        return max(self.passes, math.ceil(self.least_steps / houses))

    def learning_rate_at(self, step: int, steps: int) -> float:
        """The learning rate of a step, 0 .. steps - 1."""
        if self.decay == "constant":
            return self.learning_rate
        return self.learning_rate * 0.5 * (1.0 + math.cos(math.pi * step / steps))


Objective = Callable[[PreparedHouse], tuple[torch.Tensor, float]]
"""What a step descends on all tasks of a house, and the loss to report: often the same."""


def train_house_by_house(
    network: torch.nn.Module,
    houses: Sequence[PreparedHouse],
    objective: Objective,
    config: TrainingConfig,
    *,
    generator: torch.Generator,
    log: Log,
    identity: str,
    checkpoint: Path | None = None,
) -> None:
    """Train `network` in place, with one step of Adam a house.

    Args:
        network: What `objective` computes with.
        houses: The training houses.
        objective: See `Objective`.
        config: The schedule.
        generator: Draws the order of the houses.
        log: Told the loss of every step.
        identity: What `training_identity` returned, before anything was drawn.
        checkpoint: A folder to save the state in, and to go on from if it holds one.
    """
    optimizer = torch.optim.AdamW(
        network.parameters(),
        lr=config.learning_rate,
        weight_decay=config.weight_decay,
        # One routine for all weights: a step of so small a network is mostly calls.
        fused=True,
    )
    passes = config.passes_over(len(houses))
    steps = passes * len(houses)
    first = 0
    if checkpoint is not None:
        first = restore_checkpoint(checkpoint, network, optimizer, generator, identity=identity)
    for done in range(first, passes):
        order = torch.randperm(len(houses), generator=generator).tolist()
        for step, house in enumerate(order, start=done * len(houses)):
            for group in optimizer.param_groups:
                group["lr"] = config.learning_rate_at(step, steps)
            surrogate, loss = objective(houses[house])
            optimizer.zero_grad()
            surrogate.backward()
            if config.clip:
                torch.nn.utils.clip_grad_norm_(network.parameters(), config.clip)
            optimizer.step()
            log({"step": step + 1, "steps": steps, "loss": loss})
        if checkpoint is not None and _due(done + 1, passes, config):
            save_checkpoint(
                checkpoint, network, optimizer, generator, done=done + 1, identity=identity
            )


def _due(done: int, passes: int, config: TrainingConfig) -> bool:
    """Whether a checkpoint is due after so many passes of all."""
    return done % config.checkpoint_passes == 0 or done == passes
