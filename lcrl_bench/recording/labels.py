"""Names on a drawing that keep off each other: each goes to the first free spot near its place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import AbstractPathEffect

POINT: Final = 1 / 72
"""Inches of a typographic point."""
_WIDTH: Final = {"normal": 0.56, "bold": 0.66}
"""Mean width of a letter in units of its size, by weight."""
_LINE: Final = 1.15
"""Height of a line in units of the size of its letters."""
_FAR: Final = (0.0, 0.9, 1.6, 2.4)
"""Distances tried, in heights of a line."""
_TRIED: Final = 8
"""Directions tried at each distance."""


class LabelLayout:
    """Places names on axes whose limits and size are final."""

    def __init__(self, axes: Axes) -> None:
        """Start with nothing placed."""
        self._axes = axes
        self._boxes: list[tuple[float, float, float, float]] = []
        west, east = axes.get_xlim()
        south, north = axes.get_ylim()
        # Equal axes shrink to the tighter of the two.
        pixels = min(axes.bbox.width / (east - west), axes.bbox.height / (north - south))
        figure = axes.get_figure(root=True)
        assert figure is not None
        self._scale = pixels / figure.dpi
        """Inches a metre."""

    def place(
        self,
        text: str,
        at: Sequence[float],
        *,
        size: float,
        color: str,
        weight: str = "normal",
        effects: Sequence[AbstractPathEffect] = (),
        force: bool = False,
        turn: bool = False,
    ) -> bool:
        """Write a name at the first free spot round `at`, with a line to it if it had to move.

        Args:
            text: The name.
            at: (x, y) metres of what it names.
            size: Of its letters, in points.
            color: Of its letters.
            weight: `"normal"` or `"bold"`.
            effects: Such as a halo.
            force: Whether to write it at `at` when no spot is free; otherwise it is left out.
            turn: Whether to try it upright too.

        Returns:
            Whether it was written.
        """
        unit = size * POINT / self._scale
        wide, high = len(text) * _WIDTH[weight] * unit, _LINE * unit
        at = self._inside(at, wide / 2) if force else (at[0], at[1])
        for turned in (True, False) if turn else (False,):
            half = (high / 2, wide / 2) if turned else (wide / 2, high / 2)
            spots = self._spots(at, half, high) if not turned else [(at[0], at[1])]
            for spot in spots:
                if self._free(spot, half):
                    style = {"size": size, "color": color, "weight": weight, "turned": turned}
                    self._write(text, at, spot, half, effects, style)
                    return True
        if force:
            style = {"size": size, "color": color, "weight": weight, "turned": False}
            self._write(text, at, (at[0], at[1]), (wide / 2, high / 2), effects, style)
        return force

    def _inside(self, at: Sequence[float], half: float) -> tuple[float, float]:
        """The place nearest to `at` from which a name `half` as wide ends within the axes."""
        west, east = self._axes.get_xlim()
        return float(np.clip(at[0], west + half, max(east - half, west + half))), at[1]

    def _spots(
        self, at: Sequence[float], half: tuple[float, float], line: float
    ) -> list[tuple[float, float]]:
        """Where a name could go, nearest first."""
        spots = [(at[0], at[1])]
        for far in _FAR[1:]:
            for turn in np.arange(_TRIED) * 2 * np.pi / _TRIED + np.pi / 2:
                east = np.cos(turn) * (half[0] + far * line * 0.5)
                spots.append((at[0] + east, at[1] + np.sin(turn) * far * line))
        return spots

    def _free(self, spot: tuple[float, float], half: tuple[float, float]) -> bool:
        west, east = self._axes.get_xlim()
        south, north = self._axes.get_ylim()
        x0, x1 = spot[0] - half[0], spot[0] + half[0]
        y0, y1 = spot[1] - half[1], spot[1] + half[1]
        if x0 < west or x1 > east or y0 < south or y1 > north:
            return False
        return not any(
            x0 < right and left < x1 and y0 < top and bottom < y1
            for left, bottom, right, top in self._boxes
        )

    def _write(
        self,
        text: str,
        at: Sequence[float],
        spot: tuple[float, float],
        half: tuple[float, float],
        effects: Sequence[AbstractPathEffect],
        style: dict[str, Any],
    ) -> None:
        x, y = spot
        self._boxes.append((x - half[0], y - half[1], x + half[0], y + half[1]))
        if (x, y) != (at[0], at[1]):
            line = {"color": style["color"], "linewidth": 0.5, "zorder": 8}
            self._axes.plot([at[0], x], [at[1], y], **line)
        self._axes.text(
            x,
            y,
            text,
            fontsize=style["size"],
            color=style["color"],
            weight=style["weight"],
            rotation=90 if style["turned"] else 0,
            ha="center",
            va="center",
            path_effects=list(effects),
            zorder=9,
            clip_on=True,
        )
