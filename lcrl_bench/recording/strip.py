"""A rollout as a strip of pictures: what is round the agent, moment by moment, and its acts.

Source: paper, the figure of an agent carrying out a command.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import Theme, save_figure
from lcrl_bench.recording.narration import action_phrase, episode_title, object_phrase, thing_name
from lcrl_bench.recording.palette import AGENT, GOAL, GREY, INK, class_colors, hex_color

COLUMNS: Final = 4
"""Frames side by side."""
_NAMED: Final = 14
"""Classes named under the frames, of those seen the most."""


@dataclass(frozen=True)
class Frame:
    """A moment of a strip: steps during which nothing changes are one."""

    first: int
    """Its first step."""
    last: int
    """Its last step: what the agent does then leads to the next frame."""


def strip_frames(episode: Episode) -> tuple[Frame, ...]:
    """The frames of an episode, in order: each step is in one, and one state fills a frame."""
    changes = np.flatnonzero(np.diff(episode.states)) + 1
    firsts = [0, *changes.tolist()]
    lasts = [*(changes - 1).tolist(), episode.horizon]
    return tuple(Frame(first, last) for first, last in zip(firsts, lasts, strict=True))


def strip_picture(path: Path, episode: Episode, theme: Theme | None = None) -> None:
    """Draw the panorama round the agent at each step, what lies ahead in the middle, and its acts.

    A frame bordered in orange is one in which the command is fulfilled, in yellow one in which the
    object is in hand; both are also said in words.

    Args:
        path: Ends in `.png`, `.svg` or `.pdf`.
        episode: What happened.
        theme: The page it is for; None lets an SVG follow its reader, and is light otherwise.

    Raises:
        UsageError: If the suffix of `path` is not that of a picture.
    """
    frames = strip_frames(episode)
    columns = min(COLUMNS, len(frames))
    rows = -(-len(frames) // columns)
    figure = Figure(figsize=(3.6 * COLUMNS, 1.12 * rows + 1.1), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False).reshape(-1)
    for axes in panels:
        axes.set_axis_off()
    counts = np.zeros(len(class_colors()), np.int64)
    for axes, frame in zip(panels, frames, strict=False):
        views = episode.panorama(int(episode.cells[frame.first]))
        view = facing(views, int(episode.headings[frame.first]))
        axes.imshow(class_colors()[view], interpolation="nearest")
        # What lies ahead is between these.
        edges = 1.5 * views.shape[2] - 0.5, 2.5 * views.shape[2] - 0.5
        for edge, (start, end) in itertools.product(edges, ((0.0, 0.12), (0.88, 1.0))):
            axes.axvline(edge, start, end, color=INK, linewidth=1.2)
        counts += np.bincount(view.reshape(-1), minlength=len(counts))
        _draw_words(axes, episode, frame)
    title = f"{episode_title(episode)}: all round, with what lies ahead in the middle"
    figure.suptitle(title, fontsize=11, color=INK, parse_math=False)
    classes = semantic_classes()
    seen = [number for number in np.argsort(-counts, kind="stable") if counts[number]]
    handles = [
        Patch(
            facecolor=hex_color(classes[number].color),
            edgecolor=INK,
            linewidth=0.4,
            label=classes[number].words,
        )
        for number in seen[:_NAMED]
    ]
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=7,
        fontsize=8,
        frameon=False,
        handlelength=1.0,
        handleheight=1.0,
    )
    save_figure(path, figure, theme)


def facing(views: NDArray[np.uint8], heading: int) -> NDArray[np.uint8]:
    """A panorama as one picture all round, with what lies ahead in its middle.

    Args:
        views: uint8 [4, row, column]: north, east, south, west.
        heading: 0..3 for north, east, south, west.

    Returns:
        uint8 [row, 4 * column]: half of what is behind, left, ahead, right, the other half.
    """
    left_first = np.concatenate([views[(heading + turn) % 4] for turn in (-1, 0, 1, 2)], axis=1)
    return np.roll(left_first, views.shape[2] // 2, axis=1)


def frame_words(episode: Episode, frame: Frame) -> tuple[str, str]:
    """What stands over a frame and under it: its steps and what holds; what the agent does."""
    steps = f"{frame.first}" if frame.first == frame.last else f"{frame.first} to {frame.last}"
    facts = []
    if object_phrase(episode, frame.first) == "in hand":
        facts.append(f"has the {thing_name(episode)}")
    if episode.done[frame.first]:
        facts.append("at the goal")
    above = ", ".join([steps, *facts])
    if frame.last < episode.horizon:
        return above, action_phrase(episode, frame.last)
    # Nothing changes any more: say what it does instead of moving.
    return above, "end" if frame.first == frame.last else action_phrase(episode, frame.first)


def _draw_words(axes: Axes, episode: Episode, frame: Frame) -> None:
    above, below = frame_words(episode, frame)
    axes.set_title(above, fontsize=7.5, color=INK, pad=4)
    axes.text(
        0.5, -0.05, below, transform=axes.transAxes, fontsize=8, weight="bold", color=INK,
        ha="center", va="top",
    )  # fmt: skip
    color, width = GREY, 0.6
    if object_phrase(episode, frame.first) == "in hand":
        color, width = hex_color(AGENT), 3.0
    if episode.done[frame.first]:
        color, width = hex_color(GOAL), 3.0
    axes.set_axis_on()
    axes.set(xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set(edgecolor=color, linewidth=width)
