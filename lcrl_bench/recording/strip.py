"""A rollout as a strip of pictures: the panorama around the agent, and what it does.

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
from numpy.typing import NDArray

from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.episode import Episode
from lcrl_bench.recording.figures import Theme, draw_class_legend, save_figure
from lcrl_bench.recording.narration import action_phrase, episode_title, thing_name
from lcrl_bench.recording.palette import AGENT, GOAL, GREY, INK, class_colors, hex_color

COLUMNS: Final = 4
"""Frames side by side."""
_NAMED: Final = 14
"""Classes named under the frames: those seen the most."""


@dataclass(frozen=True)
class Frame:
    """A picture of a strip: consecutive steps without a change share one."""

    first: int
    """Its first step."""
    last: int
    """Its last step; the action taken then leads to the next frame."""


def strip_frames(episode: Episode) -> tuple[Frame, ...]:
    """The frames of an episode, in order: runs of steps in the same state."""
    changes = np.flatnonzero(np.diff(episode.states)) + 1
    firsts = [0, *changes.tolist()]
    lasts = [*(changes - 1).tolist(), episode.horizon]
    return tuple(Frame(first, last) for first, last in zip(firsts, lasts, strict=True))


def strip_picture(path: Path, episode: Episode, theme: Theme | None = None) -> None:
    """Draw the panorama around the agent at each step, centred on what is ahead, and its actions.

    An orange border means that the command is fulfilled, a yellow one that the object is in hand;
    both are also said in words.

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
    colors = class_colors()
    counts = np.zeros(len(colors), np.int64)
    for axes, frame in zip(panels, frames, strict=False):
        views = episode.panorama(int(episode.cells[frame.first]))
        view = facing(views, int(episode.headings[frame.first]))
        axes.imshow(colors[view], interpolation="nearest")
        # The view ahead is between these.
        edges = 1.5 * views.shape[2] - 0.5, 2.5 * views.shape[2] - 0.5
        for edge, (start, end) in itertools.product(edges, ((0.0, 0.12), (0.88, 1.0))):
            axes.axvline(edge, start, end, color=INK, linewidth=1.2)
        counts += np.bincount(view.reshape(-1), minlength=len(counts))
        _draw_words(axes, episode, frame)
    title = f"{episode_title(episode)}: all round, with what lies ahead in the middle"
    figure.suptitle(title, fontsize=11, color=INK, parse_math=False)
    draw_class_legend(figure, counts, most=_NAMED, columns=7, size=8)
    save_figure(path, figure, theme)


def facing(views: NDArray[np.uint8], heading: int) -> NDArray[np.uint8]:
    """A panorama as one 360° picture, centred on what is ahead.

    Args:
        views: uint8 [4, row, column]: north, east, south, west.
        heading: 0..3 for north, east, south, west.

    Returns:
        uint8 [row, 4 * column]: half of the view behind, left, ahead, right, the other half.
    """
    left_first = np.concatenate([views[(heading + turn) % 4] for turn in (-1, 0, 1, 2)], axis=1)
    return np.roll(left_first, views.shape[2] // 2, axis=1)


def frame_words(episode: Episode, frame: Frame) -> tuple[str, str]:
    """The words above a frame and below it: its steps and facts; what the agent does."""
    steps = f"{frame.first}" if frame.first == frame.last else f"{frame.first} to {frame.last}"
    facts = []
    if episode.object_states[frame.first] == ObjectState.HELD:
        facts.append(f"has the {thing_name(episode)}")
    if episode.done[frame.first]:
        facts.append("at the goal")
    above = ", ".join([steps, *facts])
    if frame.last < episode.horizon:
        return above, action_phrase(episode, frame.last)
    # Nothing changes any more: say what the agent does instead.
    return above, "end" if frame.first == frame.last else action_phrase(episode, frame.first)


def _draw_words(axes: Axes, episode: Episode, frame: Frame) -> None:
    above, below = frame_words(episode, frame)
    axes.set_title(above, fontsize=7.5, color=INK, pad=4)
    axes.text(
        0.5, -0.05, below, transform=axes.transAxes, fontsize=8, weight="bold", color=INK,
        ha="center", va="top",
    )  # fmt: skip
    color, width = GREY, 0.6
    if episode.object_states[frame.first] == ObjectState.HELD:
        color, width = hex_color(AGENT), 3.0
    if episode.done[frame.first]:
        color, width = hex_color(GOAL), 3.0
    axes.set_axis_on()
    axes.set(xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set(edgecolor=color, linewidth=width)
