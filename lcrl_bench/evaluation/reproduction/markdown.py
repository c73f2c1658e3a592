"""A table as a Markdown page: our results next to the paper's, with intervals and claims."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from lcrl_bench.evaluation.optimizers import Optimizer
from lcrl_bench.evaluation.reproduction.table import (
    ClaimDocument,
    FigureDocument,
    RowDocument,
    TableDocument,
)

NOTES_FILE: Final = "notes.md"
"""Written by hand, and never overwritten."""
KIND_WORDS: Final = {"pick": "PICK", "nav": "NAV", "total": "total"}


def page(document: TableDocument) -> str:
    """The complete page."""
    sections = [
        f"# {document.title}",
        _condition(document),
        *_result_tables(document),
        *_language_table(document),
        *_claim_table(document),
        *_run_table(document),
        _machine(document),
        f"How to interpret these results: [{NOTES_FILE}]({NOTES_FILE}).",
    ]
    return "\n\n".join(sections) + "\n"


def _condition(document: TableDocument) -> str:
    splits = ", ".join(
        f"{split} {count['total']} tasks in {count['houses']} houses"
        for split, count in document.tasks.items()
    )
    lines = []
    if not document.complete:
        done = sum(len(row.seeds) for row in document.rows)
        asked = done + sum(len(row.missing) for row in document.rows)
        lines += [f"**Unfinished: {done} of {asked} runs are done.**", ""]
    if document.budget is not None:
        lines += [
            f"**Reduced: {document.budget:g} of the full training.** These results show that the "
            "command works, not what the methods can do.",
            "",
        ]
    lines += [
        f"Success rate (%) on `{document.benchmark}` (fingerprint "
        f"`{document.fingerprint[:12]}`): {splits}. In "
        f"brackets: {100 * document.interval['confidence']:.0f} % intervals over houses, tasks "
        "and seeds. After the bar: the paper's result in its own houses; compare "
        "rankings, not absolute values.",
        "",
        f"Table `{document.paper_label}` of the paper. Reproduce it with `{document.command}`",
    ]
    return "\n".join(lines)


def _result_tables(document: TableDocument) -> list[str]:
    """One table for all splits, or one per split if each has several columns."""
    columns = list(document.rows[0].figures)
    splits = list(dict.fromkeys(column.partition(".")[0] for column in columns))
    if len(columns) == len(splits):
        return [_result_table("", document.rows, columns, splits)]
    tables = []
    for split in splits:
        here = [column for column in columns if column.startswith(f"{split}.")]
        headings = [KIND_WORDS[column.rpartition(".")[2]] for column in here]
        tables.append(_result_table(f"## {split}\n\n", document.rows, here, headings))
    return tables


def _result_table(
    title: str, rows: Iterable[RowDocument], columns: Sequence[str], headings: Sequence[str]
) -> str:
    cells = [[row.label, *(figure_text(row.figures[column]) for column in columns)] for row in rows]
    return title + grid(["", *headings], cells)


def figure_text(figure: FigureDocument | None) -> str:
    """`52.5 [47.1, 58.0] | 51.9`: mean, interval, and the paper's result if there is one."""
    if figure is None:
        return "–"
    ours = f"**{figure.mean:.1f}** [{figure.low:.1f}, {figure.high:.1f}]"
    return ours if figure.paper is None else f"{ours} \\| {figure.paper:.1f}"


def _language_table(document: TableDocument) -> list[str]:
    rows = [row for row in document.rows if row.language]
    if not rows:
        return []
    commands = list(dict.fromkeys(c for row in rows for s in row.language.values() for c in s))
    parts = [
        "## Language controls",
        "The same runs with other commands; total success at the task's own goal. A method that "
        "uses its command drops to chance without it and below its own result with another one; "
        "with a paraphrase it should not drop.",
    ]
    for split in document.tasks:
        cells = [
            [row.label, *(_percent(row.language.get(split, {}).get(c)) for c in commands)]
            for row in rows
        ]
        parts += [grid([split, *commands], cells)]
    return parts


def _claim_table(document: TableDocument) -> list[str]:
    if not document.claims:
        return []
    cells = [_claim_cells(claim) for claim in document.claims]
    return [
        "## The paper's claims",
        "First minus second in percentage points, paired by task and seed. *Holds*: beyond the "
        "interval; for *alike*, the interval contains zero, as wide ones easily do.",
        grid(["claim", "first", "second", "on", "ours", "paper's", "verdict"], cells, left=4),
    ]


def _claim_cells(claim: ClaimDocument) -> list[str]:
    ours = "–"
    if claim.mean is not None:
        ours = f"{claim.mean:+.1f} [{claim.low:+.1f}, {claim.high:+.1f}]"
    text = f"{claim.text} (alike)" if claim.relation == "alike" else claim.text
    paper = "–" if claim.paper is None else f"{claim.paper:+.1f}"
    where = claim.column.removesuffix(".total").replace(".", " ")
    verdict = claim.verdict if claim.mean is not None else "not run"
    return [text, claim.first, claim.second, where, ours, paper, f"**{verdict}**"]


def _run_table(document: TableDocument) -> list[str]:
    cells = []
    for row in document.rows:
        settings = ", ".join(f"`{key}={value}`" for key, value in sorted(row.settings.items()))
        size = "" if row.image_size is None else f"{row.image_size[0]} × {row.image_size[1]} pixels"
        preset = "" if row.preset == "default" else f"preset `{row.preset}`"
        oracle = "given true rewards" if row.oracle else ""
        asked = ", ".join(part for part in (preset, settings, size, oracle) if part)
        seeds = "–" if row.control else ", ".join(map(str, row.seeds)) or "none finished"
        tasks = max((figure.tasks for figure in row.figures.values() if figure), default=0)
        wall = "–" if row.wall_s is None else f"{row.wall_s:.0f} s"
        what = "control" if row.control else f"`{row.method}`"
        how = "exact" if row.optimizer == Optimizer.Q_ITERATION else row.optimizer
        cells.append([row.label, what, how, asked, seeds, str(tasks), wall])
    headings = ["row", "method", "evaluation", "settings", "seeds", "tasks (largest column)"]
    return ["## Runs", grid([*headings, "time per seed"], cells, left=4)]


def _machine(document: TableDocument) -> str:
    lines = []
    for found in document.environments:
        versions = ", ".join(f"{name} {version}" for name, version in found["versions"].items())
        cores = f"{found['cores']} cores, " if "cores" in found else ""
        lines.append(
            f"Made on {found['device'].upper()} ({cores}{found['machine']}) with lcrl_bench "
            f"{found['lcrl_bench']}, Python {found['python']}, {versions}."
        )
    return "\n\n".join(lines) or "No runs yet."


def grid(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> str:
    """A Markdown table with the first columns aligned left and the others right."""
    rules = ["---" if column < left else "--:" for column in range(len(headings))]
    lines = [headings, rules, *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _percent(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f}"
