"""Learning curves: what a method logged while training, over passes or steps."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from lcrl_bench.evaluation.run_folder import RunFolder
from lcrl_bench.recording.palette import BLUE, FAINT, INK, hex_color

_COUNTERS: Final = ("step", "steps")
_RAW: Final = "#b9cfe0"
_MOST: Final = 2000
"""Most points of the raw curve: more than a picture has columns."""


def training_curves(folder: RunFolder, houses: int, title: str) -> Figure | None:
    """What a run's training logged; None if it logged no number.

    Args:
        folder: The run's.
        houses: Number of training houses.
        title: What was trained.
    """
    metrics = folder.path / "metrics.jsonl"
    rows = read_metrics(metrics) if metrics.exists() else []
    if not series(rows):
        return None
    passes = ((folder.config or {}).get("resolved") or {}).get("passes")
    # Methods that train in passes take one step per house.
    whole = passes is not None and rows[-1].get("steps", 0) % houses == 0
    return curves_figure(rows, title=title, pass_steps=houses if whole else None)


def read_metrics(path: Path) -> list[dict[str, Any]]:
    """The rows of a `metrics.jsonl`, skipping truncated lines.

    Raises:
        OSError: If the file can't be read.
    """
    rows = []
    for line in path.read_text("utf-8").splitlines():
        try:
            row = json.loads(line)
        except ValueError:
            continue
        if isinstance(row, dict) and isinstance(row.get("step"), int):
            rows.append(row)
    return rows


def curves_figure(
    rows: Sequence[Mapping[str, Any]], *, title: str, pass_steps: int | None = None
) -> Figure:
    """Draw each quantity a training logged in a panel of its own: raw and smoothed.

    Args:
        rows: `{"step": 3, "steps": 600, "loss": 0.12, ...}`, in order.
        title: What was trained.
        pass_steps: Steps per pass, to draw curves over passes and smooth over one pass; None draws
            over steps and smooths over a fiftieth of them.

    Raises:
        ValueError: If no row has a number besides the steps.
    """
    found = series(rows)
    if not found:
        raise ValueError("the metrics hold no number to draw")
    window = pass_steps or max(len(rows) // 50, 1)
    figure = Figure(figsize=(7.0, 0.9 + 2.3 * len(found)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(len(found), 1, sharex=True))
    for axes, (name, (steps, values)) in zip(panels, found.items(), strict=True):
        _draw(axes, steps / (pass_steps or 1), values, window)
        axes.set_ylabel(name.replace("_", " "), fontsize=9, color=INK)
    words = "pass over the training houses" if pass_steps else "step"
    span = "pass" if pass_steps else f"{window} steps"
    panels[-1].set_xlabel(f"{words} (bold: mean over the last {span})", fontsize=9, color=INK)
    figure.suptitle(title, fontsize=11, color=INK)
    return figure


def series(
    rows: Sequence[Mapping[str, Any]],
) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Each logged quantity: its steps and its finite values, the loss first.

    Returns:
        Name → (float64 [n], float64 [n]).
    """
    names = sorted({name for row in rows for name in row} - {*_COUNTERS}, key=_loss_first)
    found = {}
    for name in names:
        pairs = [
            (row["step"], float(row[name]))
            for row in rows
            if isinstance(row.get(name), int | float) and math.isfinite(row[name])
        ]
        if pairs:
            steps, values = np.array(pairs, np.float64).T
            found[name] = (steps, values)
    return found


def _loss_first(name: str) -> tuple[bool, str]:
    return name != "loss", name


def smoothed(values: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    """Trailing mean over `window` values, or over as many as there are.

    Args:
        values: float64 [n].
        window: At least 1.

    Returns:
        float64 [n].
    """
    ends = np.arange(1, len(values) + 1)
    starts = np.maximum(ends - window, 0)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return (sums[ends] - sums[starts]) / (ends - starts)


def _draw(axes: Axes, times: NDArray, values: NDArray, window: int) -> None:
    every = -(-len(values) // _MOST)
    axes.plot(times[::every], values[::every], color=_RAW, linewidth=0.7)
    mean = smoothed(values, window)
    axes.plot(times[::every], mean[::every], color=hex_color(BLUE), linewidth=1.8)
    # A few outliers would flatten everything else.
    low, high = np.quantile(values, [0.002, 0.998])
    low, high = min(low, float(mean.min())), max(high, float(mean.max()))
    margin = 0.05 * (high - low) or 0.5
    axes.set_ylim(low - margin, high + margin)
    axes.margins(x=0.01)
    axes.annotate(
        f"{mean[-1]:.3g}",
        (times[-1], mean[-1]),
        xytext=(4, 0),
        textcoords="offset points",
        fontsize=8,
        color=hex_color(BLUE),
        va="center",
        annotation_clip=False,
    )
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8, colors=INK)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
