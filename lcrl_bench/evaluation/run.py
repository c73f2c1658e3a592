"""`RunSpec` and `run`: one training with its evaluation, from its settings to its results.

A finished run is read back instead of repeated; an interrupted one resumes.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from datetime import datetime
from pathlib import Path
from typing import Any, Final

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.evaluation.controls import CONTROLS
from lcrl_bench.evaluation.harness import ConstantReward, evaluate_each, own_command
from lcrl_bench.evaluation.identity import MADE_WITH, made_with
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.model_identity import save_model
from lcrl_bench.evaluation.optimizers import (
    DQN_TASKS,
    DqnSettings,
    Optimizer,
    optimize_again,
    optimizer_files,
)
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.session import ImageSize, Session, Workplace
from lcrl_bench.evaluation.settings import DEFAULT_PRESET, make_method, settings_document
from lcrl_bench.methods.contract import Log, Method, Policy, Reward
from lcrl_bench.methods.registry import resolve_method, short_name
from lcrl_bench.methods.train_set import train_set
from lcrl_bench.names import LONGEST, slug
from lcrl_bench.storage import sha256_of, writing

SCALED: Final = ("passes", "least_steps", "steps", "episodes")
"""Settings for the length of training; a budget scales these down."""


@dataclass(frozen=True)
class RunSpec:
    """Identifies a run: method, settings, seed, and the optimizer of its reward."""

    method: str
    """A registered method, `path/to/file.py:Class`, or the name of a control."""
    seed: int = 0
    preset: str = DEFAULT_PRESET
    """The method's preset that `settings` start from."""
    settings: tuple[tuple[str, str], ...] = ()
    """Settings of the method, sorted by name."""
    image_size: ImageSize | None = None
    """None for the benchmark's own size."""
    optimizer: Optimizer = Optimizer.Q_ITERATION
    budget: float | None = None
    """Fraction of the full training and of the DQN tasks; None for all."""
    dqn_tasks: int = DQN_TASKS
    control: bool = False
    """Whether `method` is a control of the suite, which needs no training."""
    code: type[Method] | None = None
    """The method's class; None to look it up by `method`."""

    @classmethod
    def of(cls, method: str, settings: Mapping[str, str], **others: Any) -> RunSpec:  # noqa: ANN401
        """A spec from settings as a mapping, in any order."""
        return cls(method, settings=tuple(sorted(settings.items())), **others)

    @property
    def variant(self) -> str:
        """The part of the folder's name that differs from the method's defaults."""
        parts = [] if self.preset == DEFAULT_PRESET else [self.preset]
        parts += [f"{key}-{value}" for key, value in self.settings]
        parts += [f"{self.image_size[0]}x{self.image_size[1]}"] if self.image_size else []
        parts += [f"budget-{self.budget:g}"] if self.budget is not None else []
        if not parts:
            return ""
        whole = "-".join(parts)
        name, digest = slug(whole), sha256_of(whole.encode())[:8]
        # Names are shortened to few letters; the digest keeps apart runs that would coincide.
        return name if name == whole else f"{slug(whole[: LONGEST - 9])}-{digest}"

    @property
    def key(self) -> str:
        """Unique name: the folder below the benchmark's, and the optimizer if not exact."""
        exact = self.optimizer == Optimizer.Q_ITERATION
        return self._folder if exact else f"{self._folder}/{self.optimizer.value}"

    @property
    def _folder(self) -> str:
        name, variant = short_name(self.method), self.variant
        if self.control:
            return f"control-{name}"
        return f"{name}-{variant}/seed{self.seed}" if variant else f"{name}/seed{self.seed}"

    @property
    def training(self) -> RunSpec:
        """The run that trains the reward: itself, with exact planning."""
        return replace(self, optimizer=Optimizer.Q_ITERATION, dqn_tasks=DQN_TASKS)

    def dqn_settings(self) -> DqnSettings:
        """Settings of DQN."""
        return DqnSettings.of(self.optimizer, self.dqn_tasks, self.budget)

    def folder(self, out: Path, benchmark: Benchmark) -> RunFolder:
        """The folder of the training: `out/<benchmark>/<method>[-<variant>]/seed<k>`."""
        return RunFolder(out / benchmark.name / self._folder)

    def method_class(self) -> type[Method]:
        """The method's class; errors as `resolve_method`."""
        return self.code or resolve_method(self.method)

    def resolved_settings(self) -> dict[str, str]:
        """Settings, with the length of training scaled by the budget."""
        chosen = dict(self.settings)
        if self.budget is None:
            return chosen
        config = getattr(self._make(chosen), "config", None)
        names = {each.name for each in fields(config)} if config is not None else set()
        for name in names.intersection(SCALED):
            chosen[name] = str(max(1, math.ceil(getattr(config, name) * self.budget)))
        return dict(sorted(chosen.items()))

    def make_method(self) -> Method:
        """The method with its settings.

        Raises:
            UnknownNameError: If there is no such method, preset or setting.
            UsageError: If the method rejects a value.
        """
        return self._make(self.resolved_settings())

    def _make(self, settings: Mapping[str, str]) -> Method:
        return make_method(self.method_class(), settings, preset=self.preset)

    def identity(self, benchmark: Benchmark, place: Workplace) -> dict[str, Any]:
        """Everything that determines the result, as JSON: what was asked for, and made with.

        Equal identities give equal bits. It is the run's `config.json`.
        """
        asked: dict[str, Any] = {
            "control" if self.control else "method": self.method,
            "settings": {} if self.control else self.resolved_settings(),
            "benchmark": benchmark.name,
            "fingerprint": benchmark.fingerprint,
        }
        if self.control:
            cpu = torch.device("cpu")
            return {**asked, MADE_WITH: made_with(None, cpu, threads=1)}
        asked["seed"] = self.seed
        if self.preset != DEFAULT_PRESET:
            asked["preset"] = self.preset
        if self.image_size is not None:
            asked["image_size"] = list(self.image_size)
        # All settings, not only the given ones: other defaults make another run.
        asked["resolved"] = settings_document(self.make_method())
        asked[MADE_WITH] = made_with(
            self.method_class(), place.device, threads=place.threads, renderer=place.renderer
        )
        return asked


