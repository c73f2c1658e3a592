"""A method of the `Twins` kind as somebody might submit it: three seeds with files of their own."""

from __future__ import annotations

import json
from pathlib import Path

import torch
from adversaries import Twins

from lcrl_bench.methods.contract import Log, Method, TrainSet


class TwinMethod(Method):
    def __init__(self) -> None:
        self.drawn = 0.0

    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> Twins:
        self.drawn = float(torch.rand((), generator=generator))
        log({"step": 1, "steps": 1, "loss": 0.0})
        return Twins()

    def save(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "config.json").write_text(json.dumps(self.drawn))

    def load(self, folder: Path) -> Twins:
        self.drawn = json.loads((folder / "config.json").read_text())
        return Twins()
