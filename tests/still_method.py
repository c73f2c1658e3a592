"""A method that draws nothing: whatever its seed, it comes to the same."""

from __future__ import annotations

from pathlib import Path

import torch
from noise_method import Noise, NoiseMethod

from lcrl_bench.methods.contract import Log, TrainSet


class StillMethod(NoiseMethod):
    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> Noise:
        return Noise({"worth": torch.linspace(0, 1, 64)})


class SecretMethod(StillMethod):
    """Draws nothing either, but looks at its seed."""

    def fit(self, train: TrainSet, *, generator: torch.Generator, **rest: object) -> Noise:
        return Noise({"worth": torch.linspace(0, 1, 64) * (1 + generator.initial_seed())})