@dataclass(frozen=True, eq=False)
class Run:
    """A finished run: what was learned, and its results."""

    spec: RunSpec
    folder: RunFolder
    learned: Reward | Policy
    results: Results
    read_back: datetime | None = None
    """When it finished, if it was read back; None if it ran just now."""


def run(
    spec: RunSpec,
    session: Session,
    *,
    log: Log = lambda _: None,
    tell: Callable[[float], None] = lambda _: None,
) -> Run:
    """Train, evaluate under every language control, and write the results with the controls.

    Args:
        spec: The run. With another optimizer than exact planning, the training runs first; its
            reward is then re-optimised.
        session: The benchmark, output folder and device.
        log: Called with each row of training metrics.
        tell: Called with the finished fraction of re-optimisation.

    Raises:
        UsageError: If the folder holds another run, or the method rejects a setting.
        InvalidFileError: If it holds a model from another training.
        FolderInUseError: If another process is writing to it.
    """
    if spec.control:
        return _run_control(spec, session)
    training, place = spec.training, session.place
    folder, identity = (
        training.folder(place.out, session.benchmark),
        training.identity(session.benchmark, place),
    )
    done = folder.holds(identity)
    if done:
        learned = training.method_class().learns.load(folder.model)
    else:
        with folder.locked():
            learned, done = _train(training, session, folder, identity, log)
    results = read_results(training, folder)
    if spec.optimizer != Optimizer.Q_ITERATION:
        results = optimize_again(
            folder,
            learned,
            session.task_sets(spec.image_size),
            spec.optimizer,
            spec.dqn_settings(),
            seed=spec.seed,
            tell=tell,
        )
    return Run(spec, folder, learned, results, folder.finished if done else None)


