"""`lcrl-bench run`: train a method, evaluate it on every split, record it, print the table."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.fan_out import Done, FanOut, do_jobs, ended_early
from lcrl_bench.cli.output import (
    print_json,
    print_table,
    print_text,
    say,
    stdout_kept_clean,
    suggest,
)
from lcrl_bench.cli.progress import Bar, counting, working
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.interruption import resumable
from lcrl_bench.jobs.engine import Ended
from lcrl_bench.jobs.job import Answer

if TYPE_CHECKING:
    # At run time these would import torch before a mistyped flag is named.
    from lcrl_bench.evaluation.results import Results
    from lcrl_bench.evaluation.run import Run, RunSpec
    from lcrl_bench.evaluation.session import Session


@dataclass(frozen=True)
class RunFlags:
    """Train a method, evaluate it on every split, record it, and print the success table."""

    method: str
    """A registered method (`lcrl-bench list methods`), or `path/to/file.py:Class`."""
    benchmark: str = "lcrl-v1"
    """A shipped benchmark (`lcrl-bench list benchmarks`), or the folder of one of your own."""
    seeds: tuple[int, ...] = (0,)
    """One run per seed; the table shows their mean, with its 95 % interval if there are several."""
    out: Path = Path("runs")
    """Where runs are written: OUT/<benchmark>/<method>/seed<k>."""
    set: tuple[str, ...] = ()
    """Settings of the method, key=value: `--set passes=20 learning_rate=1e-3`. Runs with other
    settings get a folder of their own: OUT/<benchmark>/<method>-learning_rate-1e-3-passes-20."""
    preset: str = "default"
    """`default`, or another of the method's: `paper` for what the paper states. Runs of a preset
    are written beside: OUT/<benchmark>/<method>-<preset>."""
    optimizer: Literal["q-iteration", "dqn", "dqn-shaping"] = "q-iteration"
    """What finds a policy for a learned reward: exact planning; or, in a row of its own, DQN from
    samples, without or with a potential that takes known dynamics."""
    dqn_tasks: int = 60
    """How many tasks of each split DQN learns, each from scratch; a large number takes all."""
    device: str = "auto"
    """auto, cpu or cuda."""
    threads: int = 1
    """Threads of torch on a CPU. One is about as fast as two here, and keeps sums in one order: the
    same command gives the same bits."""
    renderer: str = "auto"
    """For views that are not in the cache: auto, gl (MuJoCo's cameras) or rays (no OpenGL)."""
    record: Literal["none", "showcase", "first", "failures", "all"] = "showcase"
    """Episodes to record of each run: none (also `--no-record`); the showcase of up to three; and
    beside it, a file each, the first task of every split and kind, up to 20 failures, or all."""
    fresh: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Where another run is in the way, one of other settings or other code, set it aside as
    seed<k>.old1 and start anew. The same run is still read back or gone on with."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""
    fan_out: FanOut = field(default_factory=lambda: FanOut(workers=1))


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(RunFlags, _spelled_out(argv), verb="run")
    began = time.perf_counter()
    command = ["lcrl-bench", "run", *argv]
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        done = _train_apart(flags)
        if (code := ended_early(done, command)) is not None:
            return code
        results, runs, session = _run(flags)
        if not flags.json:
            # Before the recordings, so that nobody waits for pictures to see figures.
            _print_tables(results)
        recordings = [_record(flags, run, session) for run in runs]
    if flags.json:
        print_json(_answer(flags, results, runs, session, recordings[0], began))
        return ExitCode.DONE
    benchmark = session.benchmark
    say(f"benchmark {benchmark.name}, fingerprint {benchmark.fingerprint[:12]}")
    if recordings[0]:
        say(f"recording: {recordings[0]}")
        suggest([_beside_python("lcrl-bench"), "view", recordings[0]], "scrub through it")
    return ExitCode.DONE


def _spelled_out(argv: Sequence[str]) -> list[str]:
    """The words with `--no-record` as what it stands for."""
    pairs = [["--record", "none"] if word == "--no-record" else [word] for word in argv]
    return [word for pair in pairs for word in pair]


def _specs(flags: RunFlags) -> list[RunSpec]:
    from lcrl_bench.evaluation.run import RunSpec
    from lcrl_bench.evaluation.settings import parse_settings

    settings = parse_settings(flags.set)
    return [
        RunSpec.of(flags.method, settings, seed=seed, preset=flags.preset) for seed in flags.seeds
    ]


def _train_apart(flags: RunFlags) -> Done:
    """Train the seeds in other processes, if the flags say so; they are read back afterwards."""
    if flags.fan_out == FanOut(workers=1):
        return Done((), None)
    if flags.threads != 1:
        raise UsageError(
            f"--threads {flags.threads}: seeds that run in processes of their own "
            "have one thread each."
        )
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.finished_runs import is_done
    from lcrl_bench.evaluation.reproduction.runner import Bench, run_jobs_of

    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    specs = {spec.key: spec for spec in _specs(flags)}
    if flags.fan_out.only_read:
        missing = [key for key, spec in specs.items() if not is_done(spec, flags.out, benchmark)]
        return Done(
            tuple(Ended(key, "not done yet", answer=Answer(exit_code=1)) for key in missing), None
        )
    means = {"device": flags.device, "renderer": flags.renderer, "fresh": flags.fresh}
    bench = Bench(flags.benchmark, benchmark.fingerprint, str(flags.out), **means)
    return do_jobs(run_jobs_of(bench, specs), flags.fan_out)


def _run(flags: RunFlags) -> tuple[Results, list[Run], Session]:
    """Make the runs of all seeds; what they achieved together stands first."""
    import torch

    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.results import Results
    from lcrl_bench.evaluation.session import Session, Workplace, resolve_device

    torch.set_num_threads(flags.threads)
    device = resolve_device(flags.device)
    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    place = Workplace(flags.out, device, flags.threads, flags.renderer, flags.fresh)
    specs = _specs(flags)
    # Whatever is wrong, a setting or another run in the way, is said before houses are loaded.
    for spec in specs:
        identity = spec.identity(benchmark, place)
        spec.folder(flags.out, benchmark).check(identity, fresh=flags.fresh)
    with counting("houses", len(benchmark.houses)) as advance:
        session = Session(benchmark, place, progress=advance)
        session.task_sets()
    with counting("controls", 4) as advance:
        controls = session.controls(progress=advance)
    runs = [_run_seed(spec, session) for spec in specs]
    again = [_optimize_again(flags, spec, session) for spec in specs]
    results = Results.join([run.results for run in runs])
    name, others = f"{flags.method}, {flags.optimizer}", [each for each in again if each]
    optimized = {name: Results.join(others)} if others else {}
    return replace(results, optimized=optimized, beside=controls), runs, session


def _run_seed(spec: RunSpec, session: Session) -> Run:
    from lcrl_bench.evaluation.run import run

    with Bar(f"{spec.method}, seed {spec.seed}", afterwards="evaluating") as bar:
        found = run(spec, session, log=bar.log)
    if found.folder.aside:
        say(f"seed {spec.seed}: the run that was there is set aside, as {found.folder.aside}")
    if found.read_back:
        say(_read_back(found))
    return found


def _read_back(run: Run) -> str:
    """What to say of a run that was not run now."""
    from lcrl_bench.evaluation.environment import other_versions

    folder, when = run.folder.path, f"{run.read_back:%Y-%m-%d %H:%M}"
    others = other_versions(folder)
    beside = f", with {', '.join(others)}" if others else ""
    return f"seed {run.spec.seed}: read back from {folder} (finished {when}{beside})"


def _optimize_again(flags: RunFlags, spec: RunSpec, session: Session) -> Results | None:
    """What DQN makes of a learned reward, if it was asked for."""
    from lcrl_bench.evaluation.optimizers import Optimizer, optimizer_files
    from lcrl_bench.evaluation.run import run

    optimizer = Optimizer(flags.optimizer)
    if optimizer == Optimizer.Q_ITERATION:
        return None
    began = time.time()
    with Bar(f"{flags.optimizer}, seed {spec.seed}") as bar:
        found = run(
            replace(spec, optimizer=optimizer, dqn_tasks=flags.dqn_tasks),
            session,
            tell=lambda share: bar.log({"step": round(1000 * share), "steps": 1000}),
        )
    summary, _ = optimizer_files(found.folder, optimizer)
    if (finished := summary.stat().st_mtime) < began:
        when = f"{datetime.fromtimestamp(finished):%Y-%m-%d %H:%M}"
        say(f"seed {spec.seed}: {flags.optimizer} read back from {found.folder.path} ({when})")
    return found.results


def _record(flags: RunFlags, run: Run, session: Session) -> str | None:
    """Record episodes of a run, unless that was done; the recording's path."""
    from lcrl_bench.recording.index import RECORDING_FILE, is_recorded

    path = run.folder.path / RECORDING_FILE
    if flags.record == "none":
        return str(path) if path.exists() else None
    if not is_recorded(run.folder.path, flags.record):
        from lcrl_bench.recording.run_recording import record_run

        with run.folder.locked(), counting("recordings", 0) as advance:
            record_run(run, session, flags.record, progress=advance)
    return str(path)


def _print_tables(results: Results) -> None:
    """One block per split, with a line between."""
    from lcrl_bench.evaluation.table import table_blocks

    with working("intervals"):
        blocks = table_blocks(results)
    for number, block in enumerate(blocks):
        if number:
            print_text("")
        print_table(block.headings, block.rows, right=block.headings[1:])
    sys.stdout.flush()


def _answer(
    flags: RunFlags,
    results: Results,
    runs: Sequence[Run],
    session: Session,
    recording: str | None,
    began: float,
) -> dict[str, Any]:
    """The JSON answer."""
    with working("intervals"):
        figures = results.figures()
    optimizer = [
        {"name": flags.optimizer, "splits": each.splits()} for each in results.optimized.values()
    ]
    return {
        "benchmark": session.benchmark.name,
        "fingerprint": session.benchmark.fingerprint,
        "method": flags.method,
        "seeds": list(flags.seeds),
        **results.tables(),
        "intervals": {
            split: {kind: figure and figure.bounds for kind, figure in row.items()}
            for split, row in figures.items()
        },
        "controls": {name: each.total() for name, each in results.beside.items()},
        "control_splits": {name: each.splits() for name, each in results.beside.items()},
        **({"optimizer": optimizer[0]} if optimizer else {}),
        "recording": recording,
        "read_back": {
            str(run.spec.seed): run.read_back.isoformat() for run in runs if run.read_back
        },
        "wall_s": round(time.perf_counter() - began, 3),
    }


def _beside_python(command: str) -> str:
    """A console script of this environment, by a path that works from where the person is."""
    script = Path(sys.executable).with_name(command)
    if not script.exists():
        return command
    here = Path.cwd()
    return str(script.relative_to(here)) if script.is_relative_to(here) else str(script)
