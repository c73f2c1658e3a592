"""`TableDocument`: a table of finished runs, as the JSON next to its page.

It doesn't depend on when it was made: the same runs give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.documents import Document
from lcrl_bench.evaluation.finished_runs import is_done
from lcrl_bench.evaluation.intervals import CONFIDENCE, REPLICATES
from lcrl_bench.evaluation.optimizers import optimizer_files
from lcrl_bench.evaluation.reproduction.experiments import Claim, Experiment, Row
from lcrl_bench.evaluation.reproduction.paper import PaperTable, paper_tables
from lcrl_bench.evaluation.results import DIGITS, Figure, Results, language_value
from lcrl_bench.evaluation.run import RunSpec
from lcrl_bench.storage import canonical_json, read_json

FORMAT: Final = 1
OWN_COMMAND: Final = "own"
"""Name of the tasks' own commands among the language controls."""

Verdict = Literal["holds", "does not hold", "undecided"]


class FigureDocument(Document):
    """Success in percent."""

    mean: float
    low: float
    """Lower end of the interval."""
    high: float
    tasks: int
    """Number of tasks it is the mean over (times seeds)."""
    paper: float | None
    """The paper's result in its own houses; None if it has none."""


class RowDocument(Document):
    """One row of a table."""

    label: str
    method: str
    control: bool
    oracle: bool
    preset: str
    settings: dict[str, str]
    optimizer: str
    image_size: tuple[int, int] | None
    seeds: tuple[int, ...]
    """The seeds whose runs are finished, which the figures are means over."""
    missing: tuple[int, ...]
    """The seeds requested whose runs are not finished."""
    wall_s: float | None
    """Mean time of a seed's run in seconds, with other workers running; of its last part if it was
    interrupted."""
    figures: dict[str, FigureDocument | None]
    """Figures by column, `<split>.<pick|nav|total>`."""
    language: dict[str, dict[str, float]]
    """Success in percent by split and command, for the language controls."""


class ClaimDocument(Document):
    """A claim of the paper about two rows, and our result."""

    text: str
    first: str
    second: str
    column: str
    relation: str
    mean: float | None
    """First minus second, in percentage points; None while a row is missing."""
    low: float | None
    high: float | None
    paper: float | None
    """The paper's difference, in percentage points."""
    verdict: Verdict


class TableDocument(Document):
    """A table of the paper from runs."""

    format: int
    experiment: str
    title: str
    paper_label: str
    benchmark: str
    fingerprint: str
    tasks: dict[str, dict[str, int]]
    seeds: tuple[int, ...]
    budget: float | None
    """Share of the full training and of the sampled tasks; None means all."""
    complete: bool
    """Whether all requested runs are finished."""
    command: str
    environments: list[dict[str, Any]]
    """Distinct environments of the runs: versions, device, cores."""
    interval: dict[str, Any]
    rows: list[RowDocument]
    claims: list[ClaimDocument]


@dataclass(frozen=True)
class Sources:
    """The runs a table is made from."""

    experiment: Experiment
    benchmark: Benchmark
    out: Path
    """The folder of runs."""
    seeds: tuple[int, ...] | None = None
    """Seeds for all rows; None means each row's own."""
    budget: float | None = None

    @property
    def paper(self) -> PaperTable:
        """The paper's table."""
        return paper_tables()[self.experiment.name]

    @property
    def every_seed(self) -> tuple[int, ...]:
        """The seeds of all rows."""
        rows = [row for row in self.experiment.rows if not row.control]
        return tuple(sorted({seed for row in rows for seed in self.specs(row)}))

    def specs(self, row: Row) -> dict[int, RunSpec]:
        """The runs of a row, by seed; a control has one."""
        return row.specs(self.seeds, self.budget)

    def finished(self, row: Row) -> dict[int, RunSpec]:
        """The finished runs of a row, by seed."""
        return {
            seed: spec
            for seed, spec in self.specs(row).items()
            if is_done(spec, self.out, self.benchmark)
        }

    def files(self, spec: RunSpec) -> tuple[Path, Path]:
        """The summary file and the episodes file of a run."""
        return optimizer_files(spec.folder(self.out, self.benchmark), spec.optimizer)

    def results(self, row: Row) -> Results | None:
        """The results of the finished runs; None if there are none."""
        files = {seed: self.files(spec)[1] for seed, spec in self.finished(row).items()}
        return Results.read(row.label, files) if files else None


