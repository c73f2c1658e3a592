"""What a row of the page opens: recording, pictures, figures, failures, curve, seeds, settings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Final
from urllib.parse import quote

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.document import COLUMNS
from lcrl_bench.board.drawings import bars, curves
from lcrl_bench.board.entries import Entry
from lcrl_bench.evaluation.language import Control
from lcrl_bench.evaluation.outcome import Failure
from lcrl_bench.evaluation.table import cell, interval_cell

ORDER: Final = (Split.TEST_HOUSE, Split.TEST_TASK, Split.TRAIN)
"""What matters most stands first: a narrow screen shows the first columns."""
NAMES: Final = {
    Split.TEST_HOUSE: "new houses",
    Split.TEST_TASK: "new tasks",
    Split.TRAIN: "training",
}
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
class Show:
    """What there is to look at of a row, as the page links to it."""

    recording: str = ""
    """The `.rrd`, relative to the page; empty if there is none."""
    script: str = ""
    """The script that hands the recording to the player: `<row>/<file>.js`."""
    pictures: tuple[Picture, ...] = ()


def details(entry: Entry, show: Show) -> str:
    """The content of a row's details, as HTML."""
    parts = (_look, _figures, _failures, _language, _curve, _about, _seeds)
    return "".join(part(entry, show) for part in parts)


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], *, label: str) -> str:
    """A table of plain texts that scrolls sideways; the first column heads its row."""
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in headings)
    body = "".join(
        f'<tr><th scope="row">{escape(first)}</th>'
        + "".join(f"<td>{escape(text)}</td>" for text in others)
        + "</tr>"
        for first, *others in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(label)}, scrolls">'
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _look(entry: Entry, show: Show) -> str:
    parts = []
    if show.script:
        parts.append(
            f'<p><button type="button" class="play" hidden data-script="{escape(show.script)}" '
            f'data-title="{escape(entry.submission.title)}">▶ Play the recording</button></p>'
        )
    if show.recording:
        link = quote(show.recording)
        parts.append(
            f'<p class="quiet">Or save <a href="{link}" download>recording.rrd</a>, and open it in '
            f"a window of its own:</p>{command('lcrl-bench view recording.rrd')}"
        )
    if show.pictures:
        parts.append(f'<div class="pictures">{"".join(map(_picture, show.pictures))}</div>')
    if not parts:
        again = f"lcrl-bench leaderboard verify leaderboard/submissions/{entry.stem}.json"
        said = '<p class="quiet">Not recorded here. To verify a row is to record it:</p>'
        parts = [said, command(again)]
    return f'<section class="wide"><h3>To look at</h3>{"".join(parts)}</section>'


def _picture(picture: Picture) -> str:
    link, caption = quote(picture.link), escape(picture.caption)
    return (
        f'<figure><a href="{link}"><img src="{link}" alt="{caption}" loading="lazy"></a>'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _figures(entry: Entry, _: Show) -> str:
    row = entry.submission
    rows = []
    for split in ORDER:
        for kind in COLUMNS:
            figure, measures = row.figures[split][kind], row.measures[split]
            bounds = None if figure is None else (figure.low, figure.high)
            rows.append(
                [
                    f"{NAMES[split]}, {kind if kind == 'total' else kind.upper()}",
                    cell(None if figure is None else figure.mean),
                    interval_cell(bounds),
                    *(cell(measures[name][kind]) for name in ("final", "path_weighted", "regret")),
                    "–" if figure is None else f"{figure.n:,}",
                ]
            )
    headings = ["%", "success", "95 % interval", "at the end", "path-weighted", "regret", "n"]
    drawn = table(headings, rows, label="All figures")
    return f'<section class="wide"><h3>All figures</h3>{drawn}</section>'


def _failures(entry: Entry, _: Show) -> str:
    shares = entry.submission.failures[Split.TEST_HOUSE]
    named = {FAILURES[failure]: share for failure, share in shares.items()}
    drawn = bars(named, title="How PICK tasks fail in new houses, per cent")
    return f"<section><h3>How PICK fails in new houses, %</h3>{drawn}</section>"


def _language(entry: Entry, _: Show) -> str:
    row = entry.submission
    own = row.figures[Split.TEST_HOUSE]["total"]
    said = {"its own command": None if own is None else own.mean}
    words = {
        Control.PARAPHRASE: "in other words",
        Control.WRONG_TARGET: "a wrong target",
        Control.SHUFFLED: "another task",
        Control.BLANK: "nothing",
    }
    said |= {text: row.language[name][Split.TEST_HOUSE].total for name, text in words.items()}
    drawn = bars(said, title="Success in new houses by what is said, per cent")
    return f"<section><h3>Success in new houses if told &hellip;, %</h3>{drawn}</section>"


def _curve(entry: Entry, _: Show) -> str:
    lines = [[(point.step, point.loss) for point in seed.curve] for seed in entry.submission.seeds]
    drawn = curves(lines, title="Training loss of each seed by step")
    return f"<section><h3>Training loss, a line a seed</h3>{drawn}</section>"


def _about(entry: Entry, _: Show) -> str:
    row = entry.submission
    changed = ", ".join(f"{key}={value}" for key, value in row.changed.items())
    lines = [
        ("Method", escape(f"{row.method}: {row.summary}")),
        ("Settings", escape(f"preset {row.preset}; changed: {changed or 'nothing'}")),
        ("Submitted by", escape(row.author)),
        ("Code", _link(row.code)),
        ("Checkpoints", _link(row.weights)),
        (entry.mark.capitalize(), escape(entry.note)),
    ]
    shown = "".join(f"<dt>{name}</dt><dd>{text}</dd>" for name, text in lines if text)
    again = f"lcrl-bench leaderboard verify leaderboard/submissions/{entry.stem}.json"
    every = ", ".join(f"{key}={value}" for key, value in row.settings.items())
    return (
        f'<section class="wide"><h3>About</h3><dl>{shown}</dl>'
        f"<details><summary>All settings</summary><p><code>{escape(every)}</code></p></details>"
        f'<p class="quiet">Run it again:</p>{command(again)}</section>'
    )


def _link(text: str) -> str:
    """A text; a link if it is an address of the web."""
    shown = escape(text)
    if not text.startswith("https://"):
        return shown
    return f'<a rel="noreferrer noopener" href="{shown}">{shown}</a>'


def _seeds(entry: Entry, _: Show) -> str:
    rows = [
        [
            str(seed.seed),
            *(cell(seed.splits[split].total) for split in ORDER),
            f"{seed.wall_s:.0f} s",
            f"{seed.machine.device} ({seed.machine.machine}), lcrl_bench {seed.machine.lcrl_bench}",
            seed.files[-1].sha256[:12],
        ]
        for seed in entry.submission.seeds
    ]
    headings = ["seed", *(NAMES[split] for split in ORDER), "took", "on", "checkpoint"]
    drawn = table(headings, rows, label="Seeds")
    return f'<section class="wide"><h3>Seeds, success in %</h3>{drawn}</section>'


def command(text: str) -> str:
    """A command with a button that copies it."""
    return (
        f'<div class="command"><pre><code>{escape(text)}</code></pre>'
        '<button type="button" class="copy" hidden>Copy</button></div>'
    )
