"""The jobs behind the tables: which runs, with which seeds, in which folders, done or not."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.errors import InvalidFileError, LcrlError
from lcrl_bench.evaluation.identity import MADE_WITH, differences, made_with, without_computer
from lcrl_bench.evaluation.model_identity import model_digest
from lcrl_bench.evaluation.reproduction.experiments import (
    Experiment,
    ImageSize,
    Optimizer,
    Row,
)
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.settings import DEFAULT_PRESET, make_method
from lcrl_bench.mdp.dqn.config import DqnConfig
from lcrl_bench.methods.contract import Method
from lcrl_bench.methods.registry import resolve_method, short_name
from lcrl_bench.names import slug
from lcrl_bench.storage import read_json

SCALED: Final = ("passes", "least_steps", "steps", "episodes")
"""Settings that say how long a method trains: what a budget makes smaller."""


@dataclass(frozen=True)
class Job:
    """One seed's run of a method, one control, or one optimisation of what a run learned."""

    method: str
    seed: int = 0
    control: bool = False
    preset: str = DEFAULT_PRESET
    settings: tuple[tuple[str, str], ...] = ()
    image_size: ImageSize | None = None
    optimizer: Optimizer = Optimizer.Q_ITERATION
    budget: float | None = None
    """The share of the full training and of the tasks sampled for DQN; None: all."""

    @property
    def variant(self) -> str:
        """What tells the run's folder from that of the method's defaults."""
        parts = [] if self.preset == DEFAULT_PRESET else [self.preset]
        parts += [f"{key}-{value}" for key, value in self.settings]
        parts += [f"{self.image_size[0]}x{self.image_size[1]}"] if self.image_size else []
        parts += [f"budget-{self.budget:g}"] if self.budget is not None else []
        return slug("-".join(parts)) if parts else ""

    @property
    def key(self) -> str:
        """The job's name: the run's folder below the benchmark's, and what is done with it."""
        name = short_name(self.method)
        if self.control:
            return f"control-{name}"
        folder = f"{name}-{self.variant}" if self.variant else name
        run = f"{folder}/seed{self.seed}"
        return run if self.optimizer == Optimizer.Q_ITERATION else f"{run}/{self.optimizer.value}"

    @property
    def run_key(self) -> str:
        """The key of the run that this job is about, or needs."""
        return self.key.removesuffix(f"/{self.optimizer.value}")

    def folder(self, out: Path, benchmark: Benchmark) -> RunFolder:
        """The folder of the run."""
        return RunFolder(out / benchmark.name / self.run_key)

    def settings_of(self, method: type[Method]) -> dict[str, str]:
        """Settings, with those that say how long made smaller by the budget."""
        chosen = dict(self.settings)
        if self.budget is None or method.Config is None:
            return chosen
        config = getattr(make_method(method, chosen, preset=self.preset), "config", None)
        if config is None:
            return chosen
        names = {each.name for each in fields(config)}
        for name in SCALED:
            if name in names:
                chosen[name] = str(max(1, math.ceil(getattr(config, name) * self.budget)))
        return chosen

    def config(self, benchmark: Benchmark, settings: Mapping[str, str]) -> dict[str, Any]:
        """What identifies a control's run, as JSON."""
        return {
            "control": self.method,
            "settings": dict(settings),
            "benchmark": benchmark.name,
            "fingerprint": benchmark.fingerprint,
            MADE_WITH: made_with(None, torch.device("cpu"), threads=1),
        }


def job_of(row: Row, seed: int, budget: float | None) -> Job:
    """The job that a row of a table needs for a seed."""
    if row.control:
        return Job(row.method, control=True)
    return Job(
        method=row.method,
        seed=seed,
        preset=row.preset,
        settings=tuple(sorted(row.settings.items())),
        image_size=row.image_size,
        optimizer=row.optimizer,
        budget=budget,
    )


def run_of(job: Job) -> Job:
    """The training run whose reward a job optimises: the job itself if it is one."""
    return Job(
        method=job.method,
        seed=job.seed,
        control=job.control,
        preset=job.preset,
        settings=job.settings,
        image_size=job.image_size,
        budget=job.budget,
    )


