"""Replay memory: one ring buffer per task, all of the same length."""

from __future__ import annotations

import torch
from torch import nn

from lcrl_bench.mdp.dqn.draws import Draws

PARTS = 3
"""State, action, next state."""


class Replay(nn.Module):
    """Ring buffers of (s, a, s'); rewards are looked up at sampling, as they may have changed."""

    ring: torch.Tensor
    """int32 [task, capacity, 3]."""
    written: torch.Tensor
    """int64 []: transitions written so far, per task."""

    def __init__(self, tasks: int, capacity: int, *, device: torch.device) -> None:
        """Make empty buffers."""
        super().__init__()
        ring = torch.zeros(tasks, capacity, PARTS, dtype=torch.int32, device=device)
        self.register_buffer("ring", ring)
        self.register_buffer("written", torch.zeros((), dtype=torch.int64))

    def add(self, states: torch.Tensor, actions: torch.Tensor, successors: torch.Tensor) -> None:
        """Store one transition per episode and task: int64 [task, episode] each."""
        count, capacity = states.shape[1], self.ring.shape[1]
        place = (int(self.written) + torch.arange(count)) % capacity
        self.ring[:, place.to(self.ring.device)] = torch.stack(
            [states, actions, successors], -1
        ).int()
        self.written += count

    def sample(self, count: int, draws: Draws) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Sample s, a, s' of every task, with replacement: int64 [task, count] each."""
        tasks, capacity, _ = self.ring.shape
        place = draws.below(min(int(self.written), capacity), count)
        offsets = torch.arange(tasks, device=place.device)[:, None] * capacity
        rows = self.ring.view(-1, PARTS).index_select(0, (place + offsets).view(-1)).long()
        states, actions, successors = rows.view(tasks, count, PARTS).unbind(-1)
        return states, actions, successors
