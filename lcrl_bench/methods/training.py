"""Training a network house by house: settings, what stays the same at every step, the loop.

A step takes all training tasks of one house, so that every view of the house is encoded once for
all of them (the paper's "Observation Caching"); a pass takes every house once, in random order.

Source: Fu et al. (2019), Algorithm 1 and section "Multi-Task IRL": "we run stochastic gradient
descent on the objective by sampling over the set of environments on each iteration".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import torch

from lcrl_bench.errors import UsageError
from lcrl_bench.methods.checkpoint import restore_checkpoint, save_checkpoint
from lcrl_bench.methods.contract import Log

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
"""The paper's settings (appendix "Experiment Hyperparameters"). It does not say for how long it
trained: 60 passes are ours."""


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


Row = dict[str, float]
"""What a step logs: `{"loss": 0.12}`, and more if need be."""


@dataclass(frozen=True, kw_only=True)
class Opponent:
    """What trains against a network: it has its turn before each pass."""

    module: torch.nn.Module
    """Its state, which checkpoints hold beside the network's."""
    group: Mapping[str, Any]
    """Its parameter group in the optimizer of both, which moves only what has a gradient."""
    before_pass: Callable[[torch.optim.Optimizer], None]
    """Its turn, with that optimizer."""


def train_house_by_house(
    network: torch.nn.Module,
    step: Callable[[int], tuple[torch.Tensor, Row]],
    config: TrainingConfig,
    *,
    houses: int,
    generator: torch.Generator,
    log: Log,
    identity: str,
    checkpoint: Path | None = None,
    opponent: Opponent | None = None,
) -> None:
    """Train `network` in place, with one step of Adam per house.

    Args:
        network: What `step` computes with.
        step: Takes the number of a house; returns what to descend, and what to log.
        config: The schedule.
        houses: Number of houses.
        generator: Draws the order of the houses.
        log: Told the loss of every step.
        identity: What `training_identity` returned, before anything was drawn.
        checkpoint: A folder to save the state in, and to resume from if it holds one.
        opponent: What trains against the network, if anything does.
    """
    trained, groups = network, [{"params": list(network.parameters())}]
    if opponent is not None:
        trained = torch.nn.ModuleList([network, opponent.module])
        groups.append(dict(opponent.group))
    optimizer = torch.optim.AdamW(
        groups,
        lr=config.learning_rate,
        weight_decay=config.weight_decay,
        # One routine for all weights: a step of so small a network is mostly calls.
        fused=True,
    )
    passes = config.passes_over(houses)
    steps = passes * houses
    first = 0
    if checkpoint is not None:
        first = restore_checkpoint(checkpoint, trained, optimizer, generator, identity=identity)
    for done in range(first, passes):
        if opponent is not None:
            opponent.before_pass(optimizer)
        order = torch.randperm(houses, generator=generator).tolist()
        for number, house in enumerate(order, start=done * houses):
            optimizer.param_groups[0]["lr"] = config.learning_rate_at(number, steps)
            descended, row = step(house)
            optimizer.zero_grad()
            descended.backward()
            if config.clip:
                torch.nn.utils.clip_grad_norm_(network.parameters(), config.clip)
            optimizer.step()
            log({"step": number + 1, "steps": steps, **row})
        if checkpoint is not None and _due(done + 1, passes, config):
            save_checkpoint(
                checkpoint, trained, optimizer, generator, done=done + 1, identity=identity
            )


def _due(done: int, passes: int, config: TrainingConfig) -> bool:
    """Whether a checkpoint is due after that many passes."""
    return done % config.checkpoint_passes == 0 or done == passes
