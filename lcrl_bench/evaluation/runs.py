"""`run` and `evaluate` for Python: all seeds of a method, or a reward or policy at hand."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch
from tqdm.auto import tqdm

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task_sets import load_benchmark
from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.evaluation.harness import evaluate_each, own_command
from lcrl_bench.evaluation.language import language_controls
from lcrl_bench.evaluation.optimizers import DQN_TASKS, Optimizer
from lcrl_bench.evaluation.results import Results
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.run import run as run_one
from lcrl_bench.evaluation.session import ImageSize, Session, Workplace, resolve_device
from lcrl_bench.evaluation.settings import DEFAULT_PRESET
from lcrl_bench.methods.contract import Method, Policy, Reward
from lcrl_bench.methods.registry import method_registry

Told = Callable[[str], None]


def run(
    method: str | type[Method] | Method,
    benchmark: str | Path | Benchmark = "lcrl-v1",
    *,
    seeds: Sequence[int] = (0,),
    settings: Mapping[str, Any] | None = None,
    preset: str = DEFAULT_PRESET,
    optimizer: str = Optimizer.Q_ITERATION.value,
    dqn_tasks: int = DQN_TASKS,
    image_size: ImageSize | None = None,
    out: str | Path = "runs",
    device: str = "auto",
    renderer: str = "auto",
    fresh: bool = False,
    progress: bool = True,
) -> Results:
    """Train a method with one or more seeds, and evaluate it on every split.

    The same as `lcrl-bench run`, without recordings (see `Results.record`): finished runs are read
    back, interrupted ones resume. Torch uses one thread, so the same call gives the same bits.

    Args:
        method: A registered name (see `list_methods`), `path/to/file.py:Class`, a class, or an
            instance, whose settings are used.
        benchmark: A benchmark, or its name or folder.
        seeds: One run per seed.
        settings: Settings of the method that differ from its preset's.
        preset: `"default"`, or another of the method's.
        optimizer: How a policy is found for a learned reward: exactly (`"q-iteration"`), or in an
            additional row from samples (`"dqn"`, `"dqn-shaping"`).
        dqn_tasks: How many tasks of each split DQN learns.
        image_size: Width and height of the views in pixels; None means the benchmark's own.
        out: Runs are written to `out/<benchmark>/<method>[-<settings>]/seed<k>`.
        device: `"auto"`, `"cpu"` or `"cuda"`.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for
            views that are neither frozen nor cached.
        fresh: If the folder holds a run of other code, set it aside instead of raising.
        progress: Whether to show progress bars.

    Returns:
        Results of all seeds, with the benchmark's controls and what each seed learned.

    Raises:
        UnknownNameError: If there is no such method, benchmark, preset, setting or optimizer.
        UsageError: If `seeds` is empty or repeats one, a setting is invalid, or the folder holds
            another run.

    Example:
        >>> quick = {"passes": 1, "least_steps": 1}
        >>> results = lcrl_bench.run("lcrl", "mini", seeds=[0, 1], settings=quick, progress=False)
        >>> results.method, results.seeds
        ('lcrl', (0, 1))
        >>> results.figure("train", "total").mean > results.beside["random"].total()
        True
    """
    seeds = tuple(int(seed) for seed in seeds)
    if not seeds:
        raise UsageError("There is no seed to run. Example: seeds=[0, 1, 2] for three runs.")
    if repeated := sorted({seed for seed in seeds if seeds.count(seed) > 1}):
        # A run counted twice would narrow the intervals.
        raise UsageError(f"seeds: {repeated[0]} is repeated; each seed is one run.")
    if not isinstance(benchmark, Benchmark):
        benchmark = load_benchmark(benchmark, renderer=renderer)
    if optimizer not in set(Optimizer):
        raise UnknownNameError("optimizer", optimizer, [each.value for each in Optimizer])
    optimizer = Optimizer(optimizer)
    name, code, own = _named(method)
    chosen = {key: str(value) for key, value in {**own, **(settings or {})}.items()}
    place = Workplace(Path(out), resolve_device(device), 1, renderer, fresh)
    first = RunSpec.of(name, chosen, preset=preset, image_size=image_size, code=code)
    specs = [replace(first, seed=seed) for seed in seeds]
    # Whatever is wrong, a setting or another run in the way, is said before houses are loaded.
    for spec in specs:
        identity = spec.identity(benchmark, place)
        spec.folder(place.out, benchmark).check(identity, fresh=fresh)
    with _one_thread(), _bars(progress) as bars:
        session = Session(benchmark, place)
        session.task_sets(image_size, progress=bars.count("houses", len(benchmark.houses)))
        runs = [
            run_one(spec, session, log=bars.follow(f"{name}, seed {spec.seed}")) for spec in specs
        ]
        results = Results.join([replace(each.results, learned=(each.learned,)) for each in runs])
        optimized = {}
        if optimizer != Optimizer.Q_ITERATION:
            again = [replace(spec, optimizer=optimizer, dqn_tasks=dqn_tasks) for spec in specs]
            found = [run_one(spec, session).results for spec in again]
            optimized = {f"{name}, {optimizer.value}": Results.join(found)}
        return replace(results, optimized=optimized, beside=session.controls())


def evaluate(
    learned: Reward | Policy,
    benchmark: str | Path | Benchmark = "lcrl-v1",
    *,
    name: str = "",
    image_size: ImageSize | None = None,
    device: str = "auto",
    renderer: str = "auto",
    progress: bool = True,
) -> Results:
    """Evaluate a reward or a policy on every split and under every language control, exactly.

    Args:
        learned: A reward, re-optimised in each task, or a policy.
        benchmark: A benchmark, or its name or folder.
        name: Name of its row; the name of its class by default.
        image_size: Width and height of the views in pixels; None means the benchmark's own.
        device: `"auto"`, `"cpu"` or `"cuda"`.
        renderer: `"auto"`, `"gl"`, `"rays"` or `"warp"`, for
            views that are neither frozen nor cached.
        progress: Whether to show a progress bar.

    Example:
        >>> quick = {"passes": 1, "least_steps": 1}
        >>> results = lcrl_bench.run("lcrl", "mini", settings=quick, progress=False)
        >>> again = lcrl_bench.evaluate(results.learned[0], "mini", progress=False)
        >>> again.figure("train", "total") == results.figure("train", "total")
        True
    """
    if not isinstance(benchmark, Benchmark):
        benchmark = load_benchmark(benchmark, renderer=renderer)
    place = Workplace(Path("runs"), resolve_device(device), 1, renderer)
    with _one_thread(), _bars(progress) as bars:
        session = Session(benchmark, place)
        houses = bars.count("houses", len(benchmark.houses))
        sets = session.task_sets(image_size, progress=houses)
        language = evaluate_each(learned, sets, {"command": own_command, **language_controls(sets)})
        outcomes = language.pop("command")
        row = name or type(learned).__name__
        results = Results.of(row, 0, outcomes, language=language)
        return replace(results, learned=(learned,), beside=session.controls())


def _named(method: str | type[Method] | Method) -> tuple[str, type[Method] | None, dict[str, Any]]:
    """A method's name, its class if it is not registered, and its settings."""
    if isinstance(method, str):
        return method, None, {}
    code = method if isinstance(method, type) else type(method)
    target = f"{code.__module__}:{code.__qualname__}"
    registered = (entry.name for entry in method_registry() if entry.target == target)
    own = {} if isinstance(method, type) else _settings(method)
    if name := next(registered, None):
        return name, None, own
    return code.__name__.lower(), code, own


