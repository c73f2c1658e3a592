"""What a row of the page opens: failures, seeds, learning curve, settings, pictures, commands."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Final
from urllib.parse import quote

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.board.drawings import bars, curves
from lcrl_bench.board.entries import Entry
from lcrl_bench.evaluation.table import cell

ORDER: Final = (Split.TEST_HOUSE, Split.TEST_TASK, Split.TRAIN)
"""What matters most stands first: a narrow screen shows the first columns."""
PICTURES: Final = (".png", ".jpg", ".webp")
RECORDING: Final = ".rrd"


@dataclass(frozen=True)
class Artifact:
    """A file given for an entry, as the page names it."""

    name: str
    link: str
    """Relative to the page, escaped for a URL."""
    path: str
    """Relative to the page, as a command takes it."""


def artifacts_of(entry: Entry, folder: Path | None, *, page: Path) -> tuple[Artifact, ...]:
    """The pictures and recordings in `folder/<name of the submission's file>/`."""
    if folder is None:
        return ()
    wanted = (*PICTURES, RECORDING)
    found = (path for path in sorted((folder / entry.stem).glob("*")) if path.suffix in wanted)
    relative = ((path, os.path.relpath(path.resolve(), page.resolve())) for path in found)
    return tuple(Artifact(path.name, quote(Path(way).as_posix()), way) for path, way in relative)


def details(entry: Entry, artifacts: Sequence[Artifact]) -> str:
    """The content of a row's details, as HTML."""
    return "".join(
        (_about(entry), _failures(entry), _curve(entry), _seeds(entry), _files(artifacts))
    )


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of plain texts; the first column heads its row."""
    head = "".join(f'<th scope="col">{escape(text)}</th>' for text in headings)
    body = "".join(
        f'<tr><th scope="row">{escape(first)}</th>'
        + "".join(f"<td>{escape(text)}</td>" for text in others)
        + "</tr>"
        for first, *others in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _about(entry: Entry) -> str:
    row = entry.submission
    changed = ", ".join(f"{key}={value}" for key, value in row.changed.items())
    code = escape(row.code)
    if row.code.startswith("https://"):
        code = f'<a rel="noreferrer noopener" href="{code}">{code}</a>'
    lines = [
        ("Method", escape(f"{row.method}: {row.summary}")),
        ("Settings", escape(f"preset {row.preset}; changed: {changed or 'nothing'}")),
        ("Submitted by", escape(row.author)),
        ("Code", code),
        (entry.mark.capitalize(), escape(entry.note)),
    ]
    shown = "".join(f"<p><b>{name}.</b> {text}</p>" for name, text in lines if text)
    again = f"lcrl-bench leaderboard verify leaderboard/submissions/{entry.stem}.json --runs runs"
    every = ", ".join(f"{key}={value}" for key, value in row.settings.items())
    return (
        f"<section><h3>About</h3>{shown}{_command(again)}"
        f"<details><summary>All settings</summary><p><code>{escape(every)}</code></p></details>"
        "</section>"
    )


def _failures(entry: Entry) -> str:
    shares = entry.submission.failures[Split.TEST_HOUSE]
    named = {failure.value.replace("_", " "): share for failure, share in shares.items()}
    drawn = bars(named, title="How PICK tasks fail in new houses, per cent")
    return f"<section><h3>How PICK fails in new houses, %</h3>{drawn}</section>"


def _curve(entry: Entry) -> str:
    lines = [[(point.step, point.loss) for point in seed.curve] for seed in entry.submission.seeds]
    drawn = curves(lines, title="Training loss of each seed by step")
    return f"<section><h3>Training loss, a line a seed</h3>{drawn}</section>"


def _seeds(entry: Entry) -> str:
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
    headings = ["seed", *(split.value for split in ORDER), "took", "on", "checkpoint"]
    grid = table(headings, rows)
    return (
        '<section class="wide"><h3>Seeds, success in %</h3><div class="scroll" tabindex="0" '
        f'role="region" aria-label="Seeds, scrolls sideways">{grid}</div></section>'
    )


def _files(artifacts: Sequence[Artifact]) -> str:
    parts = []
    for artifact in artifacts:
        name = escape(artifact.name)
        if artifact.name.endswith(RECORDING):
            parts.append(f'<p>Recording: <a href="{artifact.link}">{name}</a></p>')
            parts.append(_command(f"rerun --bind 127.0.0.1 '{artifact.path}'"))
        else:
            parts.append(
                f'<a href="{artifact.link}"><img src="{artifact.link}" alt="{name}" '
                'loading="lazy"></a>'
            )
    if not parts:
        return ""
    return f'<section class="wide"><h3>To look at</h3>{"".join(parts)}</section>'


def _command(text: str) -> str:
    return (
        f'<pre><code>{escape(text)}</code></pre><button type="button" class="copy" hidden>'
        "Copy</button>"
    )
