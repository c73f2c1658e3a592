"""A method of the `Twins` kind as somebody might submit it: three seeds with files of their own."""

from __future__ import annotations

from pathlib import Path

import torch
from adversaries import Twins

from lcrl_bench.methods.contract import Log, Method, TrainSet


class TwinMethod(Method):
    learns = Twins

    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> Twins:
        log({"step": 1, "steps": 1, "loss": 0.0})
        return Twins({"drawn": torch.rand((), generator=generator)})
