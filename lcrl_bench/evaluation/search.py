"""Choosing settings: every combination of some values, on validation houses carved from train."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.benchmarks.task_sets import load_task_sets
from lcrl_bench.errors import LcrlError, UsageError
from lcrl_bench.evaluation.run import RunRequest, run_seed
from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.evaluation.settings import DEFAULT_PRESET, make_method
from lcrl_bench.evaluation.summary import mean_table
from lcrl_bench.evaluation.validation import carve_task_sets, carve_validation
from lcrl_bench.methods.registry import resolve_method
from lcrl_bench.names import slug

Settings = tuple[tuple[str, str], ...]
"""`(("learning_rate", "4e-3"), ("views", "max"))`."""


@dataclass(frozen=True)
class Trial:
    """One combination, with one seed."""

    settings: Settings
    seed: int

    @property
    def key(self) -> str:
        """Its name among all trials."""
        return f"{variant(self.settings)}-seed{self.seed}"


@dataclass(frozen=True)
class SearchPlace:
    """What all trials share."""

    method: str
    benchmark: str
    """A shipped benchmark's name, or a folder."""
    houses: int
    """How many training houses are held out."""
    out: Path
    preset: str = DEFAULT_PRESET
    fresh: bool = False
    """Set aside runs of another identity that are in the way."""

    def request(self, benchmark: Benchmark, settings: Settings) -> RunRequest:
        """The run of a combination on a carved benchmark."""
        return RunRequest(
            self.method,
            resolve_method(self.method),
            benchmark,
            self.out,
            dict(settings),
            preset=self.preset,
            variant=variant(settings),
            threads=1,
            fresh=self.fresh,
        )

    def carved(self) -> Benchmark:
        """The benchmark with the validation houses carved from its training houses."""
        whole = read_benchmark(benchmark_folder(self.benchmark))
        return carve_validation(whole, houses=self.houses)


def combinations(options: Mapping[str, Sequence[str]]) -> tuple[Settings, ...]:
    """Every combination of the values of some settings, in the order given.

    Raises:
        UsageError: If a setting has no value.
    """
    if empty := [key for key, values in options.items() if not values]:
        raise UsageError(f"--try {empty[0]}= names no value. Example: --try {empty[0]}=1,2")
    pairs = [[(key, value) for value in values] for key, values in options.items()]
    return tuple(itertools.product(*pairs))


def parse_options(words: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Read `("views=sum,max", "passes=60")`.

    Raises:
        UsageError: If a word has no `=`.
    """
    options: dict[str, tuple[str, ...]] = {}
    for word in words:
        key, equals, values = word.partition("=")
        if not equals:
            raise UsageError(f"--try takes key=value,value, found '{word}'.")
        options[key] = tuple(value for value in values.split(",") if value)
    return options


def variant(settings: Settings) -> str:
    """What tells a combination's folder from another's."""
    return slug("-".join(f"{key}-{value}" for key, value in settings)) if settings else "default"


@dataclass
class Searcher:
    """Does trials in one process; called with a trial and told-to progress."""

    place: SearchPlace
    _carved: tuple[Benchmark, tuple[TaskSet, ...]] | None = field(default=None, init=False)

    def __call__(self, trial: Trial, tell: Callable[[float], None]) -> None:
        """Train and evaluate a combination on the validation houses, unless that was done."""
        torch.set_num_threads(1)
        method = resolve_method(self.place.method)
        # Before houses are compiled: a mistyped setting should not take a minute.
        make_method(method, dict(trial.settings), preset=self.place.preset)
        benchmark, sets = self._validation()
        request = self.place.request(benchmark, trial.settings)
        folder = request.folder(trial.seed)

        def log(row: dict[str, Any]) -> None:
            if row.get("steps"):
                tell(row.get("step", 0) / row["steps"])

        with folder.locked():
            result = run_seed(request, sets, trial.seed, log=log, folder=folder)
            if not folder.done:
                folder.finish(result.summary)

    def _validation(self) -> tuple[Benchmark, tuple[TaskSet, ...]]:
        if self._carved is None:
            whole = read_benchmark(benchmark_folder(self.place.benchmark))
            sets = load_task_sets(whole, device=torch.device("cpu"))
            carved = self.place.carved()
            self._carved = carved, carve_task_sets(carved, sets)
        return self._carved


@dataclass(frozen=True)
class Finding:
    """What a combination achieved, averaged over its seeds."""

    settings: Settings
    seeds: int
    success: Mapping[str, float | None]
    """Per cent, by split, None where it has no task: on validation houses it is `test-house`."""

    @property
    def score(self) -> float:
        """What combinations are ranked by: success in the validation houses."""
        return self.success[Split.TEST_HOUSE.value] or 0.0


def finished_trials(place: SearchPlace, trials: Sequence[Trial]) -> dict[Trial, RunFolder]:
    """The trials that are finished with the very identity they have now, and their folders."""
    carved, found = place.carved(), {}
    for trial in trials:
        request = place.request(carved, trial.settings)
        folder = request.folder(trial.seed)
        # A setting that the method refuses has a folder at most.
        with suppress(LcrlError):
            if folder.holds(request.config(trial.seed)):
                found[trial] = folder
    return found


def findings(place: SearchPlace, trials: Sequence[Trial]) -> tuple[Finding, ...]:
    """What the finished trials achieved, the best combination first."""
    finished, found = finished_trials(place, trials), []
    for settings in dict.fromkeys(trial.settings for trial in trials):
        folders = [folder for trial, folder in finished.items() if trial.settings == settings]
        if folders:
            mean = mean_table([folder.summary()["splits"] for folder in folders])
            success = {split.value: mean[split.value]["total"] for split in Split}
            found.append(Finding(settings, len(folders), success))
    return tuple(sorted(found, key=lambda each: -each.score))
