"""`DqnConfig`: how long a DQN acts, how it learns, whether its reward is shaped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from lcrl_bench.errors import UsageError

Shaping = Literal["optimal-value", "none"]
"""Which potential shapes the reward: V* of the reward that is optimised, or none."""


@dataclass(frozen=True)
class DqnConfig:
    """Settings of one DQN; every task gets one of its own."""

    steps: int = 30_000
    """Environment steps a task."""
    episodes: int = 10
    """Episodes of a task that run side by side; one gradient step is taken as each takes a step."""
    hidden: int = 64
    """Units of each hidden layer."""
    layers: int = 2
    """Hidden layers; the first sums one row an input (position, heading, object state)."""
    learning_rate: float = 3e-3
    """Adam's."""
    batch: int = 32
    """Transitions of a gradient step."""
    replay: int = 30_000
    """Transitions that are remembered; the oldest are overwritten."""
    target_interval: int = 200
    """Gradient steps from one copy of the network into the target network to the next."""
    double: bool = True
    """Double DQN: the network chooses the next action, the target network values it."""
    exploration_end: float = 0.05
    """epsilon after it has fallen from 1."""
    exploration_share: float = 0.25
    """Share of `steps` over which epsilon falls, along a line."""
    shaping: Shaping = "optimal-value"
    """`optimal-value`: the paper's potential, which takes known dynamics to compute; `none`."""

    def __post_init__(self) -> None:
        """Refuse what can't be learned with.

        Raises:
            UsageError: If a number is out of range.
        """
        counts = ("episodes", "hidden", "layers", "batch", "target_interval")
        if bad := [name for name in counts if getattr(self, name) < 1]:
            raise UsageError(f"{bad[0]} starts at 1, found {getattr(self, bad[0])}.")
        if self.steps < self.episodes or self.replay < self.episodes:
            reason = f"at least one step of each of {self.episodes} episodes"
            raise UsageError(f"steps ({self.steps}) and replay ({self.replay}) must hold {reason}.")
        if not self.learning_rate > 0:
            raise UsageError(f"learning_rate must be positive, found {self.learning_rate}.")
        if not (0 <= self.exploration_end <= 1 and 0 <= self.exploration_share <= 1):
            raise UsageError("exploration_end and exploration_share lie in [0, 1].")

    @property
    def rounds(self) -> int:
        """How often all episodes of a task take one step."""
        return self.steps // self.episodes

    def exploration(self, done: int) -> float:
        """The share of random actions after `done` rounds."""
        fall = self.exploration_share * self.rounds
        share = min(done / fall, 1.0) if fall else 1.0
        return 1.0 + (self.exploration_end - 1.0) * share
