"""The folder of a run of LC-RL on the tiny benchmark, trained for one step and not evaluated."""

from __future__ import annotations

from pathlib import Path

import torch
from benchmark_samples import tiny_benchmark, tiny_task_sets

from lcrl_bench.evaluation.model_identity import save_model
from lcrl_bench.evaluation.settings import make_method
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.methods.train_set import train_set
from lcrl_bench.storage import write_json

SETTINGS = {"passes": "1", "least_steps": "1"}


def write_run(folder: Path, method: str = "lcrl") -> Path:
    """Write what `ask` and `play` read of a run, and return the folder."""
    learner = make_method(resolve_method(method), SETTINGS)
    benchmark, cpu = tiny_benchmark(), torch.device("cpu")
    data = train_set(benchmark, tiny_task_sets(), oracle=learner.oracle, expert=learner.expert)
    generator = torch.Generator().manual_seed(0)
    learned = learner.fit(data, generator=generator, device=cpu, log=lambda _: None)
    named = {"method": method, "settings": SETTINGS, "benchmark": benchmark.name, "seed": 0}
    config = {**named, "fingerprint": benchmark.fingerprint}
    write_json(folder / "config.json", config)
    save_model(folder, learned.save, config)
    return folder
