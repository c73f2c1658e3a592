"""Counter-based random numbers per task: a hash of the task's seed and a counter.

From a shared generator, a task's numbers would depend on the other tasks in the stack. Here they
depend on its seed alone, and are the same on a CPU and on a GPU.

Source: the finaliser of SplitMix64, Steele, Lea and Flood, "Fast Splittable Pseudorandom Number
Generators" (OOPSLA 2014).
"""

from __future__ import annotations

import torch
from torch import nn

_STEP = 0x9E3779B97F4A7C15 - (1 << 64)
_FIRST = 0xBF58476D1CE4E5B9 - (1 << 64)
_SECOND = 0x94D049BB133111EB - (1 << 64)
_BITS = 24
"""Bits of a number in [0, 1) that a float32 holds."""


class Draws(nn.Module):
    """Streams of uniform numbers, one per task; a module, so that its state is in `state_dict`."""

    seeds: torch.Tensor
    counter: torch.Tensor

    def __init__(self, seeds: torch.Tensor) -> None:
        """Start each stream at its first number.

        Args:
            seeds: int64 [task].
        """
        super().__init__()
        self.register_buffer("seeds", seeds.clone())
        self.register_buffer("counter", torch.zeros((), dtype=torch.int64, device=seeds.device))

    def uniform(self, count: int) -> torch.Tensor:
        """The next numbers of every task: float32 [task, count], in [0, 1)."""
        place = self.counter + torch.arange(count, device=self.seeds.device)
        self.counter += count
        # The seed is mixed first: neighbouring seeds must not give shifted copies of one sequence.
        bits = _mix(_mix(self.seeds)[:, None] + _mix(place * _STEP))
        return (bits >> (64 - _BITS) & ((1 << _BITS) - 1)).to(torch.float32) * 2.0**-_BITS

    def below(self, bound: int, count: int) -> torch.Tensor:
        """The next integers of every task: int64 [task, count], in [0, bound)."""
        return (self.uniform(count) * bound).long().clamp_(max=bound - 1)

    def branch(self, number: int) -> Draws:
        """Independent streams of the same tasks, which leave these where they are."""
        place = torch.full_like(self.seeds, number + 1)
        return Draws(_mix(self.seeds ^ _mix(place * _STEP)))


def _mix(bits: torch.Tensor) -> torch.Tensor:
    """Mix the bits of int64 numbers, bijectively; products wrap around."""
    bits = (bits ^ _shift(bits, 30)) * _FIRST
    bits = (bits ^ _shift(bits, 27)) * _SECOND
    return bits ^ _shift(bits, 31)


def _shift(bits: torch.Tensor, places: int) -> torch.Tensor:
    """Logical shift to the right: fills with zeros whatever the sign."""
    return bits >> places & ((1 << (64 - places)) - 1)
