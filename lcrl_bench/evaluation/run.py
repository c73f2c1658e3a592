"""`RunSpec` and `run`: one training and its evaluation, from what identifies it to its results.

A run that is done is read back, not repeated; one that was interrupted goes on.
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
"""Settings that say how long a method trains: what a budget makes smaller."""


@dataclass(frozen=True)
class RunSpec:
    """Which run: what is trained, with which settings and seed, and how it is optimised again."""

    method: str
    """A registered method, or `path/to/file.py:Class`; of a control its name."""
    seed: int = 0
    preset: str = DEFAULT_PRESET
    """Which of the method's presets `settings` changes."""
    settings: tuple[tuple[str, str], ...] = ()
    """Settings of the method, in order of names."""
    image_size: ImageSize | None = None
    """None: the benchmark's own."""
    optimizer: Optimizer = Optimizer.Q_ITERATION
    budget: float | None = None
    """The share of the full training, and of the tasks sampled for DQN; None: all."""
    dqn_tasks: int = DQN_TASKS
    control: bool = False
    """Whether `method` names a control of the suite, which is not trained."""
    code: type[Method] | None = None
    """The method's class; None: the one that `method` names."""

    @classmethod
    def of(cls, method: str, settings: Mapping[str, str], **others: Any) -> RunSpec:  # noqa: ANN401
        """A spec with settings given as a mapping, in any order."""
        return cls(method, settings=tuple(sorted(settings.items())), **others)

    @property
    def variant(self) -> str:
        """What tells the run's folder from that of the method's defaults."""
        parts = [] if self.preset == DEFAULT_PRESET else [self.preset]
        parts += [f"{key}-{value}" for key, value in self.settings]
        parts += [f"{self.image_size[0]}x{self.image_size[1]}"] if self.image_size else []
        parts += [f"budget-{self.budget:g}"] if self.budget is not None else []
        if not parts:
            return ""
        whole = "-".join(parts)
        name, digest = slug(whole), sha256_of(whole.encode())[:8]
        # A name is cut, and has few letters: two runs whose names become alike are still two.
        return name if name == whole else f"{slug(whole[: LONGEST - 9])}-{digest}"

    @property
    def key(self) -> str:
        """Its name among all runs: the folder below the benchmark's, and what is done with it."""
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
        """The run whose reward is optimised again: this one, if it is a training itself."""
        return replace(self, optimizer=Optimizer.Q_ITERATION, dqn_tasks=DQN_TASKS)

    def dqn_settings(self) -> DqnSettings:
        """What DQN is run with."""
        return DqnSettings.of(self.optimizer, self.dqn_tasks, self.budget)

    def folder(self, out: Path, benchmark: Benchmark) -> RunFolder:
        """The folder of the training: `out/<benchmark>/<method>[-<variant>]/seed<k>`."""
        return RunFolder(out / benchmark.name / self._folder)

    def method_class(self) -> type[Method]:
        """The method's class; errors as `resolve_method`."""
        return self.code or resolve_method(self.method)

    def resolved_settings(self) -> dict[str, str]:
        """Settings, with those that say how long made smaller by the budget."""
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
            UsageError: If a setting has a value that the method refuses.
        """
        return self._make(self.resolved_settings())

    def _make(self, settings: Mapping[str, str]) -> Method:
        return make_method(self.method_class(), settings, preset=self.preset)

    def identity(self, benchmark: Benchmark, place: Workplace) -> dict[str, Any]:
        """What gave the bits of the training, as JSON: what is asked for, and what it is made with.

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
        # All settings, not only those that were asked for: a run under other defaults is another.
        asked["resolved"] = settings_document(self.make_method())
        asked[MADE_WITH] = made_with(
            self.method_class(), place.device, threads=place.threads, renderer=place.renderer
        )
        return asked


@dataclass(frozen=True, eq=False)
class Run:
    """A finished training: what it learned, and what that achieved."""

    spec: RunSpec
    folder: RunFolder
    learned: Reward | Policy
    results: Results
    read_back: datetime | None = None
    """When it was finished, if it was read back; None if it was run now."""


def run(
    spec: RunSpec,
    session: Session,
    *,
    log: Log = lambda _: None,
    tell: Callable[[float], None] = lambda _: None,
) -> Run:
    """Train, evaluate under every language control, write the controls beside it, and finish.

    Args:
        spec: Which run. A spec with another optimizer than exact planning has its training run
            first, whose reward is then optimised again.
        session: The benchmark, and where to run.
        log: Told every row of the training.
        tell: Told the share that is done of optimising again.

    Raises:
        UsageError: If the folder holds another run, or a setting does not fit the method.
        InvalidFileError: If it holds a model that its training did not make.
        FolderInUseError: If another process writes it.
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
    """What the run learned, and whether it was done already; the folder is locked."""
    place = session.place
    if folder.begin(identity, device=place.device, fresh=place.fresh):
        return spec.method_class().learns.load(folder.model), True
    # Made before houses are loaded: a mistyped setting should not take a minute.
    method = spec.make_method()
    sets = session.task_sets(spec.image_size)
    began = time.perf_counter()
    learned = _fit(method, spec, session, folder, identity, log)
    said = {"command": own_command, **language_controls(sets)}
    outcomes = evaluate_each(learned, sets, said)
    own = outcomes.pop("command")
    results = Results.of(spec.method, spec.seed, own, language=outcomes)
    folder.write_episodes(results)
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
            "controls": {name: each.splits() for name, each in session.controls().items()},
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
    # `begin` has seen to it that it is of this very training.
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
    # Before the model: a kill in between repeats the end of the training.
    folder.note_training(drew=not torch.equal(before, generator.get_state()))
    with writing(folder.model):
        save_model(folder.path, learned.save, identity)
    return learned


def _run_control(spec: RunSpec, session: Session) -> Run:
    """Evaluate a control into a folder of its own; there is nothing to train."""
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
    """What a finished run achieved, from its files; errors as `Results.read`."""
    _, episodes = optimizer_files(folder, spec.optimizer)
    return Results.read(spec.method, {spec.seed: episodes})
