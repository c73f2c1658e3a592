"""`TableDocument`: a table made of finished runs, as the JSON beside its page.

Nothing in it depends on when it was made: the same runs give the same bytes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

from pydantic import BaseModel, ConfigDict

from lcrl_bench.benchmarks.benchmark import Benchmark
from lcrl_bench.benchmarks.task import Kind, Split
from lcrl_bench.evaluation.intervals import CONFIDENCE, REPLICATES
from lcrl_bench.evaluation.reproduction.experiments import Claim, Experiment, Row
from lcrl_bench.evaluation.reproduction.jobs import (
    Job,
    episodes_file,
    is_done,
    job_of,
    summary_file,
)
from lcrl_bench.evaluation.reproduction.paper import PaperTable, paper_tables
from lcrl_bench.evaluation.reproduction.scores import (
    Estimate,
    Scores,
    difference,
    estimate,
    read_scores,
)
from lcrl_bench.storage import canonical_json, read_json

DIGITS: Final = 4
"""Decimals of a percentage in the JSON; the page shows one."""
FORMAT: Final = 1
OWN_COMMAND: Final = "own"
"""What the tasks' own commands are called beside the language controls."""

Verdict = Literal["holds", "does not hold", "undecided"]


class Document(BaseModel):
    """Base of what is written: no field besides the declared ones."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Figure(Document):
    """Success in per cent."""

    mean: float
    low: float
    """Lower end of the interval."""
    high: float
    tasks: int
    """How many tasks it is the mean over (times seeds)."""
    paper: float | None
    """The paper's figure in its own houses; None where it has none."""


class RowResult(Document):
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
    """The seeds whose runs are finished: what the figures are means over."""
    missing: tuple[int, ...]
    """The seeds that were asked for and are not finished."""
    wall_s: float | None
    """Mean time of a seed's run, in seconds, beside the other workers; of its last part if it was
    interrupted."""
    figures: dict[str, Figure | None]
    """By column, `<split>.<pick|nav|total>`."""
    language: dict[str, dict[str, float]]
    """Success in per cent by split and command: what other commands than the true ones give."""


class ClaimResult(Document):
    """What the paper says of two rows, and what is found here."""

    text: str
    first: str
    second: str
    column: str
    relation: str
    mean: float | None
    """First minus second, in points of per cent; None while a row is missing."""
    low: float | None
    high: float | None
    paper: float | None
    """The paper's difference."""
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
    """The share of the full training and of the sampled tasks; None: all."""
    complete: bool
    """Whether every run that was asked for is finished."""
    command: str
    environments: list[dict[str, Any]]
    """What the runs were made with, each kind once: versions, device, cores."""
    interval: dict[str, Any]
    rows: list[RowResult]
    claims: list[ClaimResult]


@dataclass(frozen=True)
class Sources:
    """Where a table's figures come from."""

    experiment: Experiment
    benchmark: Benchmark
    out: Path
    """The folder of runs."""
    seeds: tuple[int, ...] | None = None
    """One run each; None: those of each row."""
    budget: float | None = None

    @property
    def paper(self) -> PaperTable:
        """The paper's table."""
        return paper_tables()[self.experiment.name]

    def jobs(self, row: Row) -> dict[int, Job]:
        """The jobs of a row, by seed; a control has one."""
        return {seed: job_of(row, seed, self.budget) for seed in row.seeds_of(self.seeds)}

    @property
    def every_seed(self) -> tuple[int, ...]:
        """The seeds that some row is run with."""
        rows = [row for row in self.experiment.rows if not row.control]
        return tuple(sorted({seed for row in rows for seed in row.seeds_of(self.seeds)}))

    def finished(self, row: Row) -> dict[int, Job]:
        """Those that are done."""
        return {
            seed: job
            for seed, job in self.jobs(row).items()
            if is_done(job, self.out, self.benchmark)
        }

    def scores(self, row: Row) -> Scores | None:
        """The scores of the finished runs; None without one."""
        files = [
            episodes_file(job, job.folder(self.out, self.benchmark))
            for job in self.finished(row).values()
        ]
        return read_scores(files) if files else None


