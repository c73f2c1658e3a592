"""Train a method on a benchmark and evaluate it on every split, seed by seed."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.harness import (
    ConstantReward,
    Outcome,
    evaluate,
    evaluate_each,
    evaluate_optimal,
    evaluate_random,
    own_command,
)
from lcrl_bench.evaluation.identity import MADE_WITH, made_with
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.lexical import LexicalReward
from lcrl_bench.evaluation.model_identity import save_model
from lcrl_bench.evaluation.problems import Problem, train_set
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.settings import DEFAULT_PRESET, make_method, settings_document
from lcrl_bench.evaluation.summary import (
    failure_table,
    measure_table,
    percentage,
    split_table,
)
from lcrl_bench.methods.contract import Log, Method, Policy, Reward
from lcrl_bench.methods.registry import short_name
from lcrl_bench.storage import writing


@dataclass(frozen=True)
class RunRequest:
    """What is to be run."""

    method: str
    """The name it was asked for by."""
    method_class: type[Method]
    benchmark: Benchmark
    out: Path
    """Runs are written to `out/<benchmark>/<method>[-<variant>]/seed<k>`."""
    settings: Mapping[str, str] = field(default_factory=dict)
    device: torch.device = field(default_factory=lambda: torch.device("cpu"))
    preset: str = DEFAULT_PRESET
    """Which of the method's presets `settings` changes."""
    variant: str = ""
    """Tells runs of one method with several settings apart, in the folder's name."""
    image_size: tuple[int, int] | None = None
    """Width and height of the views in pixels; None: the benchmark's own."""
    threads: int | None = None
    """Threads of torch that it is run with; None: as many as torch has."""
    renderer: str = "auto"
    """What the views of the houses were drawn by, as it was asked for."""
    fresh: bool = False
    """Set aside a run of another identity that is in the way, instead of refusing."""

    def folder(self, seed: int) -> RunFolder:
        """The folder of one seed's run."""
        name = short_name(self.method)
        folder = f"{name}-{self.variant}" if self.variant else name
        return RunFolder(self.out / self.benchmark.name / folder / f"seed{seed}")

    def config(self, seed: int) -> dict[str, Any]:
        """The identity of one seed's run, as JSON: what is asked for, and what it is made with."""
        config = {
            "method": self.method,
            "settings": dict(self.settings),
            "benchmark": self.benchmark.name,
            "fingerprint": self.benchmark.fingerprint,
            "seed": seed,
        }
        if self.preset != DEFAULT_PRESET:
            config["preset"] = self.preset
        if self.image_size is not None:
            config["image_size"] = list(self.image_size)
        # All settings, not only those that were asked for: a run under other defaults is another.
        config["resolved"] = settings_document(
            make_method(self.method_class, self.settings, preset=self.preset)
        )
        config[MADE_WITH] = made_with(
            self.method_class, self.device, threads=self.threads, renderer=self.renderer
        )
        return config


@dataclass(frozen=True)
class SeedResult:
    """What one seed gave."""

    seed: int
    folder: RunFolder
    learned: Reward | Policy
    summary: dict[str, Any]
    outcomes: tuple[Outcome, ...]
    """What came of every task; empty if the run was read back."""
    read_back: datetime | None = None
    """When the run was finished that was read back; None if it was run now."""


