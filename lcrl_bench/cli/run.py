"""`lcrl-bench run`: train a method, evaluate it on every split, record it, print the table."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import (
    print_json,
    print_table,
    print_text,
    say,
    stdout_kept_clean,
    suggest,
)
from lcrl_bench.cli.progress import Bar, counting, working
from lcrl_bench.errors import ExitCode
from lcrl_bench.interruption import resumable


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
    """Settings of the method, key=value: `--set passes=20 learning_rate=1e-3`."""
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


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(RunFlags, _spelled_out(argv), verb="run")
    with resumable(shlex.join(["lcrl-bench", "run", *argv])), stdout_kept_clean(flags.json):
        answer, tables = _run(flags)
    if flags.json:
        print_json(answer)
        return ExitCode.DONE
    _print_tables(flags, answer, tables)
    say(f"benchmark {answer['benchmark']}, fingerprint {answer['fingerprint'][:12]}")
    if answer["recording"]:
        say(f"recording: {answer['recording']}")
        suggest([_beside_python("lcrl-bench"), "view", answer["recording"]], "scrub through it")
    return ExitCode.DONE


def _print_tables(flags: RunFlags, answer: dict[str, Any], tables: dict[str, Any]) -> None:
    """One block per split, with a line between."""
    from lcrl_bench.evaluation.table import table_blocks

    several = {flags.method: answer["intervals"]} if len(flags.seeds) > 1 else {}
    for number, block in enumerate(table_blocks(tables, intervals=several)):
        if number:
            print_text("")
        print_table(block.headings, block.rows, right=block.headings[1:])


def _spelled_out(argv: Sequence[str]) -> list[str]:
    """The words with `--no-record` as what it stands for."""
    pairs = [["--record", "none"] if word == "--no-record" else [word] for word in argv]
    return [word for pair in pairs for word in pair]


def _run(flags: RunFlags) -> tuple[dict[str, Any], dict[str, Any]]:
    """Everything but the printing: the JSON answer and the table's rows."""
    import torch

    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.problems import compile_problems
    from lcrl_bench.evaluation.run import RunRequest, control_tables, resolve_device, run_seed
    from lcrl_bench.evaluation.settings import DEFAULT_PRESET, parse_settings
    from lcrl_bench.evaluation.summary import interval_table, mean_table
    from lcrl_bench.methods.registry import resolve_method

    began = time.perf_counter()
    torch.set_num_threads(flags.threads)
    device = resolve_device(flags.device)
    method_class = resolve_method(flags.method)
    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    request = RunRequest(
        flags.method,
        method_class,
        benchmark,
        flags.out,
        parse_settings(flags.set),
        device,
        preset=flags.preset,
        variant="" if flags.preset == DEFAULT_PRESET else flags.preset,
        renderer=flags.renderer,
        fresh=flags.fresh,
    )
    # Whatever is wrong, a setting or another run in the way, is said before houses are compiled.
    for seed in flags.seeds:
        request.folder(seed).check(request.config(seed), fresh=flags.fresh)
    with counting("houses", len(benchmark.houses)) as advance:
        problems = compile_problems(
            benchmark, device=device, renderer=flags.renderer, progress=advance
        )
    with counting("controls", 4) as advance:
        controls = control_tables(benchmark, problems, progress=advance)
    results, recordings, again = [], [], []
    for seed in flags.seeds:
        folder = request.folder(seed)
        with folder.locked():
            with Bar(f"{flags.method}, seed {seed}", afterwards="evaluating") as bar:
                result = run_seed(request, problems, seed, log=bar.log, folder=folder)
            if folder.aside:
                say(f"seed {seed}: the run that was there is set aside, as {folder.aside}")
            if result.read_back:
                say(_read_back(result))
            recordings.append(_record(flags, request, problems, result))
            if not folder.done:
                folder.finish({**result.summary, "controls": controls})
            results.append(result)
            if flags.optimizer != "q-iteration":
                again.append(_optimize_again(flags, problems, result))
    episodes = [result.folder.path / "episodes.parquet" for result in results]
    means = {
        key: mean_table([result.summary[key] for result in results])
        for key in ("splits", "measures", "failures", "language")
    }
    with working("intervals"):
        intervals = interval_table(episodes)
    answer = {
        "benchmark": benchmark.name,
        "fingerprint": benchmark.fingerprint,
        "method": flags.method,
        "seeds": list(flags.seeds),
        **means,
        "intervals": intervals,
        "controls": {name: table["all"] for name, table in controls.items()},
        "control_splits": {
            name: {split: row for split, row in table.items() if split != "all"}
            for name, table in controls.items()
        },
        "recording": recordings[0],
        "read_back": {
            str(each.seed): each.read_back.isoformat() for each in results if each.read_back
        },
        "wall_s": round(time.perf_counter() - began, 3),
    }
    optimized = {}
    if again:
        answer["optimizer"] = {"name": flags.optimizer, "splits": mean_table(again)}
        optimized[f"{flags.method}, {flags.optimizer}"] = answer["optimizer"]["splits"]
    language = {f"{flags.method}, {name}": row for name, row in means["language"].items()}
    return answer, {flags.method: means["splits"], **optimized, **language, **controls}


