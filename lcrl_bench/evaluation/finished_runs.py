"""Finished runs on disk: finding them, comparing them with a spec, and loading their models."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.errors import InvalidFileError, LcrlError, NothingSelectedError, UsageError
from lcrl_bench.evaluation.identity import differences, without_computer
from lcrl_bench.evaluation.model_identity import check_model, model_digest
from lcrl_bench.evaluation.optimizers import Optimizer, is_current, optimizer_files
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.evaluation.run_folder import RunFolder, is_set_aside
from lcrl_bench.evaluation.session import Workplace
from lcrl_bench.evaluation.settings import DEFAULT_PRESET
from lcrl_bench.methods.contract import Policy, Reward
from lcrl_bench.storage import read_json

RUNS: Final = Path("runs")
"""Default output folder of `run`."""
_DEPTHS: Final = ("*", "*/*", "*/*/*")
"""Depths of runs in a folder: side by side, by method, or by benchmark and method."""


def find_run(folder: Path = RUNS) -> Path:
    """The run that a folder refers to.

    Args:
        folder: A run, `runs/<benchmark>/<method>/seed<k>`; or a folder above it, which refers to
            the last run finished in it.

    Raises:
        UsageError: If there is no such folder.
        NothingSelectedError: If there is no finished run in it.
    """
    if (folder / "config.json").is_file():
        return folder
    train = "Train one: lcrl-bench run --method lcrl --benchmark mini"
    if not folder.is_dir() and folder != RUNS:
        raise UsageError(f"No folder {folder}. Name a run: runs/<benchmark>/<method>/seed<k>.")
    runs = finished_runs(folder)
    if not runs:
        raise NothingSelectedError(f"No finished run in {folder}. {train}")
    return runs[0]


def finished_runs(folder: Path) -> tuple[Path, ...]:
    """The finished runs up to three levels below a folder, most recent first."""
    found = [path for depth in _DEPTHS for path in folder.glob(depth) if RunFolder(path).done]
    runs = [path for path in found if (path / "config.json").is_file() and not is_set_aside(path)]
    return tuple(sorted(runs, key=lambda path: (-(path / "DONE").stat().st_mtime_ns, path)))


def is_done(spec: RunSpec, out: Path, benchmark: Benchmark) -> bool:
    """Whether a run is finished, with exactly the current configuration and code.

    Device, kernel, threads and renderer don't matter.
    """
    folder = spec.folder(out, benchmark)
    if not folder.done or folder.config is None or changes(spec, out, benchmark):
        return False
    try:
        folder.summary()
        model = model_digest(folder.path)
    except InvalidFileError:
        return False
    if spec.optimizer == Optimizer.Q_ITERATION:
        return True
    summary, _ = optimizer_files(folder, spec.optimizer)
    return is_current(summary, spec.dqn_settings(), model)


def changes(spec: RunSpec, out: Path, benchmark: Benchmark) -> tuple[str, ...]:
    """How the run in a spec's folder differs from the spec's; see `differences`.

    Empty if they differ at most in what computes them, or if there is no run.
    """
    before = spec.folder(out, benchmark).config
    if before is None:
        return ()
    try:
        now = spec.training.identity(benchmark, Workplace(out))
    except LcrlError:
        return ("a method that can't be made here",)
    return differences(without_computer(before), without_computer(now))


def read_run(folder: Path) -> tuple[RunSpec, Reward | Policy]:
    """Read the spec of a finished training and its model from its folder.

    Args:
        folder: `runs/<benchmark>/<method>/seed<k>`. Its `config.json` names the method, whose code
            is imported.

    Raises:
        InvalidFileError: If the folder has no run, or its model is damaged or from another
            training.
        UnknownNameError: If its method is not installed here.
        UsageError: If it learned from views of another size than its benchmark's.
    """
    path = folder / "config.json"
    document = read_json(path)
    try:
        spec = RunSpec.of(
            str(document["method"]),
            {str(key): str(value) for key, value in dict(document["settings"]).items()},
            seed=int(document.get("seed", 0)),
            preset=str(document.get("preset", DEFAULT_PRESET)),
        )
    except (KeyError, TypeError, ValueError) as error:
        reason = f"not the configuration of a run: {error!r}"
        fix = "Name a folder runs/<benchmark>/<method>/seed<k>."
        raise InvalidFileError(path, reason, fix=fix) from error
    if "image_size" in document:
        size = document["image_size"]
        raise UsageError(f"{folder}: learned from views of {size} pixels, of another size.")
    method = spec.method_class()
    check_model(folder)
    return spec, method.learns.load(RunFolder(folder).model)


def read_reward(folder: Path) -> Reward:
    """The reward that a run learned; arguments and errors as in `read_run`.

    Raises:
        UsageError: If the run learned a policy.
    """
    _, learned = read_run(folder)
    if not isinstance(learned, Reward):
        raise UsageError(f"{folder}: its method learned a policy, which has no reward.")
    return learned
