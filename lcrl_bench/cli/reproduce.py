"""`lcrl-bench reproduce`: the paper's tables from real runs, ours beside the paper's."""

from __future__ import annotations

import shlex
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.fan_out import Done, FanOut, do_jobs, say_part
from lcrl_bench.cli.output import print_json, print_table, say, stdout_kept_clean, suggest
from lcrl_bench.cli.progress import working
from lcrl_bench.errors import ExitCode, NothingSelectedError, UsageError
from lcrl_bench.interruption import resumable

if TYPE_CHECKING:
    # At run time these would import torch before a mistyped flag is named.
    from lcrl_bench.benchmarks.benchmark import Benchmark
    from lcrl_bench.evaluation.reproduction.experiments import Experiment
    from lcrl_bench.evaluation.reproduction.table import FigureDocument, TableDocument
    from lcrl_bench.evaluation.run import RunSpec
    from lcrl_bench.evaluation.run_folder import RunFolder

BUDGETS = {"full": None, "small": 0.1}
"""Words for a budget."""


@dataclass(frozen=True)
class ReproduceFlags:
    """Run what a table of the paper needs, and write it: ours beside the paper's."""

    table: Annotated[
        Literal["table-1", "table-2", "architectures", "image-size", "all"], tyro.conf.Positional
    ]
    """Which table."""
    benchmark: str = "lcrl-v1"
    """A shipped benchmark, or the folder of one of your own."""
    seeds: tuple[int, ...] = ()
    """One run per seed; none: 0 1 2 as the paper's three (LC-RL and GAIL-Exact of table-1: ten), or
    0 with a budget."""
    budget: str = "full"
    """full, small, or a share of the training such as 0.1. Anything but full is written to files of
    its own, and says so."""
    out: Path = Path("runs")
    """Where runs are: OUT/<benchmark>/<method>[-<variant>]/seed<k>. Finished ones are kept."""
    results: Path = Path("docs/results")
    """Where tables are written, as Markdown and JSON."""
    no_train: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Run nothing: write the tables of what is finished."""
    device: str = "auto"
    """auto, cpu or cuda."""
    renderer: str = "auto"
    """For views that are not in the cache: auto, gl (MuJoCo's cameras), rays (no OpenGL)
    or warp (MuJoCo Warp)."""
    fresh: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Where a run of other code or settings is in the way, set it aside and start anew."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object on stdout, and nothing else there."""
    fan_out: FanOut = field(default_factory=FanOut)


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(ReproduceFlags, argv, verb="reproduce")
    budget = budget_of(flags)
    seeds = flags.seeds or (None if budget is None else (0,))
    command = ["lcrl-bench", "reproduce", *argv]
    with resumable(shlex.join(command)), stdout_kept_clean(flags.json):
        from lcrl_bench.evaluation.reproduction.experiments import EXPERIMENTS

        chosen = tuple(each for each in EXPERIMENTS if flags.table in (each.name, "all"))
        if flags.fan_out.part is not None:
            done = reproduce_part(flags, chosen, seeds=seeds, budget=budget)
            return say_part(done, command)
        answer, documents = reproduce(flags, chosen, seeds=seeds, budget=budget)
    if flags.json:
        print_json(answer)
    else:
        for document in documents.values():
            _print(document)
        for table in answer["tables"].values():
            say(f"written: {table['page']}")
    if answer["failed"]:
        for key, reason in answer["failed"].items():
            say(f"failed: {key}: {reason}", style="bold red")
        suggest(command, "try the failed ones again; what is finished is kept")
        return ExitCode.RED
    return ExitCode.DONE


def budget_of(flags: ReproduceFlags) -> float | None:
    """The share of the full training; None for all of it.

    Raises:
        UsageError: If it is no word for one and no number above 0 and below 1.
    """
    if flags.budget in BUDGETS:
        return BUDGETS[flags.budget]
    try:
        share = float(flags.budget)
    except ValueError:
        share = 0.0
    if not 0 < share < 1:
        words = ", ".join(BUDGETS)
        raise UsageError(f"--budget {flags.budget}: name {words} or a share such as 0.1.")
    return share


def reproduce(
    flags: ReproduceFlags,
    experiments: Sequence[Experiment],
    *,
    seeds: tuple[int, ...] | None,
    budget: float | None,
) -> tuple[dict[str, Any], dict[str, TableDocument]]:
    """Everything but the printing.

    Returns:
        The JSON answer, and the tables by name.

    Raises:
        NothingSelectedError: If no run is finished that a table could be made of.
    """
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.finished_runs import changes, is_done
    from lcrl_bench.evaluation.reproduction.experiments import specs_of
    from lcrl_bench.evaluation.reproduction.publication import publish
    from lcrl_bench.evaluation.reproduction.table import Sources, table_document
    from lcrl_bench.recording.success_figure import success_figure

    began = time.perf_counter()
    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    specs = specs_of(experiments, seeds, budget)
    missing = [spec for spec in specs if not is_done(spec, flags.out, benchmark)]
    found = {spec: spec.folder(flags.out, benchmark) for spec in specs if spec not in missing}
    changed = {
        spec.key: different
        for spec in missing
        if spec == spec.training and (different := changes(spec, flags.out, benchmark))
    }
    no_train = flags.no_train or flags.fan_out.only_read
    _say_what_is_there(flags, tuple(found.values()), changed)
    ended = _work(flags, benchmark, missing).ended if missing and not no_train else ()
    documents, tables = {}, {}
    for experiment in experiments:
        sources = Sources(experiment, benchmark, flags.out, seeds, budget)
        with working(experiment.name):
            document = table_document(sources, command=_command(experiment, flags, benchmark))
        if any(row.seeds for row in document.rows):
            page = publish(document, flags.results)
            success_figure(page.with_suffix(".svg"), document)
            documents[experiment.name] = document
            tables[experiment.name] = {
                "page": str(page),
                "json": str(page.with_suffix(".json")),
                "figure": str(page.with_suffix(".svg")),
                "complete": document.complete,
            }
    failed = {each.key: each.error for each in ended if each.error is not None}
    if flags.fan_out.only_read:
        failed = {spec.key: "not done yet" for spec in missing}
    if not documents and not failed:
        raise NothingSelectedError(
            f"No run is finished in {flags.out}; leave out --no-train to run what is missing."
        )
    answer = {
        "benchmark": benchmark.name,
        "fingerprint": benchmark.fingerprint,
        "seeds": sorted({spec.seed for spec in specs}),
        "budget": budget,
        "tables": tables,
        "found": len(found),
        "read_back": {spec.key: each.finished.isoformat() for spec, each in found.items()},
        "changed": {key: list(different) for key, different in changed.items()},
        "done": len(ended) - len(failed),
        "failed": failed,
        "wall_s": round(time.perf_counter() - began, 3),
    }
    return answer, documents


def _say_what_is_there(
    flags: ReproduceFlags, found: Sequence[RunFolder], changed: Mapping[str, Sequence[str]]
) -> None:
    """Say which results are read back, and which are of other code or settings."""
    from lcrl_bench.evaluation.run_folder import finished_between

    if found:
        say(f"read back from {flags.out}: {finished_between(found)}")
    if not flags.no_train and not flags.fresh:
        return  # Each is refused, with what differs.
    word = "left out" if flags.no_train else "to be set aside"
    for key, different in changed.items():
        say(f"{word}: {key}: another run, which differs in {'; '.join(different)}")
    if changed and flags.no_train:
        say("Run them anew with --fresh and without --no-train.")


def reproduce_part(
    flags: ReproduceFlags,
    experiments: Sequence[Experiment],
    *,
    seeds: tuple[int, ...] | None,
    budget: float | None,
) -> Done:
    """Do the runs of one shard; no table is written."""
    from lcrl_bench.benchmarks.catalogue import benchmark_folder
    from lcrl_bench.benchmarks.document import read_benchmark
    from lcrl_bench.evaluation.reproduction.experiments import specs_of

    benchmark = read_benchmark(benchmark_folder(flags.benchmark))
    return _work(flags, benchmark, specs_of(experiments, seeds, budget))


def _work(flags: ReproduceFlags, benchmark: Benchmark, specs: Sequence[RunSpec]) -> Done:
    """Make the runs."""
    from lcrl_bench.evaluation.run_jobs import SessionSpec, run_jobs_of

    session = SessionSpec(
        flags.benchmark,
        str(flags.out),
        device=flags.device,
        renderer=flags.renderer,
        fresh=flags.fresh,
        fingerprint=benchmark.fingerprint,
    )
    jobs = run_jobs_of(session, {spec.key: spec for spec in specs}, any_computer=True)
    return do_jobs(jobs, flags.fan_out)


def _command(experiment: Experiment, flags: ReproduceFlags, benchmark: Benchmark) -> str:
    """What repeats a table, without the paths of this machine."""
    words = ["lcrl-bench", "reproduce", experiment.name]
    if benchmark.name != ReproduceFlags.benchmark:
        words += ["--benchmark", Path(flags.benchmark).name]
    if flags.budget != "full":
        words += ["--budget", flags.budget]
    if flags.seeds:
        words += ["--seeds", *map(str, flags.seeds)]
    return shlex.join(words)


def _print(document: TableDocument) -> None:
    columns = [column for column in document.rows[0].figures if column.endswith(".total")]
    headings = [column.removesuffix(".total") for column in columns]
    rows = [
        [row.label, *(_cell(row.figures[column]) for column in columns)] for row in document.rows
    ]
    title = f"{document.title}: ours [95 % interval] | the paper's"
    print_table(["success, %", *headings], rows, title=title, right=headings)


def _cell(figure: FigureDocument | None) -> str:
    from lcrl_bench.evaluation.reproduction.markdown import figure_text

    return figure_text(figure).replace("*", "").replace("\\", "")