def resolve_device(name: str) -> torch.device:
    """The device of a name: `auto` is CUDA where there is one, else the CPU.

    Raises:
        UsageError: If it is no device of this machine.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    try:
        device = torch.device(name)
    except RuntimeError as error:
        raise UsageError(f"--device {name}: {error}. Valid: auto, cpu, cuda.") from error
    if device.type == "cuda" and not torch.cuda.is_available():
        raise UsageError("--device cuda: torch finds no GPU here. Use --device cpu.")
    return device


def run_seed(
    request: RunRequest,
    problems: Sequence[Problem],
    seed: int,
    *,
    log: Log = lambda _: None,
    folder: RunFolder | None = None,
) -> SeedResult:
    """Train and evaluate one seed, or go on with a run that was interrupted.

    A run that is done is read back, not repeated: the same request in the same folder gives the
    same files.

    Args:
        request: What is to be run.
        problems: The houses.
        seed: Which run of it.
        log: Told every row of the training.
        folder: `request.folder(seed)`, if the caller holds its lock and means to write there too.

    Raises:
        UsageError: If the folder holds another run, or a setting does not fit the method.
        InvalidFileError: If it holds a model that its training did not make.
        FolderInUseError: If another process writes it.
    """
    folder = folder or request.folder(seed)
    with folder.locked():
        return _run_seed(request, problems, seed, log, folder)


def _run_seed(
    request: RunRequest, problems: Sequence[Problem], seed: int, log: Log, folder: RunFolder
) -> SeedResult:
    method = make_method(request.method_class, request.settings, preset=request.preset)
    config = request.config(seed)
    if folder.begin(config, device=request.device, fresh=request.fresh):
        learned = method.learns.load(folder.model)
        return SeedResult(seed, folder, learned, folder.summary(), (), folder.finished)
    began = time.perf_counter()
    learned = _fit(method, request, problems, seed, folder, log)
    said = {"command": own_command, **language_controls(problems)}
    outcomes, language = _split_off(evaluate_each(learned, problems, said))
    folder.write_episodes(outcomes, language=language)
    summary = {
        "benchmark": request.benchmark.name,
        "fingerprint": request.benchmark.fingerprint,
        "method": request.method,
        "oracle": method.oracle,
        "seed": seed,
        "deterministic": folder.deterministic,
        "splits": split_table(outcomes),
        "measures": measure_table(outcomes),
        "failures": failure_table(outcomes),
        "language": {name: split_table(rows) for name, rows in language.items()},
        "wall_s": round(time.perf_counter() - began, 3),
    }
    return SeedResult(seed, folder, learned, summary, outcomes)


def _split_off(
    found: dict[str, tuple[Outcome, ...]],
) -> tuple[tuple[Outcome, ...], dict[str, tuple[Outcome, ...]]]:
    """What came of the tasks' own commands, and of each language control."""
    return found.pop("command"), found


def _fit(
    method: Method,
    request: RunRequest,
    problems: Sequence[Problem],
    seed: int,
    folder: RunFolder,
    log: Log,
) -> Reward | Policy:
    # `begin` has seen to it that it is of this very training.
    if folder.model.exists():
        return method.learns.load(folder.model)

    def log_row(row: dict[str, Any]) -> None:
        folder.log(row)
        log(row)

    generator = torch.Generator().manual_seed(seed)
    before = generator.get_state()
    learned = method.fit(
        train_set(request.benchmark, problems, oracle=method.oracle, expert=method.expert),
        generator=generator,
        device=request.device,
        log=log_row,
        checkpoint=folder.checkpoint,
    )
    if not isinstance(learned, method.learns):
        found, said = type(learned).__name__, method.learns.__name__
        raise UsageError(f"{request.method}: fit returned a {found}, but learns = {said}.")
    # Before the model: a kill in between repeats the end of the training.
    folder.note_training(drew=not torch.equal(before, generator.get_state()))
    with writing(folder.model):
        save_model(folder.path, learned.save, request.config(seed))
    return learned


def control_tables(
    benchmark: Benchmark,
    problems: Sequence[Problem],
    *,
    progress: Callable[[str], None] = lambda _: None,
) -> dict[str, dict[str, Any]]:
    """The rows that stand in every table: random and optimal policies, constant and lexical reward.

    Returns:
        Control → split table, with the total over all splits as `"all"`.
    """
    tables: dict[str, dict[str, Any]] = {}
    for name, outcomes_of in control_evaluations(benchmark, problems).items():
        outcomes = outcomes_of()
        total = percentage(outcome.success for outcome in outcomes)
        tables[name] = {**split_table(outcomes), "all": total}
        progress(name)
    return tables


def control_evaluations(
    benchmark: Benchmark, problems: Sequence[Problem]
) -> dict[str, Callable[[], tuple[Outcome, ...]]]:
    """What makes the outcomes of each control: all that is known of it is its name."""
    return {
        "random": lambda: evaluate_random(problems),
        "optimal": lambda: evaluate_optimal(problems, benchmark.semantics.success_reward),
        "constant": lambda: evaluate(ConstantReward(), problems),
        "lexical": lambda: evaluate(LexicalReward(), problems),
    }
