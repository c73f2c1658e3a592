"""The panoramas of a house: the arrangements its tasks lead to, and the panorama of each cell.

A panorama depends on the tile and on where the moved object is, not on the heading, so a house has
`arrangements x tiles` panoramas, indexed `arrangement * tiles + tile`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.benchmarks.task import Kind, Task
from lcrl_bench.errors import UsageError
from lcrl_bench.mdp.task_batch import OBJECT_STATES
from lcrl_bench.scenes.arrangement import AS_FOUND, Arrangement
from lcrl_bench.semantics import Semantics


def arrangements_of(tasks: Sequence[Task]) -> tuple[Arrangement, ...]:
    """All distinct arrangements that a house's tasks lead to; the original one first."""
    wanted = [AS_FOUND]
    for task in tasks:
        wanted.extend(_states_of(task)[1:])
    return tuple(dict.fromkeys(wanted))


def _states_of(task: Task) -> tuple[Arrangement, ...]:
    """The arrangement of each object state of a task."""
    if task.kind == Kind.NAV:
        return (AS_FOUND,)
    return AS_FOUND, Arrangement(task.moved), Arrangement(task.moved, task.placement)


def cell_panoramas(
    tasks: Sequence[Task], arrangements: Sequence[Arrangement], tiles: int
) -> NDArray[np.int64]:
    """The panorama of each cell of each task; the tasks are of one kind.

    Returns:
        int64 [task, cell], with `cell = object_state * tiles + tile`.
    """
    place = {arrangement: index for index, arrangement in enumerate(arrangements)}
    states = OBJECT_STATES if tasks and tasks[0].kind == Kind.PICK else 1
    rows = np.array([[place[a] for a in _states_of(task)] for task in tasks], np.int64)
    rows = rows.reshape(len(tasks), states, 1) * tiles + np.arange(tiles)
    return rows.reshape(len(tasks), states * tiles)


SIDES = range(8, 257, 2)
"""Valid side lengths of a view in pixels: even, as the networks halve them."""


def resize_views(semantics: Semantics, image_size: tuple[int, int] | None) -> Semantics:
    """The same cameras with another image size.

    The horizontal field of view is kept, so the four views still cover the full circle, and
    pixels stay square: a relatively taller image shows more above and below.

    Args:
        semantics: The constants of a benchmark.
        image_size: Width and height in pixels; None keeps them.

    Raises:
        UsageError: If a side is odd, too short or too long.
    """
    if image_size is None:
        return semantics
    width, height = image_size
    if width not in SIDES or height not in SIDES:
        raise UsageError(
            f"Views of {width} x {height} pixels: each side must be even and within"
            f" {SIDES[0]} .. {SIDES[-1]}. Example: 64 x 64."
        )
    return replace(semantics, view_width=width, view_height=height)