def _settings(method: Method) -> dict[str, Any]:
    """The settings of an instance that differ from the defaults."""
    config: Any = getattr(method, "config", None)
    if method.Config is None or not isinstance(config, method.Config):
        return {}
    usual = method.Config()
    found = {each.name: getattr(config, each.name) for each in dataclasses.fields(config)}
    return {key: value for key, value in found.items() if value != getattr(usual, key)}


@contextmanager
def _one_thread() -> Iterator[None]:
    """Use one torch thread inside the block, so that sums have one order."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


class _Bars:
    """Progress bars, in a terminal or a notebook."""

    def __init__(self, *, shown: bool) -> None:
        self._shown = shown
        self._open: list[tqdm[Any]] = []

    def _bar(self, label: str, total: int | None = None) -> tqdm[Any]:
        bar = tqdm(desc=label, total=total, disable=not self._shown, leave=False)
        self._open.append(bar)
        return bar

    def count(self, label: str, total: int) -> Told:
        """A bar that counts; returns the function to call for each item."""
        bar = self._bar(label, total)

        def advance(_: str) -> None:
            bar.update()

        return advance

    def follow(self, label: str) -> Callable[[dict[str, Any]], None]:
        """A bar over training steps; returns the function that takes rows of the log."""
        bars: list[tqdm[Any]] = []

        def log(row: dict[str, Any]) -> None:
            bar = bars[0] if bars else self._bar(label, row.get("steps"))
            bars[:] = [bar]
            bar.update(int(row.get("step", 0)) - bar.n)

        return log

    def close(self) -> None:
        """Close all bars."""
        for bar in self._open:
            bar.close()


@contextmanager
def _bars(shown: bool) -> Iterator[_Bars]:
    bars = _Bars(shown=shown)
    try:
        yield bars
    finally:
        bars.close()
