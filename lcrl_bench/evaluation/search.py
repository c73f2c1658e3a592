"""Grid search over settings, on validation houses carved from the training houses."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.catalogue import benchmark_folder
from lcrl_bench.benchmarks.document import read_benchmark
from lcrl_bench.benchmarks.task import Split
from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.errors import UsageError
from lcrl_bench.evaluation.finished_runs import is_done
from lcrl_bench.evaluation.optimizers import optimizer_files
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.run_jobs import make_run, spec_document, spec_of
from lcrl_bench.evaluation.session import ImageSize, Session, Workplace
from lcrl_bench.evaluation.settings import DEFAULT_PRESET
from lcrl_bench.evaluation.validation import carve_task_sets, carve_validation
from lcrl_bench.jobs.job import Job, Tell

Settings = tuple[tuple[str, str], ...]
"""`(("learning_rate", "4e-3"), ("views", "max"))`."""


@dataclass(frozen=True)
class Search:
    """The definition of a search."""

    method: str
    benchmark: str
    """A shipped benchmark's name, or a folder."""
    houses: int
    """Number of training houses held out."""
    out: str
    """The folder of its runs."""
    preset: str = DEFAULT_PRESET
    fresh: bool = False
    """Set aside existing runs of another identity."""

    def spec(self, settings: Settings, seed: int) -> RunSpec:
        """The run of a combination and a seed."""
        return RunSpec.of(self.method, dict(settings), seed=seed, preset=self.preset)

    def carved(self) -> Benchmark:
        """The benchmark with validation houses carved from its training houses."""
        whole = read_benchmark(benchmark_folder(self.benchmark))
        return carve_validation(whole, houses=self.houses)

    def jobs(self, specs: Sequence[RunSpec], carved: Benchmark) -> list[Job]:
        """The runs as jobs; they are kept in their own folders."""
        common = {"search": asdict(self), "fingerprint": carved.fingerprint}
        return [
            Job(
                spec.key,
                f"{__name__}:trial_job",
                {**common, "spec": spec_document(spec)},
                kept=False,
            )
            for spec in specs
        ]

    def session(self) -> Session:
        """A session on the carved benchmark."""
        place = Workplace(Path(self.out), fresh=self.fresh)
        return CarvedSession(read_benchmark(benchmark_folder(self.benchmark)), self.carved(), place)


def trial_job(arguments: Mapping[str, Any], tell: Tell) -> None:
    """The function of a search's jobs."""
    session = _session(Search(**arguments["search"]), arguments["fingerprint"])
    make_run(spec_of(arguments["spec"]), session, tell, any_computer=True)


@lru_cache(maxsize=1)
def _session(search: Search, fingerprint: str) -> Session:
    """The session that the jobs of this process share."""
    return search.session()


class CarvedSession(Session):
    """A session with the task sets of the whole benchmark, under other splits.

    Frozen views cover the arrangements of all tasks of a house, so they are the whole benchmark's.
    """

    def __init__(self, whole: Benchmark, carved: Benchmark, place: Workplace) -> None:
        """Take the whole benchmark, and the one carved from it."""
        super().__init__(carved, place)
        self._whole = Session(whole, place)
        self._carved: Sequence[TaskSet] | None = None

    def task_sets(
        self,
        image_size: ImageSize | None = None,
        *,
        progress: Callable[[str], None] = lambda _: None,
    ) -> Sequence[TaskSet]:
        """The task sets of the carved benchmark; arguments as `Session.task_sets`."""
        if self._carved is None:
            whole = self._whole.task_sets(image_size, progress=progress)
            self._carved = carve_task_sets(self.benchmark, whole)
        return self._carved

    def controls(self) -> dict[str, Results]:
        """None: combinations are compared with each other alone."""
        return {}


def combinations(options: Mapping[str, Sequence[str]]) -> tuple[Settings, ...]:
    """All combinations of the values of some settings, in the order given.

    Raises:
        UsageError: If a setting has no value.
    """
    if empty := [key for key, values in options.items() if not values]:
        raise UsageError(f"--try {empty[0]}= has no value. Example: --try {empty[0]}=1,2")
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


@dataclass(frozen=True, eq=False)
class Finding:
    """The results of a combination, averaged over its seeds."""

    settings: Settings
    results: Results

    def success(self, split: Split) -> float | None:
        """Success in percent on a split, or None; validation houses are `test-house`."""
        figure = self.results.figure(split, "total")
        return None if figure is None else figure.mean

    @property
    def score(self) -> float:
        """The score combinations are ranked by: success in the validation houses."""
        return self.success(Split.TEST_HOUSE) or 0.0


Findings = tuple[Finding, ...]


def findings(search: Search, combinations: Sequence[Settings], seeds: Sequence[int]) -> Findings:
    """The results of the finished runs, best combination first."""
    benchmark, out, found = search.carved(), Path(search.out), []
    for settings in combinations:
        files = {}
        for seed in seeds:
            spec = search.spec(settings, seed)
            if is_done(spec, out, benchmark):
                folder = spec.folder(out, benchmark)
                files[seed] = optimizer_files(folder, spec.optimizer)[1]
        if files:
            found.append(Finding(settings, Results.read(search.method, files)))
    return tuple(sorted(found, key=lambda each: -each.score))