def jobs_of(
    experiments: Iterable[Experiment], seeds: Sequence[int] | None, budget: float | None
) -> tuple[Job, ...]:
    """Every job that some tables need, once: a table at a time, a seed at a time, runs first.

    Args:
        experiments: The tables.
        seeds: One run each; None: those of each row.
        budget: The share of the full training; None: all of it.
    """
    jobs: dict[Job, None] = {}
    for experiment in experiments:
        rows = [(row, row.seeds_of(seeds)) for row in experiment.rows]
        for seed in dict.fromkeys(seed for _, own in rows for seed in own):
            wanted = [job_of(row, seed, budget) for row, own in rows if seed in own]
            jobs.update(dict.fromkeys(run_of(job) for job in wanted))
            jobs.update(dict.fromkeys(wanted))
    return tuple(jobs)


def is_done(job: Job, out: Path, benchmark: Benchmark) -> bool:
    """Whether a job came to its end, with the very configuration and code it has now.

    What it was computed by does not matter: figures of a GPU, or of another kernel, are figures.
    """
    folder = job.folder(out, benchmark)
    if not folder.done or _config_of(folder) is None or changes(job, out, benchmark):
        return False
    try:
        folder.summary()
        model = model_digest(folder.path)
    except InvalidFileError:
        return False
    if job.optimizer == Optimizer.Q_ITERATION:
        return True
    file = summary_file(job, folder)
    return file.exists() and is_current(read_json(file), dqn_settings(job), model)


def is_current(summary: Any, settings: DqnSettings, model: str | None) -> bool:  # noqa: ANN401
    """Whether a summary of DQN is of these settings and this model."""
    return summary.get("settings") == settings.document() and summary.get("model") == model


def changes(job: Job, out: Path, benchmark: Benchmark) -> tuple[str, ...]:
    """What tells the run in a job's folder from the one that the job needs; see `differences`.

    Empty if they are the same but for what computes them, or if there is no run.
    """
    before, now = _config_of(job.folder(out, benchmark)), expected_config(job, benchmark)
    if before is None:
        return ()
    if now is None:
        return ("a method that can't be made here",)
    return differences(without_computer(before), without_computer(now))


def _config_of(folder: RunFolder) -> dict[str, Any] | None:
    file = folder.path / "config.json"
    return read_json(file) if file.exists() else None


@dataclass(frozen=True)
class DqnSettings:
    """What DQN is run with, and on which tasks."""

    config: DqnConfig
    tasks_per_split: int = 60
    """How many tasks of each split, the same ones for every row and seed."""
    tasks_seed: int = 0
    """Which tasks these are."""

    def document(self) -> dict[str, Any]:
        """All of it as JSON."""
        return asdict(self)


def dqn_settings(job: Job) -> DqnSettings:
    """The settings of a job's agents: the defaults, with less of everything under a budget."""
    shaped = job.optimizer == Optimizer.DQN_SHAPED
    full = DqnSettings(DqnConfig(shaping="optimal-value" if shaped else "none"))
    if job.budget is None:
        return full
    steps = max(full.config.episodes, math.ceil(full.config.steps * job.budget))
    config = DqnConfig(shaping=full.config.shaping, steps=steps)
    return DqnSettings(config, max(1, math.ceil(full.tasks_per_split * job.budget)))


def summary_file(job: Job, folder: RunFolder) -> Path:
    """The file that sums a job up; for an optimizer other than Q-iteration written last."""
    exact = job.optimizer == Optimizer.Q_ITERATION
    return folder.path / ("summary.json" if exact else f"{job.optimizer.value}.json")


def episodes_file(job: Job, folder: RunFolder) -> Path:
    """The file with what came of every task of a job."""
    exact = job.optimizer == Optimizer.Q_ITERATION
    return folder.path / ("episodes.parquet" if exact else f"{job.optimizer.value}.parquet")


def expected_config(job: Job, benchmark: Benchmark) -> dict[str, Any] | None:
    """What the `config.json` of the job's run holds; None if the method can't be made."""
    if job.control:
        return job.config(benchmark, {})
    try:
        return request_of(job, benchmark, Path()).config(job.seed)
    except LcrlError:
        return None


def request_of(job: Job, benchmark: Benchmark, out: Path, **more: Any) -> Any:  # noqa: ANN401
    """The `RunRequest` of a training job.

    Raises:
        UnknownNameError: If there is no such method, preset or setting.
        UsageError: If a setting has a value that the method refuses.
    """
    from lcrl_bench.evaluation.run import RunRequest

    method = resolve_method(job.method)
    return RunRequest(
        method=job.method,
        method_class=method,
        benchmark=benchmark,
        out=out,
        settings=job.settings_of(method),
        preset=job.preset,
        variant=job.variant,
        image_size=job.image_size,
        threads=1,
        **more,
    )
