"""A method of no use: a random reward, drawn in steps, that can be told to die half-way once."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import torch
from safetensors.torch import load_file, save_file

from lcrl_bench.methods.contract import Log, Method, Panoramas, TrainSet
from lcrl_bench.methods.tensors import TensorReward


class Noise(TensorReward):
    """Every class of thing is worth something, whatever is said."""

    def score(self, views: Panoramas, commands: Sequence[str]) -> torch.Tensor:
        seen = self.tensors["worth"][views.views.long()].mean((1, 2))
        return seen[views.panorama_views].sum(1).expand(len(commands), -1)


@dataclass(frozen=True)
class NoiseConfig:
    passes: int = 4
    dies_once: str = ""
    """A file: if it is there, it is removed, and so is the process."""
    fails: bool = False


class NoiseMethod(Method):
    learns = Noise
    Config: ClassVar[type[NoiseConfig]] = NoiseConfig

    def __init__(self, config: NoiseConfig | None = None) -> None:
        self.config = config or NoiseConfig()

    def fit(
        self,
        train: TrainSet,
        *,
        generator: torch.Generator,
        device: torch.device,
        log: Log,
        checkpoint: Path | None = None,
    ) -> Noise:
        if self.config.fails:
            raise ZeroDivisionError("noise over nothing")
        draws = [torch.rand(64, generator=generator) for _ in range(self.config.passes)]
        state = None if checkpoint is None else checkpoint / "worth.safetensors"
        kept = load_file(state)["worth"] if state is not None and state.exists() else draws[0][:0]
        rows = list(kept.view(-1, 64))
        for step in range(len(rows), self.config.passes):
            rows.append(draws[step])
            log({"step": step + 1, "steps": self.config.passes, "loss": 1.0})
            if state is not None:
                state.parent.mkdir(parents=True, exist_ok=True)
                save_file({"worth": torch.stack(rows)}, state)
            fatal = Path(self.config.dies_once)
            if self.config.dies_once and step == 1 and fatal.exists():
                fatal.unlink()
                os.kill(os.getpid(), signal.SIGKILL)
        return Noise({"worth": torch.stack(rows).sum(0)})