def table_document(sources: Sources, *, command: str) -> TableDocument:
    """Make a table of the runs that are finished.

    Args:
        sources: Where they are.
        command: What repeats it.
    """
    experiment, benchmark = sources.experiment, sources.benchmark
    found = {row.label: sources.scores(row) for row in experiment.rows}
    scores = {label: each for label, each in found.items() if each is not None}
    rows = [_row_result(sources, row, scores.get(row.label)) for row in experiment.rows]
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
        claims=[_claim_result(claim, sources, scores) for claim in experiment.claims],
    )


def _row_result(sources: Sources, row: Row, scores: Scores | None) -> RowResult:
    experiment, paper = sources.experiment, sources.paper
    jobs, done = sources.jobs(row), sources.finished(row)
    summaries = [
        read_json(summary_file(job, job.folder(sources.out, sources.benchmark)))
        for job in done.values()
    ]
    walls = [summary["wall_s"] for summary in summaries]
    return RowResult(
        label=row.label,
        method=row.method,
        control=row.control,
        oracle=any(summary.get("oracle", False) for summary in summaries),
        preset=row.preset,
        settings=dict(row.settings),
        optimizer=row.optimizer.value,
        image_size=row.image_size,
        seeds=tuple(done),
        missing=tuple(seed for seed in jobs if seed not in done),
        wall_s=round(sum(walls) / len(walls), 1) if walls else None,
        figures={
            column: _figure(scores, column, paper.figure(row.paper, column))
            for column in experiment.columns
        },
        language=language_means(summaries) if experiment.language and not row.control else {},
    )


def _figure(scores: Scores | None, column: str, paper: float | None) -> Figure | None:
    if scores is None:
        return None
    chosen = scores.column(column)
    found = estimate(chosen)
    if found is None:
        return None
    return Figure(tasks=len(chosen.tasks), paper=paper, **_rounded(found))


def language_means(summaries: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, float]]:
    """Mean over runs of what each kind of command gives, by split: the tasks' own first."""
    found: dict[str, dict[str, list[float]]] = {}
    for summary in summaries:
        for split, row in summary["splits"].items():
            found.setdefault(split, {}).setdefault(OWN_COMMAND, []).append(row["total"])
        for command, splits in summary.get("language", {}).items():
            for split, row in splits.items():
                if row["total"] is not None:
                    found.setdefault(split, {}).setdefault(command, []).append(row["total"])
    return {
        split: {
            command: round(sum(values) / len(values), DIGITS)
            for command, values in commands.items()
            if None not in values
        }
        for split, commands in found.items()
    }


def _claim_result(claim: Claim, sources: Sources, scores: Mapping[str, Scores]) -> ClaimResult:
    found = None
    if claim.first in scores and claim.second in scores:
        pair = (scores[label].column(claim.column) for label in (claim.first, claim.second))
        found = difference(*pair)
    first, second = (
        sources.paper.figure(sources.experiment.row(label).paper, claim.column)
        for label in (claim.first, claim.second)
    )
    return ClaimResult(
        text=claim.text,
        first=claim.first,
        second=claim.second,
        column=claim.column,
        relation=claim.relation,
        paper=None if first is None or second is None else round(first - second, DIGITS),
        verdict=verdict(claim, found),
        **(_rounded(found) if found else {"mean": None, "low": None, "high": None}),
    )


def verdict(claim: Claim, found: Estimate | None) -> Verdict:
    """Whether a claim holds beyond the interval of the difference.

    "Better" holds if the interval is above zero and does not if it is below; "alike" holds as far
    as it can be said to if zero is inside.
    """
    if found is None:
        return "undecided"
    inside = found.low <= 0 <= found.high
    if claim.relation == "alike":
        return "holds" if inside else "does not hold"
    if inside:
        return "undecided"
    return "holds" if found.low > 0 else "does not hold"


def _rounded(found: Estimate) -> dict[str, float]:
    return {name: round(getattr(found, name), DIGITS) for name in ("mean", "low", "high")}


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
    """What the finished runs were made with, each kind once."""
    jobs = [job for row in sources.experiment.rows for job in sources.finished(row).values()]
    texts = set()
    for job in jobs:
        folder = job.folder(sources.out, sources.benchmark)
        found = read_json(folder.path / "environment.json")
        # The platform's text names a kernel build, on which no result depends.
        texts.add(canonical_json({key: v for key, v in found.items() if key != "platform"}))
    return [json.loads(text) for text in sorted(texts)]
