"""What the policy likes at a step, as bars with names: probabilities from none to all."""

from __future__ import annotations

from typing import Final

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from lcrl_bench.mdp.task_batch import ACTIONS, Action
from lcrl_bench.recording.narration import ACTION_NAMES
from lcrl_bench.recording.palette import ACTION_COLORS

CHANCES: Final = "policy"
WIDE: Final = 80
"""Columns of a bar that stands for certainty."""
ROW: Final = 20
"""Rows from a bar to the next."""
_BAR: Final = 16
_BELOW: Final = 6
"""Rows from a point to its name: the viewer writes it below."""
_TRACK: Final = (44, 44, 48)
BACKGROUND: Final = (13, 13, 15)
"""Of the view: that of the viewer round it."""


def log_chances(rec: rr.RecordingStream, chances: NDArray[np.float64]) -> None:
    """Log a bar for each action, named with its probability.

    Args:
        rec: Where, at the time that is set.
        chances: float64 [action], adding up to 1.
    """
    rec.log(f"{CHANCES}/bars", rr.Image(chance_bars(chances)))
    names = rr.Points2D(
        [(WIDE / 2, action * ROW + _BAR / 2 - _BELOW) for action in range(ACTIONS)],
        labels=[f"{ACTION_NAMES[Action(a)]} {chances[a]:.2f}" for a in range(ACTIONS)],
        colors=(255, 255, 255),
        radii=0.0,
        show_labels=True,
        draw_order=10,
    )
    rec.log(f"{CHANCES}/names", names)


def chance_bars(chances: NDArray[np.float64]) -> NDArray[np.uint8]:
    """The bars as a picture: uint8 [row, column, 3], an action every `ROW` rows."""
    picture = np.empty((ACTIONS * ROW, WIDE, 3), np.uint8)
    picture[:] = BACKGROUND
    for action, chance in enumerate(chances):
        bar = picture[action * ROW : action * ROW + _BAR]
        bar[:] = _TRACK
        bar[:, : round(float(chance) * WIDE)] = ACTION_COLORS[action]
    return picture