def _train(
    spec: RunSpec, session: Session, folder: RunFolder, identity: dict[str, Any], log: Log
) -> tuple[Reward | Policy, bool]:
    """What was learned, and whether the run was already finished; needs the lock."""
    place = session.place
    if folder.begin(identity, device=place.device, fresh=place.fresh):
        return spec.method_class().learns.load(folder.model), True
    # Made before houses are loaded, so that a mistyped setting fails at once.
    method = spec.make_method()
    sets = session.task_sets(spec.image_size)
    began = time.perf_counter()
    learned = _fit(method, spec, session, folder, identity, log)
    said = {"command": own_command, **language_controls(sets)}
    outcomes = evaluate_each(learned, sets, said)
    own = outcomes.pop("command")
    results = Results.of(spec.method, spec.seed, own, language=outcomes)
    folder.write_episodes(results)
    controls = session.controls()
    folder.write_controls(controls)
    wall_s = round(time.perf_counter() - began, 3)
    folder.finish(
        {
            "benchmark": session.benchmark.name,
            "fingerprint": session.benchmark.fingerprint,
            "method": spec.method,
            "oracle": method.oracle,
            "seed": spec.seed,
            "deterministic": folder.deterministic,
            **results.tables(),
            "controls": {name: each.splits() for name, each in controls.items()},
            "wall_s": wall_s,
        }
    )
    return learned, False


def _fit(
    method: Method,
    spec: RunSpec,
    session: Session,
    folder: RunFolder,
    identity: dict[str, Any],
    log: Log,
) -> Reward | Policy:
    # `begin` has checked that it is from this training.
    if folder.model.exists():
        return method.learns.load(folder.model)

    def log_row(row: dict[str, Any]) -> None:
        folder.log(row)
        log(row)

    sets = session.task_sets(spec.image_size)
    generator = torch.Generator().manual_seed(spec.seed)
    before = generator.get_state()
    learned = method.fit(
        train_set(session.benchmark, sets, oracle=method.oracle, expert=method.expert),
        generator=generator,
        device=session.place.device,
        log=log_row,
        checkpoint=folder.checkpoint,
    )
    if not isinstance(learned, method.learns):
        found, said = type(learned).__name__, method.learns.__name__
        raise UsageError(f"{spec.method}: fit returned a {found}, but learns = {said}.")
    # Before the model: if killed in between, the end of training is repeated.
    folder.note_training(drew=not torch.equal(before, generator.get_state()))
    with writing(folder.model):
        save_model(folder.path, learned.save, identity)
    return learned


def _run_control(spec: RunSpec, session: Session) -> Run:
    """Evaluate a control into its own folder, without training."""
    if spec.method not in CONTROLS:
        raise UnknownNameError("control", spec.method, CONTROLS)
    place = session.place
    folder = spec.folder(place.out, session.benchmark)
    with folder.locked():
        identity = spec.identity(session.benchmark, place)
        done = folder.begin(identity, device=place.device, fresh=place.fresh)
        if not done:
            began = time.perf_counter()
            outcomes = CONTROLS[spec.method](session.task_sets())
            results = Results.of(spec.method, 0, outcomes)
            folder.write_episodes(results)
            wall_s = round(time.perf_counter() - began, 3)
            named = {"benchmark": session.benchmark.name, "method": spec.method}
            fingerprint = session.benchmark.fingerprint
            folder.finish(
                {**named, "fingerprint": fingerprint, "splits": results.splits(), "wall_s": wall_s}
            )
    results = read_results(spec, folder)
    return Run(spec, folder, ConstantReward(), results, folder.finished if done else None)


def read_results(spec: RunSpec, folder: RunFolder) -> Results:
    """Results of a finished run, read from its files; errors as `Results.read`."""
    _, episodes = optimizer_files(folder, spec.optimizer)
    return Results.read(spec.method, {spec.seed: episodes})
