"""What the agent sees, as pictures: a panorama, and an episode as a strip of them.

Source: paper, the figure of an agent carrying out a command.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from lcrl_bench.houses.classes import semantic_classes
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.panoramas import CLASSES
from lcrl_bench.recording.narration import HEADING_NAMES
from lcrl_bench.recording.palette import AGENT, GOAL, GREY, INK, class_colors, hex_color
from lcrl_bench.recording.storyboard import Storyboard

COLUMNS: Final = 4
"""Frames side by side."""
_NAMED: Final = 14
"""Classes named under the frames: those seen the most."""


def panorama_picture(panorama: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The four views of a panorama side by side, in the colours of their classes.

    Args:
        panorama: uint8 [4, row, column] class ids: the views N, E, S, W.

    Returns:
        uint8 [row, 4 * column, 3] RGB: north, east, south, west from left to right, so that
        neighbouring views join.
    """
    return class_colors()[np.concatenate(list(panorama), axis=1)]


def panorama_figure(panorama: NDArray[np.uint8]) -> Figure:
    """The four views of a panorama side by side, with the classes that they show.

    Args:
        panorama: uint8 [4, row, column] class ids: the views N, E, S, W.
    """
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    axes = figure.subplots()
    axes.imshow(panorama_picture(panorama), interpolation="nearest")
    width = panorama.shape[2]
    axes.set_xticks([(k + 0.5) * width - 0.5 for k in range(4)], HEADING_NAMES, fontsize=8)
    axes.set_yticks([])
    for k in range(1, 4):
        axes.axvline(k * width - 0.5, color="white", linewidth=1.0)
    _name_classes(figure, _class_pixels(panorama), most=12, columns=6, size=7)
    return figure


def draw_panorama(figure: Any, axes: Axes, panorama: NDArray[np.uint8]) -> None:  # noqa: ANN401
    """Draw the four views of a panorama with gaps between, and name their classes.

    Args:
        figure: A matplotlib figure or subfigure, under which classes are named.
        axes: Where to draw.
        panorama: uint8 [4, row, column] class ids: the views N, E, S, W.
    """
    rows, columns = panorama.shape[1:]
    picture = panorama_picture(panorama)
    gap = 2
    spread = np.zeros((rows, 4 * columns + 3 * gap, 4), np.uint8)
    for view, name in enumerate(HEADING_NAMES):
        start = view * (columns + gap)
        part = picture[:, view * columns : (view + 1) * columns]
        spread[:, start : start + columns] = np.dstack([part, np.full(part.shape[:2], 255)])
        axes.text(start + columns / 2, -1.5, name, fontsize=8, color=INK, ha="center", va="bottom")
    axes.imshow(spread, interpolation="nearest")
    axes.set_axis_off()
    _name_classes(figure, _class_pixels(panorama), most=18, columns=6, size=7)


def _class_pixels(panorama: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Pixels of each class: [class]."""
    return np.bincount(np.asarray(panorama).reshape(-1), minlength=CLASSES)


@dataclass(frozen=True)
class Frame:
    """A picture of a strip: consecutive steps without a change share one."""

    first: int
    """Its first step."""
    last: int
    """Its last step; the action taken then leads to the next frame."""


def strip_frames(states: NDArray[np.int64]) -> tuple[Frame, ...]:
    """The frames of an episode, in order: runs of steps in the same state.

    Args:
        states: [horizon + 1].
    """
    changes = np.flatnonzero(np.diff(states)) + 1
    firsts = [0, *changes.tolist()]
    lasts = [*(changes - 1).tolist(), len(states) - 1]
    return tuple(Frame(first, last) for first, last in zip(firsts, lasts, strict=True))


def strip_figure(board: Storyboard) -> Figure:
    """Draw the panorama around the agent at each step, centred on what is ahead, and its actions.

    An orange border means that the command is fulfilled, a yellow one that the object is in hand;
    both are also said in words.
    """
    episode, frames = board.episode, strip_frames(board.episode.states)
    columns = min(COLUMNS, len(frames))
    rows = -(-len(frames) // columns)
    figure = Figure(figsize=(3.6 * COLUMNS, 1.12 * rows + 1.1), layout="constrained")
    panels = figure.subplots(rows, COLUMNS, squeeze=False).reshape(-1)
    for axes in panels:
        axes.set_axis_off()
    colors = class_colors()
    counts = np.zeros(len(colors), np.int64)
    for axes, frame in zip(panels, frames, strict=False):
        views = episode.seen[frame.first]
        view = facing(views, int(episode.headings[frame.first]))
        axes.imshow(colors[view], interpolation="nearest")
        # The view ahead is between these.
        edges = 1.5 * views.shape[2] - 0.5, 2.5 * views.shape[2] - 0.5
        for edge, (start, end) in itertools.product(edges, ((0.0, 0.12), (0.88, 1.0))):
            axes.axvline(edge, start, end, color=INK, linewidth=1.2)
        counts += np.bincount(view.reshape(-1), minlength=len(counts))
        _draw_words(axes, board, frame)
    title = f"{board.title}: all round, with what lies ahead in the middle"
    figure.suptitle(title, fontsize=11, color=INK, parse_math=False)
    _name_classes(figure, counts, most=_NAMED, columns=7, size=8)
    return figure


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


def frame_words(board: Storyboard, frame: Frame) -> tuple[str, str]:
    """The words above a frame and below it: its steps and facts; what the agent does."""
    episode, steps = board.episode, board.steps
    numbers = f"{frame.first}" if frame.first == frame.last else f"{frame.first} to {frame.last}"
    facts = []
    if episode.object_states[frame.first] == ObjectState.HELD:
        facts.append(f"has the {episode.thing_name}")
    if episode.done[frame.first]:
        facts.append("at the goal")
    above = ", ".join([numbers, *facts])
    if frame.last < episode.horizon:
        return above, steps[frame.last].action
    # Nothing changes any more: say what the agent does instead.
    return above, "end" if frame.first == frame.last else steps[frame.first].action


def _draw_words(axes: Axes, board: Storyboard, frame: Frame) -> None:
    episode = board.episode
    above, below = frame_words(board, frame)
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


def _name_classes(
    figure: Any,  # noqa: ANN401 - a figure or a part of one
    counts: NDArray[np.int64],
    *,
    most: int,
    columns: int,
    size: float,
) -> None:
    """Name the classes seen the most under a figure.

    Args:
        figure: A matplotlib figure or subfigure.
        counts: [class] pixels.
        most: Classes named at most.
        columns: Names side by side.
        size: Of the letters, in points.
    """
    classes = semantic_classes()
    seen = [number for number in np.argsort(-counts, kind="stable") if counts[number]]
    handles = [
        Patch(
            facecolor=hex_color(classes[number].color),
            edgecolor=INK,
            linewidth=0.4,
            label=classes[number].words,
        )
        for number in seen[:most]
    ]
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns,
        fontsize=size,
        frameon=False,
        handlelength=1.0,
        handleheight=1.0,
    )
