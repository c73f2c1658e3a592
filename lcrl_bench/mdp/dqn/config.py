"""`DqnConfig`: how long a DQN acts, how it learns, and whether its reward is shaped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from lcrl_bench.errors import UsageError

Shaping = Literal["optimal-value", "none"]
"""The shaping potential: V* of the optimised reward, or none."""


@dataclass(frozen=True)
class DqnConfig:
    """Settings of the DQN that each task is solved by."""

    steps: int = 30_000
    """Environment steps per task."""
    episodes: int = 10
    """Parallel episodes per task; one gradient step is taken whenever each has taken a step."""
    hidden: int = 64
    """Units of each hidden layer."""
    layers: int = 2
    """Hidden layers; the first sums one row per input (position, heading, object state)."""
    learning_rate: float = 3e-3
    """Learning rate of Adam."""
    batch: int = 32
    """Transitions per gradient step."""
    replay: int = 30_000
    """Transitions that the replay memory holds; the oldest are overwritten."""
    target_interval: int = 200
    """Gradient steps between updates of the target network."""
    double: bool = True
    """Double DQN: the network chooses the next action, the target network evaluates it."""
    exploration_end: float = 0.05
    """Final epsilon; it starts at 1."""
    exploration_share: float = 0.25
    """Fraction of `steps` over which epsilon decays linearly."""
    shaping: Shaping = "optimal-value"
    """`optimal-value`: the paper's potential, whose computation needs the dynamics; or `none`."""

    def __post_init__(self) -> None:
        """Check the settings.

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
        """Steps that each of the parallel episodes takes: `steps // episodes`."""
        return self.steps // self.episodes

    def exploration(self, done: int) -> float:
        """epsilon, the probability of a random action, after `done` rounds."""
        fall = self.exploration_share * self.rounds
        share = min(done / fall, 1.0) if fall else 1.0
        return 1.0 + (self.exploration_end - 1.0) * share