def _read_back(result: Any) -> str:  # noqa: ANN401 - imported late
    """What to say of a run that was not run now."""
    from lcrl_bench.evaluation.environment import other_versions

    folder, when = result.folder.path, f"{result.read_back:%Y-%m-%d %H:%M}"
    others = other_versions(folder)
    beside = f", with {', '.join(others)}" if others else ""
    return f"seed {result.seed}: read back from {folder} (finished {when}{beside})"


def _optimize_again(flags: RunFlags, problems: Any, result: Any) -> dict[str, Any]:  # noqa: ANN401
    """The split table of what DQN makes of a learned reward."""
    from lcrl_bench.evaluation.reproduction.experiments import Optimizer
    from lcrl_bench.evaluation.reproduction.jobs import Job
    from lcrl_bench.evaluation.reproduction.reoptimization import optimize_again

    began = datetime.now().astimezone()
    job = Job(flags.method, result.seed, optimizer=Optimizer(flags.optimizer))
    with Bar(f"{flags.optimizer}, seed {result.seed}") as bar:
        summary = optimize_again(
            job,
            result.folder,
            result.learned,
            problems,
            tell=lambda share: bar.log({"step": round(1000 * share), "steps": 1000}),
            tasks_per_split=flags.dqn_tasks,
        )
    if (finished := datetime.fromisoformat(summary["finished"])) < began:
        when = f"{finished:%Y-%m-%d %H:%M}"
        say(f"seed {result.seed}: {flags.optimizer} read back from {result.folder.path} ({when})")
    return summary["splits"]


def _record(flags: RunFlags, request: Any, problems: Any, result: Any) -> str | None:  # noqa: ANN401
    """Record episodes of a run, unless that was done; the recording's path."""
    path = result.folder.path / "recording.rrd"
    if flags.record == "none":
        return str(path) if path.exists() else None
    from lcrl_bench.recording.index import is_recorded

    if not is_recorded(result.folder.path, flags.record):
        from lcrl_bench.evaluation.harness import evaluate
        from lcrl_bench.recording.run_recording import choose, record_run

        outcomes = result.outcomes or evaluate(result.learned, problems)
        total = 0 if flags.record == "showcase" else len(choose(flags.record, outcomes))
        with counting("recordings", total) as advance:
            record_run(request, problems, result, outcomes, flags.record, progress=advance)
    return str(path)


def _beside_python(command: str) -> str:
    """A console script of this environment, by a path that works from where the person is."""
    script = Path(sys.executable).with_name(command)
    if not script.exists():
        return command
    here = Path.cwd()
    return str(script.relative_to(here)) if script.is_relative_to(here) else str(script)
