"""A success table as a figure: each row's success with its interval, beside the paper's."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lcrl_bench.benchmarks.task import Split
from lcrl_bench.evaluation.reproduction.table import FigureDocument, RowDocument, TableDocument
from lcrl_bench.recording.figures import Theme, save_figure
from lcrl_bench.recording.palette import (
    BLACK,
    BLUE,
    FAINT,
    GREEN,
    GREY,
    INK,
    VERMILION,
    Color,
    hex_color,
)

SPLIT_TITLES: Final = {
    Split.TRAIN: "trained on",
    Split.TEST_TASK: "new tasks",
    Split.TEST_HOUSE: "new houses",
}
"""What a split tests, above its name."""
PARTS: Final[dict[str, tuple[str, str, Color, float]]] = {
    "total": ("all tasks", "o", BLACK, 0.0),
    "nav": ("NAV", "s", BLUE, -0.22),
    "pick": ("PICK", "^", VERMILION, 0.22),
}
"""Column → name, marker, colour, and offset from the middle of its row."""
_ROW_INCHES: Final = 0.42


def success_figure(path: Path, document: TableDocument, theme: Theme | None = None) -> None:
    """Draw the figures of a table: success (%) with its interval, one panel per split.

    Markers differ in shape as well as in colour. A row that was not run says so; controls are below
    a line. The paper's figure for all tasks is an empty diamond.

    Args:
        path: Ends in `.png`, `.svg` or `.pdf`.
        document: The table.
        theme: The page it is for; None lets an SVG follow its reader, and is light otherwise.

    Raises:
        UsageError: If the suffix of `path` is not that of a picture.
    """
    rows = document.rows
    splits = [split for split in Split if any(_figure(row, split, "total") for row in rows)]
    splits = splits or list(Split)
    height = _ROW_INCHES * len(rows) + 1.7
    figure = Figure(figsize=(2.4 + 2.75 * len(splits), height), layout="constrained")
    panels = figure.subplots(1, len(splits), sharey=True, squeeze=False)[0]
    for axes, split in zip(panels, splits, strict=True):
        _draw_panel(axes, document, split)
    panels[0].set_yticks(range(len(rows)), [row.label for row in rows], fontsize=9, color=INK)
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    figure.suptitle(f"{document.title}\n{_condition(document)}", fontsize=11, color=INK)
    handles = _handles(document)
    confidence = 100 * document.interval["confidence"]
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=len(handles),
        fontsize=8.5,
        frameon=False,
        title="success, % of tasks; lines are "
        f"{confidence:.0f} % intervals over houses, tasks and seeds",
        title_fontsize=8.5,
    )
    save_figure(path, figure, theme)


def _draw_panel(axes: Axes, document: TableDocument, split: Split) -> None:
    for place, row in enumerate(document.rows):
        if not any(_figure(row, split, part) for part in PARTS):
            axes.text(50, place, "not run", fontsize=8, color=GREY, ha="center", va="center")
        for part, (_, mark, color, away) in PARTS.items():
            if found := _figure(row, split, part):
                large = part == "total"
                style: dict[str, Any] = {"color": hex_color(color), "solid_capstyle": "butt"}
                axes.plot(
                    [found.low, found.high],
                    [place + away] * 2,
                    linewidth=2.0 if large else 1.1,
                    zorder=3,
                    **style,
                )
                axes.plot(
                    [found.mean],
                    [place + away],
                    marker=mark,
                    markersize=6.5 if large else 4.5,
                    zorder=4,
                    **style,
                )
        found = _figure(row, split, "total")
        if found is not None and found.paper is not None:
            axes.plot([found.paper], [place], zorder=5, **_paper_style())
    first = next((k for k, row in enumerate(document.rows) if row.control), None)
    if first:
        axes.axhline(first - 0.5, color=INK, linewidth=0.7)
    axes.set_title(f"{split.value}\n{SPLIT_TITLES[split]}", fontsize=9.5, color=INK)
    axes.set_xlim(-3, 103)
    axes.set_xticks(range(0, 101, 25))
    axes.grid(axis="x", color=FAINT, linewidth=0.8)
    for place in range(len(document.rows)):
        axes.axhline(place + 0.5, color=FAINT, linewidth=0.5, zorder=0)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8, length=0, colors=INK)
    for side in axes.spines.values():
        side.set_visible(False)


def _figure(row: RowDocument, split: Split, part: str) -> FigureDocument | None:
    return row.figures.get(f"{split.value}.{part}")


def _paper_style() -> dict[str, Any]:
    return {
        "marker": "D",
        "markersize": 6.0,
        "markerfacecolor": "none",
        "markeredgecolor": hex_color(GREEN),
        "markeredgewidth": 1.5,
        "linestyle": "none",
    }


def _seeds(count: int) -> str:
    return f"{count} seed" if count == 1 else f"{count} seeds"


def _condition(document: TableDocument) -> str:
    """The conditions of the figures, and what is missing."""
    words = [f"{document.benchmark} {document.fingerprint[:12]}", _seeds(len(document.seeds))]
    if document.budget is not None:
        words.append(f"only {document.budget:g} of the full training")
    if not document.complete:
        words.append("unfinished")
    return ", ".join(words)


def _handles(document: TableDocument) -> list[Line2D]:
    """The legend of the markers that occur."""
    drawn = [row.figures for row in document.rows]
    handles = []
    for part, (name, mark, color, _) in PARTS.items():
        columns = [f"{split.value}.{part}" for split in Split]
        if any(figures.get(column) for figures in drawn for column in columns):
            shade = hex_color(color)
            handles.append(Line2D([], [], marker=mark, markersize=6, color=shade, label=name))
    found = [figure for figures in drawn for figure in figures.values() if figure is not None]
    if any(figure.paper is not None for figure in found):
        label = "the paper's, all tasks of its own houses"
        handles.append(Line2D([], [], label=label, **_paper_style()))
    return handles
