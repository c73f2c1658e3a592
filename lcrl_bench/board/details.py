"""What a row of the page opens: figures, failures, language controls, curves, seeds, settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.document import Submission
from lcrl_bench.board.entries import Entry
from lcrl_bench.board.table_rows import COLUMN_TITLES
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.evaluation.results import COLUMNS
from lcrl_bench.evaluation.table import cell, interval_cell

SPLITS: Final = (Split.TEST_HOUSE, Split.TEST_TASK, Split.TRAIN)
"""Most important first: a narrow screen shows the first columns."""
FAILURES: Final = {
    Failure.WAITS_AT_A: "waits beside the object",
    Failure.AT_B_WITHOUT_OBJECT: "at the target without it",
    Failure.ELSEWHERE: "elsewhere without it",
    Failure.PUT_BACK: "takes it, puts it back",
    Failure.HELD_AT_B: "at the target, in hand",
    Failure.HELD_ELSEWHERE: "elsewhere, in hand",
}


@dataclass(frozen=True)
class Picture:
    """A picture of a row, as the page links to it."""

    link: str
    """Relative to the page."""
    caption: str


@dataclass(frozen=True)
class Media:
    """A row's recording and pictures, as the page links to them."""

    recording: str = ""
    """The `.rrd`, relative to the page; empty if there is none."""
    script: str = ""
    """The script that passes the recording to the player: `<row>/<file>.js`."""
    pictures: tuple[Picture, ...] = ()


@dataclass(frozen=True)
class Details:
    """The details of a submission, as plain texts and percentages."""

    title: str
    figures: Sequence[Sequence[str]]
    """A row per split and kind of task: its name, success, interval, other measures, n."""
    failures: Mapping[str, float | None]
    """Shares of PICK tasks in new houses, in per cent, by kind of failure."""
    commands: Mapping[str, float | None]
    """Success in new houses, in per cent, by what the method is told."""
    curves: Sequence[Sequence[tuple[int, float]]]
    """(step, loss) per seed."""
    facts: Mapping[str, str]
    """Method, settings, author and the like; an empty text is left out."""
    settings: str
    seeds: Sequence[Sequence[str]]
    """A row per seed: number, success per split, time, machine, checkpoint."""
    verify: str
    """The command that re-runs the submission."""


def row_details(entry: Entry) -> Details:
    """What the row of a submission opens."""
    row = entry.submission
    return Details(
        title=row.title,
        figures=_figures(row),
        failures={
            FAILURES[failure]: share for failure, share in row.failures[Split.TEST_HOUSE].items()
        },
        commands=_commands(row),
        curves=[[(point.step, point.loss) for point in seed.curve] for seed in row.seeds],
        facts={
            "Method": f"{row.method}: {row.summary}",
            "Settings": f"preset {row.preset}; changed: {_listed(row.changed) or 'nothing'}",
            "Submitted by": row.author,
            "Code": row.code,
            "Checkpoints": row.weights,
            entry.mark.capitalize(): entry.note,
        },
        settings=_listed(row.settings),
        seeds=_seeds(row),
        verify=f"lcrl-bench leaderboard verify leaderboard/submissions/{entry.stem}.json",
    )


def _figures(row: Submission) -> list[list[str]]:
    rows = []
    for split in SPLITS:
        for kind in COLUMNS:
            figure, measures = row.figures[split][kind], row.measures[split]
            rows.append(
                [
                    f"{COLUMN_TITLES[split]}, {kind if kind == 'total' else kind.upper()}",
                    cell(figure and figure.mean),
                    interval_cell(figure and figure.figure),
                    *(cell(measures[name][kind]) for name in ("final", "path_weighted", "regret")),
                    "–" if figure is None else f"{figure.n:,}",
                ]
            )
    return rows


def _commands(row: Submission) -> dict[str, float | None]:
    own = row.figures[Split.TEST_HOUSE]["total"]
    controls = (Control.PARAPHRASE, Control.WRONG_TARGET, Control.SHUFFLED, Control.BLANK)
    return {
        "own command": own and own.mean,
        **{COLUMN_TITLES[each]: row.language[each][Split.TEST_HOUSE].total for each in controls},
    }


def _seeds(row: Submission) -> list[list[str]]:
    return [
        [
            str(seed.seed),
            *(cell(seed.splits[split].total) for split in SPLITS),
            f"{seed.wall_s:.0f} s",
            f"{seed.machine.device} ({seed.machine.machine}), lcrl_bench {seed.machine.lcrl_bench}",
            seed.files[-1].sha256[:12],
        ]
        for seed in row.seeds
    ]


def _listed(settings: Mapping[str, object]) -> str:
    return ", ".join(f"{key}={value}" for key, value in settings.items())