def table_document(sources: Sources, *, command: str) -> TableDocument:
    """Make a table of the finished runs.

    Args:
        sources: The runs.
        command: The command that reproduces the table.
    """
    experiment, benchmark = sources.experiment, sources.benchmark
    read = {row.label: sources.results(row) for row in experiment.rows}
    found = {label: each for label, each in read.items() if each is not None}
    rows = [_row_document(sources, row, found.get(row.label)) for row in experiment.rows]
    return TableDocument(
        format=FORMAT,
        experiment=experiment.name,
        title=experiment.title,
        paper_label=sources.paper.label,
        benchmark=benchmark.name,
        fingerprint=benchmark.fingerprint,
        tasks=_task_counts(benchmark),
        seeds=sources.every_seed,
        budget=sources.budget,
        complete=not any(row.missing for row in rows),
        command=command,
        environments=_environments(sources),
        interval={
            "kind": "percentile bootstrap over houses, tasks in them, and runs",
            "confidence": CONFIDENCE,
            "replicates": REPLICATES,
        },
        rows=rows,
        claims=[_claim_document(claim, sources, found) for claim in experiment.claims],
    )


def _row_document(sources: Sources, row: Row, results: Results | None) -> RowDocument:
    experiment, paper, run = sources.experiment, sources.paper, row.run
    done = sources.finished(row)
    summaries = [read_json(sources.files(spec)[0]) for spec in done.values()]
    walls = [summary["wall_s"] for summary in summaries]
    return RowDocument(
        label=row.label,
        method=run.method,
        control=row.control,
        oracle=any(summary.get("oracle", False) for summary in summaries),
        preset=run.preset,
        settings=dict(run.settings),
        optimizer=run.optimizer.value,
        image_size=run.image_size,
        seeds=tuple(done),
        missing=tuple(seed for seed in sources.specs(row) if seed not in done),
        wall_s=round(sum(walls) / len(walls), 1) if walls else None,
        figures={
            column: _figure(results, column, paper.figure(row.paper, column))
            for column in experiment.columns
        },
        language=_language(results) if experiment.language and not row.control else {},
    )


def _figure(results: Results | None, column: str, paper: float | None) -> FigureDocument | None:
    if results is None:
        return None
    split, _, kind = column.partition(".")
    found = results.estimate(split, kind)
    if found is None or found.bounds is None:
        return None
    low, high = found.bounds
    tasks = found.n // len(results.seeds)
    return FigureDocument(mean=found.mean, low=low, high=high, tasks=tasks, paper=paper)


def _language(results: Results | None) -> dict[str, dict[str, float]]:
    """What each kind of command gives, by split: the tasks' own first, then in order of names."""
    if results is None:
        return {}
    controls = {name: results.splits(language_value(name)) for name in sorted(results.controls)}
    said = {OWN_COMMAND: results.splits(), **controls}
    return {
        split.value: {
            command: total
            for command, table in said.items()
            if (total := table[split.value]["total"]) is not None
        }
        for split in Split
    }


def _claim_document(
    claim: Claim, sources: Sources, results: Mapping[str, Results]
) -> ClaimDocument:
    found, (split, _, kind) = None, claim.column.partition(".")
    if claim.first in results and claim.second in results:
        found = results[claim.first].difference(results[claim.second], split, kind)
    first, second = (
        sources.paper.figure(sources.experiment.row(label).paper, claim.column)
        for label in (claim.first, claim.second)
    )
    return ClaimDocument(
        text=claim.text,
        first=claim.first,
        second=claim.second,
        column=claim.column,
        relation=claim.relation,
        mean=None if found is None else found.mean,
        low=None if found is None else found.low,
        high=None if found is None else found.high,
        paper=None if first is None or second is None else round(first - second, DIGITS),
        verdict=verdict(claim, found),
    )


def verdict(claim: Claim, found: Figure | None) -> Verdict:
    """Whether a claim holds beyond the interval of the difference.

    "Better" holds if the interval is above zero, and doesn't if it is below; "alike" counts as
    holding if zero is inside.
    """
    if found is None or found.bounds is None:
        return "undecided"
    low, high = found.bounds
    inside = low <= 0 <= high
    if claim.relation == "alike":
        return "holds" if inside else "does not hold"
    if inside:
        return "undecided"
    return "holds" if low > 0 else "does not hold"


def _task_counts(benchmark: Benchmark) -> dict[str, dict[str, int]]:
    return {
        split.value: {
            **{kind.value: len(benchmark.select(split=split, kind=kind)) for kind in Kind},
            "total": len(benchmark.select(split=split)),
            "houses": len(benchmark.houses_of(split)),
        }
        for split in Split
    }


def _environments(sources: Sources) -> list[dict[str, Any]]:
    """The distinct environments of the finished runs."""
    specs = [spec for row in sources.experiment.rows for spec in sources.finished(row).values()]
    texts = set()
    for spec in specs:
        folder = spec.folder(sources.out, sources.benchmark)
        found = read_json(folder.path / "environment.json")
        # The platform string names a kernel build, on which no result depends.
        texts.add(canonical_json({key: v for key, v in found.items() if key != "platform"}))
    return [json.loads(text) for text in sorted(texts)]
