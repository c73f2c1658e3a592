"""A video frame of an episode: the agent's views, and a plan of the house with the agent.

The house is drawn once per task; a frame adds the agent, its path and the object, which takes
milliseconds. Colours and marks are those of the recordings (`recording.palette`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from lcrl_bench.benchmarks.task_set import TaskSet
from lcrl_bench.envs.text_map import HEADING_NAMES, status
from lcrl_bench.mdp.task_batch import ObjectState
from lcrl_bench.recording.floor import house_plan, outline, tile_centers, tile_shapes
from lcrl_bench.recording.palette import (
    AGENT,
    BLACK,
    GOAL,
    PATH,
    TAKE,
    WHITE,
    Color,
    class_colors,
    hex_color,
)
from lcrl_bench.recording.plan import INK, draw_plan

SIZE: Final = (704, 704)
"""Width and height of a frame: multiples of 16, as video formats require."""
_SCALE: Final = 5
"""Magnification of the views."""
_GAP: Final = 16
_HEAD: Final = 56
"""Height of the command and the status in pixels."""
_LABEL: Final = 18
"""Height of the view labels in pixels."""
_DOTS_PER_INCH: Final = 72


class FramePainter:
    """Paints the frames of episodes; caches the drawing of the last task."""

    def __init__(self, *, horizon: int) -> None:
        """Start with nothing drawn; `horizon` is the length of a full episode."""
        self._horizon = horizon
        self._drawn = ""
        self._plan: Image.Image
        self._place: NDArray[np.float64]
        fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
        self._bold = ImageFont.truetype(fonts / "DejaVuSans-Bold.ttf", 18)
        self._plain = ImageFont.truetype(fonts / "DejaVuSans.ttf", 12)

    def paint(self, one: TaskSet, states: Sequence[int]) -> NDArray[np.uint8]:
        """Paint the last state of an episode so far.

        Returns:
            uint8 [row, column, 3] RGB, of `SIZE`.
        """
        picture = Image.new("RGB", SIZE, WHITE)
        draw = ImageDraw.Draw(picture)
        draw.text((_GAP, 8), one.task.command, fill=BLACK, font=self._bold)
        line = status(one, states, horizon=self._horizon)
        draw.text((_GAP, 32), line, fill=BLACK, font=self._plain)
        bottom = self._paint_views(picture, draw, one, states[-1])
        if self._drawn != one.task.id:
            self._plan, self._place = _draw_plan(one, (SIZE[0], SIZE[1] - bottom))
            self._drawn = one.task.id
        plan = self._plan.copy()
        self._paint_agent(ImageDraw.Draw(plan), one, states)
        picture.paste(plan, (0, bottom))
        return np.asarray(picture).copy()

    def _paint_views(
        self, picture: Image.Image, draw: ImageDraw.ImageDraw, one: TaskSet, state: int
    ) -> int:
        """Paint the four views, framing the one ahead; return the row where they end."""
        _, heading, _ = one.place(state)
        views = class_colors()[one.panorama(state)]
        size = (views.shape[2] * _SCALE, views.shape[1] * _SCALE)
        margin = (SIZE[0] - len(views) * size[0]) // (len(views) + 1)
        top = _HEAD + _LABEL
        for number, view in enumerate(views):
            left = margin + number * (size[0] + margin)
            name = HEADING_NAMES[number]
            draw.text((left, _HEAD), name, fill=BLACK, font=self._plain)
            if number == heading:
                around = (left - 4, top - 4, left + size[0] + 3, top + size[1] + 3)
                draw.rectangle(around, fill=AGENT, outline=BLACK)
            enlarged = Image.fromarray(view).resize(size, Image.Resampling.NEAREST)
            picture.paste(enlarged, (left, top))
        return top + size[1] + 8

    def _paint_agent(self, draw: ImageDraw.ImageDraw, one: TaskSet, states: Sequence[int]) -> None:
        points = [self._pixel(one.scene.grid.points[one.place(s)[0]]) for s in states]
        if len(points) > 1:
            draw.line(points, fill=WHITE, width=6, joint="curve")
            draw.line(points, fill=PATH, width=3, joint="curve")
        _, heading, held = one.place(states[-1])
        draw.polygon(_triangle(points[-1], heading, 11), fill=AGENT, outline=BLACK, width=2)
        if one.task.moved is None:
            return
        _, placement = one.task.carried()
        found = one.scene.house.object(one.task.moved)
        for letter, thing, color, there in (
            ("A", found, TAKE, ObjectState.AT_A),
            ("B", placement, GOAL, ObjectState.AT_B),
        ):
            self._badge(
                draw, self._pixel(np.array(thing.position[:2])), letter, color, filled=held == there
            )
        if held == ObjectState.HELD:
            x, y = points[-1]
            draw.ellipse((x - 4, y - 4, x + 4, y + 4), fill=TAKE, outline=BLACK)

    def _badge(
        self,
        draw: ImageDraw.ImageDraw,
        at: tuple[float, float],
        letter: str,
        color: Color,
        *,
        filled: bool,
    ) -> None:
        """A letter in a circle, filled while the object is there."""
        x, y = at
        fill, ink = (color, WHITE) if filled else (WHITE, color)
        draw.ellipse((x - 9, y - 9, x + 9, y + 9), fill=fill, outline=color, width=2)
        draw.text(at, letter, fill=ink, font=self._plain, anchor="mm")

    def _pixel(self, point: NDArray[np.float64]) -> tuple[float, float]:
        """The pixel of the plan at (x, y) metres."""
        x, y = self._place @ np.array([*point, 1.0])
        return float(x), float(y)


def _draw_plan(one: TaskSet, size: tuple[int, int]) -> tuple[Image.Image, NDArray[np.float64]]:
    """Draw the house with the marks of a task.

    Returns:
        The drawing, and the affine map [2, 3] from (x, y, 1) in metres to its pixels.
    """
    figure = Figure(
        figsize=(size[0] / _DOTS_PER_INCH, size[1] / _DOTS_PER_INCH), dpi=_DOTS_PER_INCH
    )
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    house, grid = one.scene.house, one.scene.grid
    settings: dict[Any, Any] = {"font.family": "DejaVu Sans"}
    with matplotlib.rc_context(settings):
        draw_plan(axes, house_plan(house))
        shapes = tile_shapes(house, grid)
        for tiles, color, inset in (
            (one.object_tiles[0].numpy(), TAKE, 0.07),
            (one.target_tiles[0].numpy(), GOAL, 0.03),
        ):
            lines = outline(shapes, tiles, inset)
            axes.add_collection(LineCollection(lines, colors="white", linewidths=3.6, zorder=5.5))
            border = LineCollection(lines, colors=hex_color(color), linewidths=2.2, zorder=6)
            if color == TAKE:
                border.set_linestyle((0, (2, 1)))
            axes.add_collection(border)
        x, y = tile_centers(grid)[one.task.start_tile]
        half = grid.tile * 0.4
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * half + (x, y)
        axes.plot(*corners.T, color=INK, linewidth=1.6, zorder=7)
        canvas.draw()
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    origin, east, north = axes.transData.transform([(0, 0), (1, 0), (0, 1)])
    place = np.stack([east - origin, north - origin, origin], axis=1)
    # Pixels are counted from the top, matplotlib's from the bottom.
    place[1] = -place[1]
    place[1, 2] += size[1]
    return picture, place


def _triangle(at: tuple[float, float], heading: int, size: float) -> list[tuple[float, float]]:
    """A triangle pointing in the agent's heading, in pixels."""
    forward = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)][heading])
    side = np.array([-forward[1], forward[0]])
    corners = [forward * size, -forward * size * 0.7 + side * size * 0.75]
    corners.append(-forward * size * 0.7 - side * size * 0.75)
    return [tuple((np.array(at) + corner).tolist()) for corner in corners]
