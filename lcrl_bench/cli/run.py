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
from lcrl_bench.cli.fan_out import FanOut, do_jobs, ended_early, say_missing
from lcrl_bench.cli.output import (
    print_json,
    print_table,
    print_text,
    say,
    stdout_kept_clean,
    suggest,
)
from lcrl_bench.cli.progress import working
from lcrl_bench.errors import ExitCode, UsageError
from lcrl_bench.interruption import resumable
from lcrl_bench.jobs.performance import do_here

if TYPE_CHECKING:
    # At run time these would import torch before a mistyped flag is named.
    from lcrl_bench.evaluation.results import Results
    from lcrl_bench.evaluation.run import RunSpec
    from lcrl_bench.evaluation.run_jobs import FinishedRun, SessionSpec


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
    """For views that are not in the cache: auto, gl (MuJoCo's cameras), rays (no OpenGL)
    or warp (MuJoCo Warp)."""
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
        made = _made(flags, command)
        if isinstance(made, int):
            return made
        results = _results(made.runs)
        if not flags.json:
            # Before the recordings, so that nobody waits for pictures to see figures.
            _print_tables(results)
        recording = _record(flags, made, command)
        if isinstance(recording, int):
            return recording
    if flags.json:
        print_json(_answer(flags, results, made, recording, began))
        return ExitCode.DONE
    say(f"benchmark {made.benchmark}, fingerprint {made.session.fingerprint[:12]}")
    if recording:
        say(f"recording: {recording}")
        suggest([_beside_python("lcrl-bench"), "view", recording], "scrub through it")
    return ExitCode.DONE


def _spelled_out(argv: Sequence[str]) -> list[str]:
    """The words with `--no-record` as what it stands for."""
    pairs = [["--record", "none"] if word == "--no-record" else [word] for word in argv]
    return [word for pair in pairs for word in pair]


@dataclass(frozen=True)
class _Made:
    """The runs of all seeds."""

    benchmark: str
    """Its name."""
    session: SessionSpec
    trainings: dict[str, RunSpec]
    runs: tuple[FinishedRun, ...]
    """Each seed's, then those of another optimizer."""


def _made(flags: RunFlags, command: Sequence[str]) -> _Made | int:
    """Make the runs, or read them back; an exit code if that ends the command."""
    from lcrl_bench.evaluation.run_jobs import FinishedRun, check_job, run_jobs_of

    session, trainings = _session(flags), _specs(flags)
    specs = {**trainings, **_optimized_again(flags, trainings)}
    # Whatever is wrong, a setting or another run in the way, is said before houses are loaded.
    known = do_here(check_job(session, specs))
    if flags.fan_out.only_read and known["missing"]:
        return say_missing(known["missing"])
    session = replace(session, fingerprint=known["fingerprint"])
    done = do_jobs(run_jobs_of(session, specs), _where(flags), share=1)
    if (code := ended_early(done, command)) is not None:
        return code
    answers = done.values()
    runs = tuple(FinishedRun(**answers[key]) for key in specs)
    for run in runs:
        _say_what_was_there(run)
    return _Made(known["benchmark"], session, trainings, runs)


def _session(flags: RunFlags) -> SessionSpec:
    from lcrl_bench.evaluation.run_jobs import SessionSpec

    if flags.threads != 1 and flags.fan_out != FanOut(workers=1):
        raise UsageError(
            f"--threads {flags.threads}: seeds that run in processes of their own "
            "have one thread each."
        )
    return SessionSpec(
        flags.benchmark,
        str(flags.out),
        flags.device,
        flags.threads,
        flags.renderer,
        fresh=flags.fresh,
    )


def _specs(flags: RunFlags) -> dict[str, RunSpec]:
    """The training of each seed, by name."""
    from lcrl_bench.evaluation.run import RunSpec
    from lcrl_bench.evaluation.settings import parse_settings

    settings = parse_settings(flags.set)
    specs = [
        RunSpec.of(flags.method, settings, seed=seed, preset=flags.preset) for seed in flags.seeds
    ]
    return {spec.key: spec for spec in specs}


def _optimized_again(flags: RunFlags, trainings: dict[str, RunSpec]) -> dict[str, RunSpec]:
    """What DQN makes of each learned reward, if it was asked for."""
    from lcrl_bench.evaluation.optimizers import Optimizer

    optimizer = Optimizer(flags.optimizer)
    if optimizer == Optimizer.Q_ITERATION:
        return {}
    means = {"optimizer": optimizer, "dqn_tasks": flags.dqn_tasks}
    specs = [replace(spec, **means) for spec in trainings.values()]
    return {spec.key: spec for spec in specs}


def _where(flags: RunFlags) -> FanOut:
    """Where jobs are done: what all shards have finished is read back here."""
    return FanOut(workers=1) if flags.fan_out.only_read else flags.fan_out


def _say_what_was_there(run: FinishedRun) -> None:
    if run.aside:
        say(f"seed {run.seed}: the run that was there is set aside, as {run.aside}")
    if run.read_back:
        what = "" if run.optimizer == "q-iteration" else f"{run.optimizer} "
        when = f"{datetime.fromisoformat(run.read_back):%Y-%m-%d %H:%M}"
        beside = f", with {', '.join(run.versions)}" if run.versions else ""
        say(f"seed {run.seed}: {what}read back from {run.folder} (finished {when}{beside})")


def _results(runs: Sequence[FinishedRun]) -> Results:
    """What the runs achieved together, from their files."""
    from lcrl_bench.evaluation.run_jobs import joined_results

    return joined_results(runs)


def _record(flags: RunFlags, made: _Made, command: Sequence[str]) -> str | int | None:
    """Record episodes of the runs, unless that was done; the recording of the first seed.

    An exit code if a recording failed.
    """
    from lcrl_bench.recording.index import RECORDING_FILE, is_recorded

    folders = [Path(run.folder) for run in made.runs[: len(made.trainings)]]
    first = folders[0] / RECORDING_FILE
    if flags.record == "none":
        return str(first) if first.exists() else None
    left = {
        key: spec
        for folder, (key, spec) in zip(folders, made.trainings.items(), strict=True)
        if not is_recorded(folder, flags.record)
    }
    if left:
        from lcrl_bench.recording.run_recording import record_jobs_of

        jobs = record_jobs_of(made.session, left, flags.record)
        done = do_jobs(jobs, _where(flags), share=1)
        if (code := ended_early(done, command)) is not None:
            return code
    return str(first)


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
    flags: RunFlags, results: Results, made: _Made, recording: str | None, began: float
) -> dict[str, Any]:
    """The JSON answer."""
    with working("intervals"):
        figures = results.figures()
    optimizer = [
        {"name": flags.optimizer, "splits": each.splits()} for each in results.optimized.values()
    ]
    trained = made.runs[: len(made.trainings)]
    return {
        "benchmark": made.benchmark,
        "fingerprint": made.session.fingerprint,
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
        "read_back": {str(run.seed): run.read_back for run in trained if run.read_back},
        "wall_s": round(time.perf_counter() - began, 3),
    }


def _beside_python(command: str) -> str:
    """A console script of this environment, by a path that works from where the person is."""
    script = Path(sys.executable).with_name(command)
    if not script.exists():
        return command
    here = Path.cwd()
    return str(script.relative_to(here)) if script.is_relative_to(here) else str(script)
